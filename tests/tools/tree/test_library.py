#!/usr/bin/env python3
"""The C++ library: installed, found by CMake, linked by examples/library, which must give the numbers of the commands. Usage:
test_library.py PROGRAM BUILD_DIR"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = pathlib.Path(sys.argv.pop()).resolve()
PROGRAM = pathlib.Path(sys.argv.pop()).resolve()
HISTORIES = 16384


def output(*words, code=0):
    done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == code, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout if code == 0 else done.stderr


class Library(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.held = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.held.cleanup)
        cls.folder = pathlib.Path(cls.held.name)
        output("cmake", "--install", BUILD, "--prefix", cls.folder / "installed", "--component", "library")
        output("cmake", "-G", "Ninja", "-S", ROOT / "examples/library", "-B", cls.folder / "build", "-DCMAKE_BUILD_TYPE=Debug",
               "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror", f"-DCMAKE_PREFIX_PATH={cls.folder / 'installed'}")
        output("cmake", "--build", cls.folder / "build")
        cls.example = cls.folder / "build/baffle_reflectance"

    def test_numbers_of_the_commands(self):
        scene, run = ROOT / "examples/virgo_arm.yaml", self.folder / "run.h5"
        printed = output(self.example, scene, HISTORIES)
        output(PROGRAM, "trace", scene, "-o", run, "--histories", HISTORIES, "--quiet")
        found = dict(re.findall(r"baffle=(\S+)  h\(10 Hz\) = (\S+) ", printed))
        for factor in ("x1", "x0.1"):
            changed = json.loads(output(PROGRAM, "noise", run, "--set", f"baffle={factor}", "--format", "json", "--quiet"))
            at_10_hz, = (h for h in changed["total_strain"] if h["frequency_Hz"] == 10)
            self.assertEqual(found[factor], f"{at_10_hz['value']:.9g}")
        self.assertNotEqual(found["x1"], found["x0.1"])                       # negative control
        self.assertEqual(len(re.findall(r"^\d  ", printed, re.MULTILINE)), 3)

    def test_all_problems_of_a_scene(self):
        scene = self.folder / "wrong.yaml"
        scene.write_text("straytrace: 1\nbeams: {arm: {wavelength: 1 kg}}\nnonsense: 1\n")
        told, wanted = output(self.example, scene, code=2), output(PROGRAM, "check", scene, code=2)
        self.assertEqual(told.rstrip(), wanted.rstrip())
        self.assertGreater(told.count("error:"), 1)

    def test_from_c(self):
        source, program = self.folder / "use.c", self.folder / "use"
        source.write_text('#include <stdio.h>\n#include <straytrace/straytrace.h>\n'
                          "int main(int count, char** words) {\n"
                          "  straytrace_model* model = straytrace_read(words[count - 1], NULL, NULL);\n"
                          '  if (model == NULL) return printf("%s", straytrace_error_text()), straytrace_error();\n'
                          '  printf("%s\\n%s\\n", straytrace_version(), straytrace_model_about(model));\n'
                          "  straytrace_free_model(model);\n  return 0;\n}\n")
        place = next((self.folder / "installed").rglob("libstraytrace.so")).parent
        output("cc", "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", source, "-o", program, f"-I{self.folder / 'installed/include'}",
               f"-L{place}", f"-Wl,-rpath,{place}", "-lstraytrace")
        version, about = output(program, ROOT / "examples/two_mirrors.yaml").splitlines()
        self.assertIn(f"straytrace {version} ", output(PROGRAM, "--version"))
        self.assertEqual(json.loads(about)["receivers"], ["PD", "plane"])
        done = subprocess.run([program, self.folder / "nowhere.yaml"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("there is no such file", done.stdout)

    def test_symbols(self):
        """Nothing but the front is visible; the program, read in the same way, shows that others would be seen."""
        def defined(file, *options):
            return [line.split(" ", 2)[2] for line in output("nm", "-C", "--defined-only", *options, file).splitlines()
                    if line.count(" ") >= 2]
        library = self.folder / "installed"
        shown = defined(next(library.rglob("libstraytrace.so")), "-D")
        foreign = [name for name in shown if "straytrace::api::" not in name and not name.startswith(("straytrace_", "STRAYTRACE_0"))]
        self.assertEqual(foreign, [])
        self.assertTrue([name for name in shown if "Model::trace" in name])
        self.assertTrue([name for name in defined(PROGRAM) if name.startswith("straytrace::trace::")])

    def test_version(self):
        other = self.folder / "other"
        other.mkdir()
        (other / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.20)\nproject(other LANGUAGES CXX)\n"
                                              "find_package(straytrace 7.0 REQUIRED)\n")
        told = output("cmake", "-G", "Ninja", "-S", other, "-B", other / "build", f"-DCMAKE_PREFIX_PATH={self.folder / 'installed'}", code=1)
        self.assertIn("7.0", told)


if __name__ == "__main__":
    unittest.main()
