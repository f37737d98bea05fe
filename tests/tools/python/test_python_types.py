# SPDX-License-Identifier: BSD-3-Clause
"""The public part of the Python package under mypy --strict. Its folders are not typed: they draw pictures for the
program, or read files of other programs for the command line."""
import os
import pathlib
import subprocess
import sys
import tempfile

from python_arm import SOURCE

TYPED_PICTURES = ("points.py",)       # those that users reach by methods

USE = """
import straytrace
run = straytrace.Model.load("arm.yaml").run(histories=1e6, until="h_total < 5 %", progress=None)
h: float = float(run.paths(where="resolved")[0].share)
noise = run.noise
assert noise is not None
reveal_type(noise.total.mean)
"""


def mypy(*words):
    cache = pathlib.Path(os.environ.get("STRAYTRACE_BUILD", SOURCE / "build")) / "mypy"
    return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, "--config-file",
                           SOURCE / "pyproject.toml", *words], capture_output=True, text=True, cwd=SOURCE / "python")


def main():
    package = SOURCE / "python" / "straytrace"
    public = sorted(package.glob("*.py")) + [package / "plots" / name for name in TYPED_PICTURES]
    with tempfile.TemporaryDirectory() as folder:
        use = pathlib.Path(folder, "use.py")
        use.write_text(USE)
        control = pathlib.Path(folder, "control.py")
        control.write_text("import straytrace\nstraytrace.Model.load(3)\nstraytrace.open('run.h5').histories = 'x'\n")
        said = mypy(*public, use)
        assert said.returncode == 0, said.stdout + said.stderr
        assert "float64" in said.stdout, said.stdout           # the types reach users
        wrong = mypy(control)
        assert wrong.stdout.count("error:") == 3, wrong.stdout
    print(f"{len(public)} modules: no problem")


main()
