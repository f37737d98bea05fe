#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""All files of /usr that build, tests and scripts use are in packages that scripts/setup installs; each way in which the check finds
a use must notice the package that is left out. Usage: test_packages.py BUILD_DIR"""
import pathlib
import subprocess
import sys

LINT = pathlib.Path(__file__).resolve().parents[3] / "tools/lint"
sys.dont_write_bytecode = True
sys.path.insert(0, str(LINT))

from check_packages import Packages, started_programs  # noqa: E402

# Omitted package: the names that the check must report.
CONTROLS = {
    "libtbb-dev": "libtbb.so (commands of the build)",                   # linked, because OpenCASCADE names it
    "nlohmann-json3-dev": "nlohmann/json.hpp (headers of the build)",
    "node-d3": "/usr/share/nodejs/d3/dist (src/CMakeLists.txt)",
    "python3-matplotlib": "dist-packages/matplotlib (python/straytrace/plots/",
    "ninja-build": "/usr/bin/ninja (CMakeCache.txt)",
    "chromium-driver": "/usr/bin/chromedriver (tests/tools/report/browser.py)",
    "python3-selenium": "dist-packages/selenium (tools/pictures/draw_pages.py)",
}


def verdict(build, *words):
    done = subprocess.run([sys.executable, LINT / "check_packages.py", build, *words], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return done.returncode, done.stdout


def check(condition, words):
    if not condition:
        sys.exit(f"test_packages: {words}")


def check_parsing():
    """Alternatives, versions and architectures of a dependency; programs in command position and nowhere else."""
    names = Packages.names("libc6 (>= 2.36), a:any | b [amd64], c")
    check(names == [["libc6"], ["a", "b"], ["c"]], f"a dependency is read as {names}")
    programs = {"valgrind": "/usr/bin/valgrind"}
    for text, suffix, started in (("a | valgrind --tool=x\n", "", True), ("x=$(valgrind y)\n", "", True), ("if valgrind; then\n", ".sh", True),
                                  ("echo valgrind\n", "", False), ("# valgrind x\n", "", False), ("list=(g++ valgrind)\n", "", False),
                                  ("command -v valgrind && valgrind x\n", "", False), ("cat <<END\nvalgrind x\nEND\n", "", False),
                                  ('run(["valgrind", "x"])\n', ".py", True), ('words = ["valgrind"]\n', ".py", True),
                                  ('name = "valgrind"\n', ".py", False), ('std::system("valgrind x");\n', ".cpp", True)):
        found = bool(list(started_programs(text, suffix, programs)))
        check(found == started, f"in {text!r} a program is {'found' if found else 'missed'}")


def main(build):
    check_parsing()
    code, words = verdict(build)
    check(code == 0, words)
    for package, named in CONTROLS.items():
        code, words = verdict(build, "--without", package)
        check(code == 1 and named in words and f"belongs to {package}" in words, f"without {package} the check says: {words}")
    print("packages: as expected")


main(pathlib.Path(sys.argv[1]))
