#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The guard of the include graph must be able to fail."""
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[3]


def verdict(src):
    r = subprocess.run([sys.executable, SOURCE / "tools/lint/check_includes.py", src], capture_output=True, text=True)
    return r.returncode, r.stdout


def with_file(name, text, **more):
    """Exit code and output for a tree of one good file, this one and more."""
    with tempfile.TemporaryDirectory() as folder:
        for where, content in {"world/a.hpp": '#include "base/math/vec3.hpp"\n', name: text, **more}.items():
            path = pathlib.Path(folder, where)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content)
        return verdict(folder)


def expect(got, code, words):
    assert got[0] == code and words in got[1], f"wanted {code} and '{words}', got {got}"


expect(verdict(SOURCE / "src"), 0, "all includes allowed")
expect(with_file("trace/b.cpp", '#include "world/model/world.hpp"\n'), 0, "all includes allowed")
expect(with_file("trace/b.cpp", '#include "motion/motion.hpp"\n'), 1, "b.cpp:1: trace may not include motion")
expect(with_file("world/b.cpp", '\n#  include "motion/motion.hpp"\n'), 1, "b.cpp:2: world may not include motion")
expect(with_file("noise/b.cpp", '#include "trace/run/trace.hpp"\n'), 1, "noise may not include trace/run/trace.hpp")
expect(with_file("noise/b.cpp", '#include "trace/coupling.hpp"\n'), 0, "all includes allowed")
expect(with_file("attic/b.cpp", '#include "base/math/vec3.hpp"\n'), 1, "module 'attic' is not in the map")
up, down = '#include "world/search/s.hpp"\n', '#include "world/model/m.hpp"\n'
expect(with_file("world/model/m.hpp", up, **{"world/search/s.hpp": ""}), 0, "all includes allowed")
expect(with_file("world/model/m.hpp", up, **{"world/search/s.hpp": down}), 1, "closes a circle of folders, world/")
expect(with_file("world/model/m.hpp", up, **{"world/search/s.cpp": down}), 0, "all includes allowed")   # no circle of headers
with tempfile.TemporaryDirectory() as empty:
    expect(verdict(empty), 1, "no project includes found")
print("check_includes: all cases as expected")
