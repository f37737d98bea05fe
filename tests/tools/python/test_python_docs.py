# SPDX-License-Identifier: BSD-3-Clause
"""The pages about Python: the reference agrees with the docstrings, and every block of the guide and of the first pages
runs."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

from python_arm import SOURCE

from straytrace import native

BLOCK = re.compile(r"^ *```python\n(.*?)^ *```", re.M | re.S)


def reference(root):
    """The exit code of the tool for a tree."""
    return subprocess.run([sys.executable, root / "tools/python_reference.py"], stdout=subprocess.DEVNULL).returncode


def main():
    assert reference(SOURCE) == 0, "docs/reference/python.md is not what the code says: run tools/python_reference.py --write"
    guide = (SOURCE / "docs/guide/python.md").read_text()
    blocks = BLOCK.findall(guide)
    assert len(blocks) > 6, len(blocks)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("examples").symlink_to(SOURCE / "examples")
        names = {}
        for block in blocks:
            if "native" in block and not native.available():       # a build with sanitizers
                continue
            exec(compile(block, "docs/guide/python.md", "exec"), names)
        assert pathlib.Path("arm.png").stat().st_size > 50000
        found = names["found"]
        assert abs(abs(found.phase / found.darm)[0] / (5e-6 * 1064e-9 / 12.566370614) - 1) < 1e-3     # docs/theory/interferometer.md
        assert names["run"].noise.at(30) > 0
        pathlib.Path("demo").mkdir()
        names["run"].save("demo/run.h5")
        for page in ("README.md", "docs/guide/index.md", "docs/reference/run_file.md"):
            for block in BLOCK.findall((SOURCE / page).read_text()):
                exec(compile(textwrap.dedent(block), page, "exec"), {})
        os.chdir("/")
    print(f"{len(blocks)} blocks ran")


main()
