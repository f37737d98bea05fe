#!/usr/bin/env python3
"""Fail when a module of src/ includes a module that the table does not allow, when headers of the folders of one module include each other in
a circle, or when two headers define a type of one name, which the linker would take for one.
Usage: check_includes.py SRC_DIR"""
import collections
import pathlib
import re
import sys

MAY_INCLUDE = {                        # module: other modules that it may include
    "base": "",
    "io": "base",
    "geometry": "base",
    "optics": "base",
    "beams": "base geometry optics",
    "spectra": "base io",
    "analysis": "base io spectra",
    "motion": "base io spectra",
    "scene": "base io",
    "world": "base io geometry optics beams scene",
    "trace": "base geometry optics beams world",
    "ifo": "base beams spectra",
    "noise": "base beams spectra motion trace ifo",
    "results": "base io spectra motion beams scene world trace ifo noise",
    "report": "base io geometry beams motion scene world trace noise results",
    "session": "base io beams spectra analysis motion scene world trace ifo noise results report",
    "cli": "base io beams spectra analysis motion scene world trace ifo noise results report session",
}
NARROW = {                             # (module, other): the only files it may take from there
    ("noise", "beams"): {"beams/cavity_mode.hpp"},
    ("noise", "trace"): {"trace/coupling.hpp"},
    ("results", "trace"): {"trace/coupling.hpp", "trace/result.hpp"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*"((' + "|".join(MAY_INCLUDE) + r')/[^"]+)"')
TYPE = re.compile(r"(?<!>\n)^(?:struct|class) (?:alignas\([^)]*\) )?(\w+)[^;\n]*\{", re.MULTILINE)    # of no template


def doubles(src):
    first = {}
    for path in sorted(pathlib.Path(src).rglob("*.hpp")):
        for name in TYPE.findall(path.read_text()):
            if first.setdefault(name, path) != path:
                yield f"{path}: '{name}' is a type of {first[name]} already; give it a name of its own"


def includes(src):
    """File, number of the line, file included, its module."""
    for path in sorted(pathlib.Path(src).rglob("*.[hc]*")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if hit := INCLUDE.match(line):
                yield path, number, *hit.groups()


def problems(src):
    seen = 0
    for path in sorted(pathlib.Path(src).rglob("*.[hc]*")):
        module = path.relative_to(src).parts[0]
        if module not in MAY_INCLUDE:
            yield f"{path}: module '{module}' is not in the map"
    for path, number, file, other in includes(src):
        module = path.relative_to(src).parts[0]
        seen += 1
        if module not in MAY_INCLUDE:
            continue
        if other != module and other not in MAY_INCLUDE[module].split():
            yield f"{path}:{number}: {module} may not include {other}"
        elif file not in NARROW.get((module, other), {file}):
            yield f"{path}:{number}: {module} may not include {file}"
    if seen == 0:
        yield f"{src}: no project includes found; is the path right?"


def folder_of(file):
    """A folder of a module, 'trace/tally'; what lies deeper counts as part of it."""
    return "/".join(pathlib.PurePath(file).parts[:-1][:2])


def circles(src):
    """Sources end every chain, so only headers can close a circle."""
    known = collections.defaultdict(dict)
    for path, number, file, _ in includes(src):
        here = folder_of(path.relative_to(src))
        if path.suffix == ".hpp" and folder_of(file) != here:
            known[here].setdefault(folder_of(file), f"{path}:{number}")
    told, closed = set(), set()

    def follow(folder, way):
        if folder in way:
            circle = way[way.index(folder):] + [folder]
            if frozenset(circle) not in told:
                told.add(frozenset(circle))
                yield f"{known[way[-1]][folder]}: closes a circle of folders, {' > '.join(circle)}"
        elif folder not in closed:
            for other in sorted(known[folder]):
                yield from follow(other, [*way, folder])
            closed.add(folder)

    for folder in sorted(known):
        yield from follow(folder, [])


found = [*problems(sys.argv[1]), *circles(sys.argv[1]), *doubles(sys.argv[1])]
print("\n".join(found) or "all includes allowed")
sys.exit(1 if found else 0)
