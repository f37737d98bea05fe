#!/usr/bin/env python3
"""Fail when a room includes a room it may not know, or when two headers define a type of one name, which the linker would
take for one. Usage: check_includes.py SRC_DIR"""
import pathlib
import re
import sys

ROOMS = ("base geometry optics beams hdf5 signal commission motion scene world trace ifo noise report page app").split()
MAY_INCLUDE = {                        # room: rooms it may include besides itself
    "base": "",
    "geometry": "base",
    "optics": "base",
    "beams": "base geometry optics",
    "hdf5": "base",
    "signal": "base hdf5",
    "commission": "base signal",
    "motion": "base signal",
    "scene": "base",
    "world": "base geometry optics beams scene",
    "trace": "base geometry optics beams world",
    "ifo": "base beams signal",
    "noise": "base beams signal motion trace ifo",
    "report": "base hdf5 signal motion beams scene world trace ifo noise",
    "page": "base geometry beams motion scene world trace noise report",
    "app": "base beams hdf5 signal commission motion scene world trace ifo noise report page",
}
NARROW = {                             # (room, other): the only files it may take from there
    ("noise", "beams"): {"beams/cavity_mode.hpp"},
    ("noise", "trace"): {"trace/coupling.hpp"},
    ("report", "trace"): {"trace/coupling.hpp", "trace/result.hpp"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*"((' + "|".join(ROOMS) + r')/[^"]+)"')

TYPE = re.compile(r"(?<!>\n)^(?:struct|class) (?:alignas\([^)]*\) )?(\w+)[^;\n]*\{", re.MULTILINE)    # of no template


def doubles(src):
    first = {}
    for path in sorted(pathlib.Path(src).rglob("*.hpp")):
        for name in TYPE.findall(path.read_text()):
            if first.setdefault(name, path) != path:
                yield f"{path}: '{name}' is a type of {first[name]} already; give it a name of its own"


def problems(src):
    seen = 0
    for path in sorted(pathlib.Path(src).rglob("*.[hc]*")):
        room = path.relative_to(src).parts[0]
        if room not in MAY_INCLUDE:
            yield f"{path}: room '{room}' is not in the map"
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if not (hit := INCLUDE.match(line)):
                continue
            seen += 1
            file, other = hit.groups()
            if other != room and other not in MAY_INCLUDE[room].split():
                yield f"{path}:{number}: {room} may not include {other}"
            elif file not in NARROW.get((room, other), {file}):
                yield f"{path}:{number}: {room} may not include {file}"
    if seen == 0:
        yield f"{src}: no project includes found; is the path right?"


found = [*problems(sys.argv[1]), *doubles(sys.argv[1])]
print("\n".join(found) or "all includes allowed")
sys.exit(1 if found else 0)
