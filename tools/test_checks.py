#!/usr/bin/env python3
"""Each check of this folder must pass a good tree and refuse a bad one. Usage: test_checks.py"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).parent
HEAD = "// SPDX-License-Identifier: BSD-3-Clause\n"


def verdict(tool, files, folder=""):
    """Exit status and output of a tool run on a tree made of {path: text}."""
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = pathlib.Path(root) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        done = subprocess.run([sys.executable, TOOLS / tool, pathlib.Path(root) / folder], capture_output=True, text=True)
        return done.returncode, done.stdout


class CheckFiles(unittest.TestCase):
    def expect(self, files, status, part):
        found, output = verdict("check_files.py", files)
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_good_file_passes(self):
        self.expect({"src/a.cpp": HEAD + "int a;\n"}, 0, "1 source files")

    def test_nothing_found_fails(self):
        self.expect({"other/a.cpp": HEAD}, 1, "no source files")

    def test_bad_files_fail(self):
        for text, part in ((HEAD + "int a;\n" * 300, "301 lines"), ("int a;\n", "must begin"), (HEAD + "\tint a;\n", "tab"),
                           (HEAD + "int a; \n", "white space"), (HEAD + "// TO" "DO\n", "finish it"),
                           (HEAD + "int a;", "line break")):
            with self.subTest(part):
                self.expect({"src/a.cpp": text}, 1, part)

    def test_limit_itself_passes(self):
        self.expect({"src/a.hpp": HEAD + "int a;\n" * 299}, 0, "in order")


class CheckIncludes(unittest.TestCase):
    def expect(self, line, status, room="trace"):
        files = {"src/base/vec3.hpp": HEAD, f"src/{room}/a.cpp": f"{line}\n"}
        found, output = verdict("check_includes.py", files, "src")
        self.assertEqual(found, status, output)

    def test_allowed_include_passes(self):
        self.expect('#include "base/vec3.hpp"', 0)

    def test_motion_cannot_enter_the_trace(self):
        self.expect('#include "motion/motion.hpp"', 1)

    def test_noise_sees_only_the_coupling_table(self):
        self.expect('#include "trace/coupling.hpp"', 0, "noise")
        self.expect('#include "trace/result.hpp"', 1, "noise")

    def test_no_includes_at_all_fails(self):
        self.expect("int a;", 1)


class CheckDocs(unittest.TestCase):
    def expect(self, page, status, part, **more):
        key = 'static constexpr char const* key = "cap";'
        files = {"src/geometry/cap.hpp": key, "src/optics/abg.hpp": key.replace("cap", "abg"), "README.md": page,
                 "docs/reference/shapes/cap.md": "# cap\n\n## Size of it\n", "docs/reference/scatter/abg.md": "# abg\n"}
        found, output = verdict("check_docs.py", {**files, **more})
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_live_links_pass(self):
        self.expect("[a](docs/reference/shapes/cap.md#size-of-it), [b](https://example.org)", 0, "in order")

    def test_dead_links_fail(self):
        self.expect("[a](docs/nowhere.md)", 1, "no such file")
        self.expect("[a](docs/reference/shapes/cap.md#weight)", 1, "no such heading")

    def test_shape_without_page_fails(self):
        self.expect("", 1, "'cone'", **{"src/geometry/cone.hpp": 'static constexpr char const* key = "cone";'})

    def test_nothing_found_fails(self):
        self.assertEqual(verdict("check_docs.py", {"a.txt": ""})[0], 1)


if __name__ == "__main__":
    unittest.main()
