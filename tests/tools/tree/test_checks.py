#!/usr/bin/env python3
"""Each check of tools/lint must accept a good tree and reject a bad one. Usage: test_checks.py"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[3] / "tools"
sys.path[:0] = [str(TOOLS), str(TOOLS / "pictures")]
sys.dont_write_bytecode = True

import draw_validation  # noqa: E402
import validation  # noqa: E402
from validation_cells import Records  # noqa: E402

HEAD = "// SPDX-License-Identifier: BSD-3-Clause\n"


def verdict(tool, files, *folders, read=None):
    """Exit status and output of a tool run on a tree made of {path: text}; `read`: a file to see afterwards."""
    with tempfile.TemporaryDirectory() as place:
        root = pathlib.Path(place)
        for name, text in files.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="latin-1" if path.suffix == ".png" else "utf-8", newline="")
            path.chmod(0o755)
        words = [folder if str(folder).startswith("--") else root / folder for folder in folders or ("",)]
        done = subprocess.run([sys.executable, TOOLS / tool, *words], capture_output=True, text=True)
        return done.returncode, done.stdout + ((root / read).read_text() if read else "")


class CheckFiles(unittest.TestCase):
    def expect(self, files, status, part):
        found, output = verdict("lint/check_files.py", files)
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_good_file_passes(self):
        self.expect({"src/a.cpp": HEAD + "int a;\n"}, 0, "1 source files")

    def test_nothing_found_fails(self):
        self.expect({"other/a.cpp": HEAD}, 1, "no source files")

    def test_bad_files_fail(self):
        for text, part in ((HEAD + "int a;\n" * 600, "601 lines"), ("int a;\n", "must begin"), (HEAD + "\tint a;\n", "tab"),
                           (HEAD + "int a; \n", "white space"), (HEAD + "// TO" "DO\n", "finish it"),
                           (HEAD + "int a;", "line break")):
            with self.subTest(part):
                self.expect({"src/a.cpp": text}, 1, part)

    def test_limit_itself_passes(self):
        self.expect({"src/a.hpp": HEAD + "int a;\n" * 299}, 0, "in order")

    def test_crowded_folder_fails(self):
        for top, limit in (("src", 30), ("bench", 25)):
            full = {f"{top}/a/{n}.py": "" for n in range(limit - 1)} | {f"{top}/a/b/c.py": "", f"{top}/a/__pycache__/c.pyc": ""}
            self.expect(full, 0, "in order")                               # one folder is among them
            self.expect(full | {f"{top}/a/{limit}.txt": ""}, 1, f"{top}/a: has {limit + 1} entries")


class CheckWords(unittest.TestCase):
    def expect(self, files, status, part):
        found, output = verdict("lint/check_words.py", files)
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_words_of_the_field_pass(self):
        self.expect({"README.md": "Light is emended and ammended; the twinkle of a handover, acknowledged.\n"}, 0, "1 texts use")
        self.expect({"docs/a.md": "Light is handed to the overlay; a beforehand known, forever held factor.\n"}, 0, "1 texts use")
        self.expect({"docs/a.md": "`the verdict` and `twin`\n", "tests/fuzz/corpus/a": "twin"}, 0, "1 texts use")
        self.expect({"docs/a.md": "a theory; there is none yet\n", "python/a.py": "if a is None:\n",
                     "src/a.cpp": "int between, bookshelf;  // or come by way of a mirror\n"}, 0, "3 texts use")

    def test_private_words_fail(self):
        for words in ("broken twin", "Twins:", "in the books", "no fate", "the verdict", "knocks", "stands beside", "rim of a baffle",
                      "goes on with", "hand-over angle", "dump me first", "lights nothing", "comes by", "to mend", "mesh doctor", "told apart",
                      "held against", "knows nothing of", "does not know of", "as it stands", "for ever", "hands over", "at hand",
                      "goes on", "asked for", "scatter law", "Scatter laws", "was refused", "are told", "is said", "taken off", "is none of",
                      "by itself", "by themselves"):
            files = {"src/a/b.hpp": "// A {} here\n", "docs/a.md": "A {} here.\n", "schema/words.yaml": "a: '{}'\n", "scripts/a": "# {}\n",
                     "python/a.py": '"""A {}."""\n'}
            with self.subTest(words):
                status, output = verdict("lint/check_words.py", {name: text.format(words) for name, text in files.items()})
                self.assertEqual(status, 1, output)
                for name in files:
                    self.assertIn(f"{name}:1: says '", output)

    def test_phrase_on_two_lines_fails(self):
        self.expect({"src/a.cpp": "int a;\n// What stands\n// beside the ray.\n"}, 1, "src/a.cpp:2: says 'stands // beside'")

    def test_nothing_found_fails(self):
        self.expect({"other/a.md": "a"}, 1, "no texts found")


class CheckImports(unittest.TestCase):
    ONE_WAY = {"python/p/__init__.py": "from .a import f\n", "python/p/a.py": "from .sub import b\n", "python/p/sub/__init__.py": "",
               "python/p/sub/b.py": "import json\n", "tools/t.py": "import p\nfrom p.sub import b\n"}

    def expect(self, files, status, part):
        found, output = verdict("lint/check_imports.py", {**self.ONE_WAY, **files})
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_one_way_passes(self):
        self.expect({}, 0, "5 Python modules import each other in no circle")
        types = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ..a import F\n"
        self.expect({"python/p/sub/b.py": types}, 0, "no circle")                       # they are not imported when it runs
        self.expect({"tools/json.py": "import p\n"}, 0, "no circle")       # the package does not see it

    def test_circles_fail(self):
        way = "p/a.py -> python/p/sub/b.py -> python/p/a.py"
        self.expect({"python/p/sub/b.py": "import os\nfrom .. import a\n"}, 1, way)
        self.expect({"python/p/sub/b.py": "def g():\n    from ..a import f\n"}, 1, way)     # the late import hides it
        self.expect({"python/p/sub/b.py": "import p.a\n"}, 1, way)
        self.expect({"bench/u.py": "import v\n", "bench/v.py": "\nimport u\n"}, 1, "bench/u.py:1: closes a circle")

    def test_nothing_found_fails(self):
        self.assertEqual(verdict("lint/check_imports.py", {"a.txt": ""})[0], 1)


class CheckCalls(unittest.TestCase):
    def expect(self, name, line, status):
        found, output = verdict("lint/check_calls.py", {name: line + "\n"})
        self.assertEqual(found, status, output)

    def test_words_of_a_user_never_meet_a_shell(self):
        for line in ("std::system(name.c_str());", "popen(name, mode);", "::execvp(a, b);", "std::ifstream in(name);",
                     "::socket(AF_INET, 0, 0);", "fork();", "H5::H5File file(name, 0);", "std::regex_match(text, form)",
                     "auto all = hdf5::own_contents(bytes);"):
            self.expect("src/cli/a.cpp", line, 1)
        for line in ("os.system(name)", "subprocess.run(name, shell=True)", "eval(text)", "pickle.load(file)",
                     "import urllib.request", "np.load(file, allow_pickle=True)"):
            self.expect("python/straytrace/a.py", line, 1)

    def test_where_it_is_meant_it_passes(self):
        self.expect("src/base/process/child_process.cpp", "::posix_spawnp(a, b, c, d, e, f);", 0)
        self.expect("src/cli/a.cpp", "solve_system(matrix);  // no system()", 0)
        self.expect("src/results/run_file/run_file.cpp", "return hdf5::own_contents(image, wanted);", 0)
        self.expect("python/straytrace/a.py", "subprocess.run([program, name]); frame.eval(name)", 0)

    def test_nothing_found_fails(self):
        self.expect("other/a.cpp", "int a;", 1)


class CheckIncludes(unittest.TestCase):
    def expect(self, files, status, part):
        good = {"src/world/a.hpp": '#include "base/math/vec3.hpp"\n'}
        found, output = verdict("lint/check_includes.py", {**good, **files}, "src")
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_modules_include_what_the_namespaces_list(self):
        self.expect({"src/trace/b.cpp": '#include "world/model/world.hpp"\n'}, 0, "all includes allowed")
        self.expect({"src/trace/b.cpp": '#include "motion/motion.hpp"\n'}, 1, "b.cpp:1: trace may not include motion")
        self.expect({"src/world/b.cpp": '\n#  include "motion/motion.hpp"\n'}, 1, "b.cpp:2: world may not include motion")
        self.expect({"src/noise/b.cpp": '#include "trace/coupling.hpp"\n'}, 0, "all includes allowed")
        self.expect({"src/noise/b.cpp": '#include "trace/run/trace.hpp"\n'}, 1, "noise may not include trace/run/trace.hpp")
        self.expect({"src/attic/b.cpp": '#include "base/math/vec3.hpp"\n'}, 1, "module 'attic' is not in the map")
        self.expect({"src/noise/b.cpp": '#include "base/every_module.hpp"\n'}, 1, "is for tests")

    def test_headers_of_folders_in_a_circle_fail(self):
        up, down = '#include "world/search/s.hpp"\n', '#include "world/model/m.hpp"\n'
        self.expect({"src/world/model/m.hpp": up, "src/world/search/s.hpp": ""}, 0, "all includes allowed")
        self.expect({"src/world/model/m.hpp": up, "src/world/search/s.hpp": down}, 1, "closes a circle of folders, world/")
        self.expect({"src/world/model/m.hpp": up, "src/world/search/s.cpp": down}, 0, "all includes allowed")  # sources close none

    def test_no_includes_at_all_fails(self):
        found, output = verdict("lint/check_includes.py", {"src/trace/a.cpp": "int a;\n"}, "src")
        self.assertEqual(found, 1, output)
        self.assertIn("no project includes found", output)

    def test_two_types_of_one_name_fail(self):
        one, other = HEAD + "struct Answer {\n};\n", HEAD + "class Answer : Base {\n};\n"
        self.expect({"src/base/a.hpp": one, "src/base/b.hpp": other}, 1, "is a type of")
        self.expect({"src/world/a.hpp": HEAD + '#include "base/math/vec3.hpp"\n' + one, "src/base/b.hpp": other}, 0, "all includes allowed")
        for good in (HEAD + "struct Answer;\n", HEAD + "template <class T>\nclass Answer {\n};\n", HEAD + "struct Answers {\n};\n"):
            self.expect({"src/base/a.hpp": one, "src/base/b.hpp": good}, 0, "all includes allowed")

    def test_namespace_of_another_module_fails(self):
        for file, name in (("world/b.hpp", "straytrace::world"), ("base/b.hpp", "straytrace"), ("io/b.hpp", "straytrace::io::hdf5")):
            self.expect({f"src/{file}": f"namespace {name} {{\nint a;\n}}\n"}, 0, "all includes allowed")
        for file, name in (("world/b.hpp", "straytrace::trace"), ("world/b.hpp", "straytrace"), ("base/b.hpp", "straytrace::world")):
            self.expect({f"src/{file}": f"namespace {name} {{\nint a;\n}}\n"}, 1, "b.hpp:1: opens a namespace of another module")
        declared = "namespace straytrace::world {\nclass World;\n}  // namespace straytrace::world\n"
        self.expect({"src/trace/b.hpp": declared}, 0, "all includes allowed")


class CheckHeaders(unittest.TestCase):
    def expect(self, header, status, part, source=""):
        with tempfile.TemporaryDirectory() as place:
            src = pathlib.Path(place) / "src"
            src.mkdir()
            (src / "a.hpp").write_text(header)
            (src / "a.cpp").write_text(source)
            call = {"directory": place, "file": str(src / "a.cpp"), "command": f"ccache c++ -I{src} -std=c++20 -c a.cpp"}
            (pathlib.Path(place) / "compile_commands.json").write_text(json.dumps([call]))
            done = subprocess.run([sys.executable, TOOLS / "lint/check_headers.py", place, src], capture_output=True, text=True)
            self.assertEqual(done.returncode, status, done.stdout)
            self.assertIn(part, done.stdout)

    def test_header_alone_passes(self):
        self.expect("#include <vector>\ninline std::vector<int> a;\n", 0, "1 headers")

    def test_header_that_needs_another_fails(self):
        self.expect("inline std::vector<int> a;\n", 1, "a.hpp does not compile on its own")

    def test_header_that_a_source_includes_first_is_left_to_the_build(self):
        self.expect("int a;\n", 0, "0 of them", '// A page.\n#include "a.hpp"\n')
        self.expect("inline std::vector<int> a;\n", 1, "a.hpp does not", '#include <vector>\n\n#include "a.hpp"\n')


class CheckDocs(unittest.TestCase):
    def expect(self, page, status, part, **more):
        key = 'static constexpr char const* key = "cap";'
        files = {"src/geometry/shapes/cap.hpp": key, "src/optics/scatter/shift_invariant.hpp": key.replace("cap", "abg"), "README.md": page,
                 "docs/reference/shapes/cap.md": "# cap\n\n## Size of it\n", "docs/reference/scatter/abg.md": "# abg\n",
                 "docs/develop/conventions.md": "`Levers.a1`\n", "docs/theory/validation.md": "`docs.run`\n",
                 "tests/physics/a.cpp": "TEST(Levers, a1) {}\n", "tests/CMakeLists.txt": "add_test(NAME docs.run x)\n"}
        found, output = verdict("lint/check_docs.py", {**files, **more})
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_live_links_pass(self):
        self.expect("[a](docs/reference/shapes/cap.md#size-of-it), [b](https://example.org)", 0, "in order")

    def test_dead_links_fail(self):
        self.expect("[a](docs/nowhere.md)", 1, "no such file")
        self.expect("[a](docs/reference/shapes/cap.md#weight)", 1, "no such heading")

    def test_file_that_does_not_exist_fails(self):
        self.expect("`src/geometry/shapes/cap.hpp`", 0, "in order")
        self.expect("`src/geometry/cup.hpp`", 1, "there is no src/geometry/cup.hpp")

    def test_message_that_names_a_file_that_does_not_exist_fails(self):
        there, wrong = 'char const* t = "see docs/reference/shapes/cap.md";', 'char const* t = "see physics.md eq. 2.6";'
        for file in ("src/a.cpp", "data/page/a.js", "python/a.py"):
            self.expect("", 0, "in order", **{file: there})
            self.expect("", 1, "names physics.md", **{file: wrong})
        self.expect("see physics.md", 1, "there is no physics.md")
        self.expect("see cap.md", 0, "in order")

    def test_test_that_does_not_exist_fails(self):
        self.expect("", 1, "there is no test Levers.a2", **{"docs/theory/validation.md": "`Levers.a2`\n"})
        self.expect("", 1, "no tests named", **{"docs/theory/validation.md": "words\n"})
        self.expect("", 0, "in order", **{"tests/long.txt": "# Long\nLevers.a1\nfuzz.mesh\n"})
        self.expect("", 1, "tests/long.txt: there is no test Levers.a2", **{"tests/long.txt": "# Long\nLevers.a2\n"})
        self.expect("", 0, "in order", **{"tests/long.txt": "# Long\nLevers.*\n"})
        self.expect("", 1, "tests/long.txt: there is no test Lever.*", **{"tests/long.txt": "# Long\nLever.*\n"})

    def test_shape_without_page_fails(self):
        self.expect("", 1, "'cone'", **{"src/geometry/shapes/cone.hpp": 'static constexpr char const* key = "cone";'})

    def test_cited_equation_without_its_formula_fails(self):
        formulas = {"docs/theory/a.md": "$$x \\tag{9.3, 9.4}$$\n$$y \\tag{5.1–5.3}$$\n"}
        self.expect("", 0, "in order", **formulas, **{"src/a.hpp": "// docs/theory/a.md, eq. 9.4, eq. 5.2\n"})
        self.expect("", 1, "sets equation 9.5", **formulas, **{"src/a.hpp": "// docs/theory/a.md, eq. 9.5\n"})

    def test_number_of_two_equations_fails(self):
        pages = {"docs/theory/a.md": "$$x \\tag{9.3, 9.4}$$\n", "docs/theory/b.md": "$$y \\tag{9.5}$$\n"}
        self.expect("", 0, "in order", **pages)
        self.expect("", 0, "in order", **{**pages, "docs/theory/b.md": "$$y \\tag{9.4}$$\n"})
        self.expect("", 1, "docs/theory/a.md:2: equation 9.4 is that of docs/theory/a.md:1", **{**pages, "docs/theory/a.md": pages["docs/theory/a.md"] * 2})

    def test_citation_outside_of_the_repository_fails(self):
        for cited in ("physics.md 8.5", "house.md", "docs/design/wave.md", "(estimators.md 13)", "docs/theory/physics.md, eq. 8.5"):
            for file, mark in (("src/a/b.hpp", "//"), ("bench/a.py", "#"), ("scripts/a", "#")):
                self.expect("", 1, "which is not in the repository", **{file: f"{mark} as in {cited}\n"})
        self.expect("", 0, "in order", **{"src/a/b.hpp": "// docs/reference/shapes/cap.md, docs/reference/shapes/NAME.md\n"})

    def test_equation_of_another_page_fails(self):
        pages = {"docs/theory/a.md": "$$x \\tag{9.3}$$\n", "docs/theory/b.md": "$$y \\tag{5.1}$$\n"}
        self.expect("", 0, "in order", **pages, **{"tests/a.cpp": "// (docs/theory/a.md, eq. 9.3; docs/theory/b.md eq. 5.1)\n"})
        self.expect("", 1, "docs/theory/b.md does not set equation 9.3", **pages, **{"tests/a.cpp": "// docs/theory/b.md,\n// eq. 9.3\n"})

    def test_skip_that_is_not_told_fails(self):
        skips = {"tests/unit/b.cpp": "GTEST" "_SKIP() << 1;\n"}
        self.expect("", 1, "tests/unit/b.cpp: skips", **skips)
        self.expect("", 0, "in order", **skips, **{"docs/develop/testing.md": "`tests/unit/b.cpp`\n"})

    def test_picture_of_uncommitted_changes_fails(self):
        def png(words):
            text = b"Software\0" + words
            return (b"\x89PNG\r\n\x1a\n" + struct.pack(">I4s", len(text), b"tEXt") + text + b"crc!").decode("latin-1")

        self.expect("", 0, "in order", **{"docs/a.png": png(b"straytrace 0.1.0 (1a90d67)")})
        self.expect("", 1, "docs/a.png: drawn by", **{"docs/a.png": png(b"straytrace 0.1.0 (1a90d67-dirty)")})

    def test_nothing_found_fails(self):
        self.assertEqual(verdict("lint/check_docs.py", {"a.txt": ""})[0], 1)


class RunDocs(unittest.TestCase):
    PROGRAM = """#!/bin/sh
case "$*" in
  --help) printf 'Subcommands:\\n  run   does\\n' ;;
  *--help) echo '  -o,--out TEXT   where' ;;
  check*) ! grep -q wrong "$3" ;;
  *) printf 'one\\ntwo\\nprojected in 0.4 s; done\\nh = 1.25e-24\\n'; exit 3 ;;
esac
"""
    COMMANDS = "## Commands\n\n| command | does |\n| --- | --- |\n| `straytrace run SCENE` | does |\n"
    OPTIONS = "## Options\n\n| option | commands | |\n| --- | --- | --- |\n| `--out` | run | where |\n"

    def expect(self, block, status, part, kind="console", options=OPTIONS, page="README.md", commands=COMMANDS, *,
               write=False, night=False):
        files = {"program": self.PROGRAM, "README.md": commands, "docs/reference/commands.md": options}
        files[page] = f"```{kind}\n{block}\n```\n" + files.get(page, "")
        words = ["--write"] * write + ["--night"] * night
        found, output = verdict("run_docs.py", files, *words, "program", "", read=page if write else None)
        self.assertEqual(found, status, output)
        self.assertIn(part, output)

    def test_what_is_printed_passes(self):
        for lines in ("one\ntwo\nprojected in 0.9 s; done\nh = 1.25e-24", "one\n...\nh = 1.25e-24", "...\ntwo\n...", ""):
            with self.subTest(lines):
                self.expect(f"$ build/straytrace run  # exit 3\n{lines}", 0, "do what they say")

    def test_what_is_not_printed_fails(self):
        for lines, part in (("...\nh = 1.26e-24", "does not print 'h = 1.26e-24'"), ("two\n...", "does not print 'two'"),
                            ("...\ntwo\none\n...", "does not print 'one'"), ("one\ntwo", "prints more"),
                            ("one\nh = 1.25e-24\n...", "does not print 'h = 1.25e-24'")):
            with self.subTest(lines):
                self.expect(f"$ build/straytrace run  # exit 3\n{lines}", 1, part)

    def test_wrong_exit_code_fails(self):
        self.expect("$ build/straytrace run", 1, "exits with 3, not 0")
        self.expect("$ true  # exit 2", 1, "exits with 0, not 2")

    def test_installing_is_left_out(self):
        self.expect("$ scripts/setup", 0, "do what they say")

    def test_scene_with_errors_fails(self):
        self.expect("straytrace: 1\nok: 1", 0, "do what they say", "yaml", page="docs/reference/scene.md")
        self.expect("straytrace: 1\nwrong: 1", 1, "does not pass", "yaml", page="docs/reference/scene.md")

    def test_named_scene_is_written_for_later_commands(self):
        scene, command = "# mine.yaml\nstraytrace: 1\n{}: []", "```\n\n```console\n$ grep -c straytrace mine.yaml\n1"
        self.expect(scene.format("beams") + "\n" + command, 0, "do what they say", "yaml")
        self.expect(scene.format("beams").replace("mine", "other") + "\n" + command, 1, "exits with 2", "yaml")
        self.expect(scene.format("beams") + "\nwrong: 1", 1, "does not pass", "yaml")
        self.expect(scene.format("bodies") + "\nwrong: 1", 0, "do what they say", "yaml")      # a motion file, not checked alone

    def test_pages_that_are_named_run_alone(self):
        wrong = {"docs/guide/a.md": "```console\n$ false\n```\n", "README.md": self.COMMANDS, "docs/guide/b.md": "words\n", "program": self.PROGRAM}
        self.assertEqual(verdict("run_docs.py", wrong, "program", "", "docs/guide/b.md")[0], 0)
        self.assertEqual(verdict("run_docs.py", wrong, "program", "", "docs/guide/a.md")[0], 1)
        self.assertEqual(verdict("run_docs.py", wrong, "program", "", "docs/guide/c.md")[0], 1)

    def test_options_that_differ_fail(self):
        self.expect("", 1, "differ: --in", options=self.OPTIONS.replace("--out", "--out`, `--in"))
        self.expect("", 1, "differ: --out", options=self.OPTIONS.replace("--out", "-o"))
        self.expect("", 1, "no table of options", options="")

    def test_commands_that_differ_fail(self):
        self.expect("", 1, "differ: trace", commands=self.COMMANDS + "| `straytrace trace SCENE` | does |\n")
        self.expect("", 1, "differ: run", commands=self.COMMANDS.replace("straytrace run", "straytrace"))

    def test_pages_of_theory_are_run_and_what_takes_minutes_at_night(self):
        wrong, page = "$ build/straytrace run  # exit 3\n...\nh = 1.26e-24", "docs/theory/index.md"
        self.expect(wrong, 1, "does not print", page=page)
        self.expect(wrong, 0, "do what they say", "console night", page=page)
        self.expect(wrong, 1, "does not print", "console night", page=page, night=True)

    def test_new_lines_are_written(self):
        self.expect("$ build/straytrace run  # exit 3\n...\nh = 1.24e-24", 1, "\nh = 1.25e-24\n```", write=True)

    def test_an_equal_line_elsewhere_is_kept(self):
        right, wrong = "$ printf 'one\\ntwo\\n'\none\ntwo", "$ printf 'one\\nnew\\n'\none\ntwo"
        self.expect(f"{right}\n{wrong}", 1, f"{right}\n{wrong[:-3]}new\n```", write=True)


class MakeCommands(unittest.TestCase):
    PROGRAM = """#!/bin/sh
case "$*" in
  --help) printf 'Light:\\n  run                         Do it.\\n' ;;
  *) printf 'Output options:\\n  -h,--help                   Print this\\n  -o,--out TEXT=a|b           where: "x y"\\n' ;;
esac
"""
    PAGE = "".join(f"<!-- {name}: tools/make_commands.py -->\n\n<!-- end -->\n\n## run\n" for name in ("commands", "options"))

    def made(self, page, *words):
        return verdict("make_commands.py", {"program": self.PROGRAM, "page.md": page}, *words, "program", "page.md", read="page.md")

    def test_tables_are_written_once_and_then_agree(self):
        status, page = self.made(self.PAGE, "--write")
        self.assertEqual(status, 0)
        page = page.partition("\n")[2]
        for row in ("| Light | [run](#run) | Do it. |\n", "### Output options\n", "| `-o`, `--out` | run | where: `x y`; default: a\\|b |\n"):
            self.assertEqual(page.count(row), 1, page)
        self.assertEqual(page.count("## run"), 2)
        self.assertNotIn("--help", page)
        self.assertEqual(self.made(page)[0], 0)
        self.assertEqual(self.made(page.replace("Do it", "Do that"))[0], 1)

    def test_a_page_without_its_places_fails(self):
        self.assertEqual(self.made(self.PAGE.replace("options:", "option:"))[0], 1)


class CheckValidation(unittest.TestCase):
    """A page of one row against records of one test."""

    def compared(self, obtained, error, *comparisons, write=False, source="a();\n" * 9, tests="`A.b`"):
        with tempfile.TemporaryDirectory() as place:
            root = pathlib.Path(place)
            (root / "validation").mkdir()
            (root / "a.cpp").write_text(source)
            kept = [{"at": f"a.cpp:{line}", "what": what, "against": "", "kind": kind, "count": count, "used": used,
                     "samples": [sample] * min(count, 16), "worst": sample}
                    for line, kind, what, count, used, sample in comparisons]
            (root / "validation/A.b.json").write_text(json.dumps({"comparisons": kept}))
            page = "| case | obtained | error | test |\n| --- | --- | --- | --- |\n" \
                   f"| A1 | {obtained} | {error} | {tests} |"
            problems, text = validation.compare(page, Records(root, root), write)
            return problems, text.split("\n")[-1]

    def test_page_that_holds_what_was_obtained_passes(self):
        near = (1, "near", "x", 1, 0.3, [-0.25003, -0.25, 1e-4])
        mean = (2, "mean", "m = 1", 1, 0.8, [3.604e-10, 3.6e-10, 5e-13])
        self.assertEqual(self.compared("", "", near, mean, write=True)[1],
                         "| A1 | x: −0.25003 · m = 1: 3.604e-10 ± 5.0e-13 | 30 % | `A.b` |")
        self.assertEqual(self.compared("x: −0.25003 · m = 1: 3.6040e-10 ± 5.0e-13", "30 %", near, mean)[0], [])
        self.assertEqual(self.compared("x: −0.25001 · m = 1: 3.6042e-10 ± 5.1e-13", "10 %", near, mean)[0], [])
        for moved in ("x: 0.25003 · m = 1: 3.6040e-10 ± 5.0e-13", "x: −0.25013 · m = 1: 3.6040e-10 ± 5.0e-13",
                      "x: −0.25003 · m = 1: 3.612e-10 ± 5.0e-13", "x: −0.25003 · m = 2: 3.6040e-10 ± 5.0e-13",
                      "y: −0.25003 · m = 1: 3.6040e-10 ± 5.0e-13", "x: −0.25003", ""):
            self.assertIn("obtained is", self.compared(moved, "30 %", near, mean)[0][0])

    def test_errors_are_shares_of_what_is_allowed(self):
        mean = (2, "mean", "m", 1, 4.0, [3.604e-10, 3.6e-10, 1e-12])
        self.assertIn("| 80 % |", self.compared("", "", mean, write=True)[1])       # of five standard errors
        self.assertIn("error is '80 %'", self.compared("m: 3.604e-10 ± 1.0e-12", "4.0 σ", mean)[0][0])

    def test_labels_are_what_is_compared(self):
        for said, label in (("deviation(std::sqrt(f(1, {2, 3})), 4)", "sqrt(f(1, {2, 3}))"), ("a[1] * b", "a\\[1\\] \\* b"),
                            ("a_very_long_name_of_a_function(with, arguments)", "a\\_very\\_long\\_name\\_of\\_a\\_function(with…")):
            row = self.compared("", "", (1, "near", said, 1, 0.3, [1.5, 1.5, 1e-3]), write=True)[1]
            self.assertEqual(row, f"| A1 | {label}: 1.5000 | 30 % | `A.b` |")

    def test_controls_and_failures_are_no_results(self):
        control = (2, "below", "t", 1, 0.5, [0.5, 1, 0])
        self.assertEqual(self.compared("", "", control, write=True, source="a();\nEXPECT(t);  // control: a diameter\n")[1],
                         "| A1 | as stated | – | `A.b` |")
        self.assertEqual(self.compared("", "", control, write=True)[1], "| A1 | t: 0.50 < 1.0 | 50 % | `A.b` |")
        self.assertIn("no numbers of A.c: run", self.compared("", "", control, tests="`A.c`")[0][0])

    def test_bounds_and_series(self):
        share = [(1, "above", "share", 1, 0.9, [0.66, 0.6, 0]), (2, "below", "share", 1, 0.9, [0.66, 0.75, 0])]
        self.assertEqual(self.compared("", "", *share, write=True)[1], "| A1 | share: 0.66 in 0.6 to 0.75 | – | `A.b` |")
        series = (1, "near", "x", 400, 0.002, [2, 2 + 2.5e-12, 1e-9])
        self.assertEqual(self.compared("", "", series, write=True)[1],
                         "| A1 | x: 400 numbers off by at most 2.5e-12 | <1 % | `A.b` |")

    def test_pictures_of_other_numbers_are_noticed(self):
        now = {"traced": [["A6", 3.6e-10, 3.61e-10, 4e-12]]}
        for was, same in ((now, True), ({"traced": [["A6", 3.6e-10, 3.605e-10, 4e-12]]}, True),
                          ({"traced": [["A6", 3.6e-10, 3.64e-10, 4e-12]]}, False), ({"traced": [["A6", 3.6e-10, 3.61e-10, 7e-12]]}, False),
                          ({"traced": [["A6", 3.7e-10, 3.61e-10, 4e-12]]}, False), ({"traced": [["A7", 3.6e-10, 3.61e-10, 4e-12]]}, False),
                          ({"other": now["traced"]}, False), (None, False)):
            self.assertEqual(draw_validation.same(was, now), same, was)

    def test_row_that_is_none_is_said(self):
        self.assertIn("write | as", self.compared("a | b", "", tests="`A.b`")[0][0])
        self.assertIn("no test", self.compared("", "", tests="A.b")[0][0])


if __name__ == "__main__":
    unittest.main()
