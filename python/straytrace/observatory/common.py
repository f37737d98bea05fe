# SPDX-License-Identifier: BSD-3-Clause
"""Errors with a remedy, optional packages and GPS times."""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from typing import Any

HERE = os.environ.get("STRAYTRACE_PYTHON") or sys.executable


class DataError(Exception):
    """What is wrong, and the remedy."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(what)
        self.remedy = remedy


def package(name: str, purpose: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        top = name.split(".")[0]
        raise DataError(f"{purpose} needs the Python package {top}, which {HERE} does not have",
                        f"{HERE} -m pip install {top}, or set STRAYTRACE_PYTHON to the Python that has it") from None


def has(name: str) -> bool:
    return importlib.util.find_spec(name) is not None


def gps(time: float) -> str:
    return f"{time:.7f}".rstrip("0").rstrip(".")
