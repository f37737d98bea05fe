#!/usr/bin/env python3
"""Fail for a header that does not compile on its own. Usage: check_headers.py BUILD_DIR [SRC_DIR]

Compiler, standard and include folders are those of BUILD_DIR/compile_commands.json. A header that the first include of
a built source names has been compiled on its own by the build; only the others are compiled here.
"""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

WITH_VALUE = {"-isystem", "-include", "-I", "-D"}
INCLUDE = re.compile(r'^#include ["<]([^">]+)', re.MULTILINE)


def first_included(build, src):
    """Names that the first #include of each source under src gives, of the sources that the build compiles."""
    found = set()
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if entry["file"].startswith(str(src)) and (name := INCLUDE.search(pathlib.Path(entry["file"]).read_text())):
            found.add(name.group(1))
    return found


def compiler_call(build, src):
    """Compiler and flags with which every header under src can be read."""
    call, flags = [], {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        words = shlex.split(entry["command"])
        if not entry["file"].startswith(str(src)):
            continue
        compiler = next(i for i, word in enumerate(words) if "ccache" not in word)
        call = words[compiler:compiler + 1]
        rest = iter(words[compiler + 1:])
        for word in rest:
            if word in WITH_VALUE:
                flags[(word, next(rest))] = None
            elif word.startswith(("-I", "-D", "-std=", "-W")):
                flags[(word,)] = None
    return call + [word for group in flags for word in group]


def problem_of(call, src, header):
    name = str(header.relative_to(src))
    done = subprocess.run(call + ["-fsyntax-only", "-x", "c++", "-include", name, "/dev/null"], capture_output=True,
                          text=True)
    return f"{name} does not compile on its own:\n{done.stderr}" if done.returncode else ""


def main(build, src):
    headers = sorted(src.rglob("*.hpp"))
    call = compiler_call(build, src) if headers else []
    if not call:
        print(f"{build}: nothing to check; are the paths right?")
        return 1
    built = first_included(build, src)
    left = [header for header in headers if str(header.relative_to(src)) not in built]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = [p for p in pool.map(lambda header: problem_of(call, src, header), left) if p]
    print("\n".join(found) or f"{len(headers)} headers compile on their own, {len(left)} of them compiled here")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(),
                  pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).parents[2] / "src").resolve()))
