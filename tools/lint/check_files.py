#!/usr/bin/env python3
"""Fail for a source file that is too long, unlicensed, untidy or unfinished, and for a folder with too many entries. Usage: check_files.py [ROOT]"""
import pathlib
import re
import sys

FOLDERS = ("src", "step", "tests", "fuzz", "python", "tools", "bench")
CPP = {".cpp", ".hpp", ".h", ".cu"}
SOURCES = CPP | {".py", ".sh", ".txt"}            # .txt: only CMakeLists.txt, data files are not sources
MAX_LINES = 600
MAX_ENTRIES = {"src": 30}                         # files and folders that one folder shows; elsewhere:
ENTRIES_ELSEWHERE = 25
NO_ENTRIES = {"__pycache__", "corpus"}
SPDX = "// SPDX-License-Identifier: BSD-3-Clause"
UNFINISHED = re.compile(r"\b(" + "|".join(("TO" "DO", "FIX" "ME", "X" "XX")) + r")\b")


def sources(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.is_file() and "corpus" not in path.parts and path.suffix in SOURCES and (path.suffix != ".txt" or path.name == "CMakeLists.txt"):
                yield path


def problems_of(path):
    try:
        lines = path.read_bytes().decode("utf-8").split("\n")
    except UnicodeDecodeError:
        yield 1, "is not UTF-8"
        return
    if lines[-1] == "":
        lines.pop()
    else:
        yield len(lines), "does not end with a line break"
    if len(lines) > MAX_LINES:
        yield len(lines), f"has {len(lines)} lines; split it, {MAX_LINES} is the limit"
    if path.suffix in CPP and lines[:1] != [SPDX]:
        yield 1, f"must begin with '{SPDX}'"
    for number, line in enumerate(lines, 1):
        if "\t" in line:
            yield number, "holds a tab"
        if line != line.rstrip():
            yield number, "ends with white space"
        if found := UNFINISHED.search(line):
            yield number, f"says '{found.group()}': finish it, or open an issue and say nothing here"


def crowded_folders(root):
    for top in FOLDERS:
        for folder in [root / top, *sorted((root / top).rglob("*/"))]:
            if folder.is_dir() and not NO_ENTRIES & set(folder.parts):
                count = sum(entry.name not in NO_ENTRIES for entry in folder.iterdir())
                limit = MAX_ENTRIES.get(top, ENTRIES_ELSEWHERE)
                if count > limit:
                    yield f"{folder.relative_to(root)}: has {count} entries; sort them into folders, {limit} is the limit"


def main(root):
    files = list(sources(root))
    if not files:
        print(f"{root}: no source files found in {', '.join(FOLDERS)}; is the path right?")
        return 1
    found = [f"{path.relative_to(root)}:{line}: {what}" for path in files for line, what in problems_of(path)]
    found += crowded_folders(root)
    print("\n".join(found) or f"{len(files)} source files are in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()))
