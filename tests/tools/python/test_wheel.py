# SPDX-License-Identifier: BSD-3-Clause
"""The wheel: built, installed into a new environment, used far from the source tree. It takes the programs that are built
already (STRAYTRACE_PREBUILT), so this costs seconds; scripts/fresh compiles one."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import zipfile

from python_arm import BLOCK, PROGRAM, SOURCE, arm

USE = """
import os, straytrace
assert "site-packages" in straytrace.__file__, straytrace.__file__
assert straytrace.engine.program().startswith(os.path.dirname(straytrace.__file__)), straytrace.engine.program()
run = straytrace.run("model.yaml", histories=4096, progress=False)
from straytrace import native
if {library}:
    assert native._places()[0].startswith(os.path.dirname(straytrace.__file__)), native._places()
    assert native.Model("model.yaml").trace(histories=4096).histories == 4096
assert run.histories == 4096 and run.attributes["version"] == straytrace.__version__, straytrace.__version__
"""


def sources(folder):
    """The sources of the wheel, as in a clean checkout."""
    for name in ("CMakeLists.txt", "pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(SOURCE / name, folder)
    shutil.copytree(SOURCE / "python", folder / "python", ignore=shutil.ignore_patterns("__pycache__"))


def pip(*words, **more):
    subprocess.run([sys.executable, "-m", "pip", "--disable-pip-version-check", "-q", *map(str, words)], check=True, **more)


def environment(place, wheel):
    """A new environment with the wheel and with the libraries of this one."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", place], check=True)
    pip("--python", place / "bin" / "python", "install", "--no-deps", "--no-index", wheel)
    packages = next(place.glob("lib/python*/site-packages"))
    here = next(p for p in sys.path if p.endswith("site-packages"))
    (packages / "libraries.pth").write_text(here + "\n")
    return packages


def main():
    clean = {k: v for k, v in os.environ.items() if not k.startswith(("STRAYTRACE_", "PYTHON"))}
    with tempfile.TemporaryDirectory() as name:
        place = pathlib.Path(name)
        (place / "source").mkdir()
        (place / "away").mkdir()
        sources(place / "source")
        pip("wheel", "--no-build-isolation", "--no-deps", "-w", place, place / "source", f"--config-settings=build-dir={place}/build",
            f"--config-settings=cmake.define.STRAYTRACE_PREBUILT={pathlib.Path(PROGRAM).parent}")
        wheel, = place.glob("*.whl")
        library = (pathlib.Path(PROGRAM).parent / "src/libstraytrace.so").exists()     # not with sanitizers
        held = zipfile.ZipFile(wheel).namelist()
        for wanted in ("straytrace/bin/straytrace", "straytrace/bin/straytrace-step", "straytrace/bin/straytrace-mpi.so", "straytrace/py.typed", "straytrace/plots/__main__.py",
                       "straytrace/plots/budget.py", "straytrace/maps/files.py", "straytrace/layouts/theia.py", *["straytrace/bin/libstraytrace.so"] * library):
            assert wanted in held, wanted
        assert not [h for h in held if "__pycache__" in h or h.startswith("build")], held
        packages = environment(place / "env", wheel)
        arm().save(place / "away" / "model.yaml")
        away = {"cwd": place / "away", "env": clean, "check": True}
        subprocess.run([place / "env/bin/python", "-c", USE.format(library=library)], **away)
        # The converter of STEP files in the wheel is found; without it the same scene is an error.
        shutil.copytree(SOURCE / "examples", place / "away" / "examples")
        check = [place / "env/bin/straytrace", "check", "examples/cad_bench.yaml"]
        fresh = {**away, "env": {**clean, "XDG_CACHE_HOME": str(place / "cache"), "PATH": "/usr/bin:/bin"}}
        subprocess.run(check, stdout=subprocess.DEVNULL, **fresh)
        (packages / "straytrace/bin/straytrace-step").unlink()
        shutil.rmtree(place / "cache")
        without = subprocess.run(check, capture_output=True, text=True, **{**fresh, "check": False})
        assert without.returncode == 2 and "straytrace-step" in without.stderr, without.stderr
        # The command, and the program itself, find the package that draws their pictures.
        for program in (place / "env/bin/straytrace", packages / "straytrace/bin/straytrace"):
            subprocess.run([program, "run", "model.yaml", "-o", "out", "--histories", str(BLOCK), "--quiet", "--force"],
                           stdout=subprocess.DEVNULL, **away)
            picture = place / "away/out/report.png"
            assert picture.stat().st_size > 50000, picture
            picture.unlink()
    print("wheel: as expected")


main()
