# SPDX-License-Identifier: BSD-3-Clause
"""Folders for temporary results."""

import pathlib
import shutil
import tempfile
import weakref


class Scratch:
    """A temporary folder that lives as long as this object."""

    def __init__(self) -> None:
        self.folder = tempfile.mkdtemp(prefix="straytrace-")
        weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)

    def file(self, name: str) -> str:
        """The path of a file in it."""
        return str(pathlib.Path(self.folder, name))
