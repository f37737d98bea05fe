#!/usr/bin/env python3
"""Fail when a module of src/ includes a module that src/base/namespaces.hpp does not list for it, when a file opens the namespace of
another module, when headers of the folders of one module include each other in a circle, or when two headers of one module define a
type of one name, which the linker would take for one.
Usage: check_includes.py SRC_DIR"""
import collections
import pathlib
import re
import sys

NAMESPACES = pathlib.Path(__file__).parents[2] / "src/base/namespaces.hpp"


def modules():
    """Modules that each may include besides itself, from the directives of base/namespaces.hpp."""
    may = {"base": set()}
    for name, text in re.findall(r"^namespace (\w+) \{(.*?)\}", NAMESPACES.read_text().split("namespace straytrace {")[1], re.MULTILINE | re.DOTALL):
        may[name] = {"base", *re.findall(r"using namespace (\w+);", text)}
    return may


MAY_INCLUDE = modules()
NARROW = {                             # (module, other): the only files it may take from there
    ("noise", "beams"): {"beams/cavity_mode.hpp"},
    ("noise", "trace"): {"trace/coupling.hpp"},
    ("results", "trace"): {"trace/coupling.hpp", "trace/result.hpp"},
    ("results", "wave"): {"wave/arm/wave_record.hpp", "wave/ring/ring_record.hpp"},
    ("report", "wave"): {"wave/arm/wave_record.hpp"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*"((' + "|".join(MAY_INCLUDE) + r')/[^"]+)"')
TYPE = re.compile(r"(?<!>\n)^(?:struct|class) (?:alignas\([^)]*\) )?(\w+)[^;\n]*\{", re.MULTILINE)    # of no template


OPENED = re.compile(r"^namespace straytrace(?:::(\w+))?[\w:]* \{\n((?:(?:template <.*>\n)?(?:class|struct) \w+;.*\n)*)(\})?", re.MULTILINE)


def doubles(src):
    first = {}
    for path in sorted(pathlib.Path(src).rglob("*.hpp")):
        module = path.relative_to(src).parts[0]
        for name in TYPE.findall(path.read_text()):
            if first.setdefault((module, name), path) != path:
                yield f"{path}: '{name}' is a type of {first[module, name]} already; give it a name of its own"


def foreign_namespaces(src):
    """Declarations of a type of another module (class World;) stay in the namespace of that module."""
    for path in sorted(pathlib.Path(src).rglob("*.[hc]*")):
        module = path.relative_to(src).parts[0]
        wanted = None if module == "base" else module
        text = path.read_text()
        for hit in OPENED.finditer(text):
            only_declares = hit[2] and hit[3]
            foreign = hit[1] in MAY_INCLUDE if wanted is None else hit[1] != wanted
            if foreign and not only_declares:
                line = text.count("\n", 0, hit.start()) + 1
                yield f"{path}:{line}: opens a namespace of another module; write straytrace{'' if wanted is None else '::' + wanted}"


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
        if other != module and other not in MAY_INCLUDE[module] and (module, other) not in NARROW:
            yield f"{path}:{number}: {module} may not include {other}"
        elif file not in NARROW.get((module, other), {file}):
            yield f"{path}:{number}: {module} may not include {file}"
        if file == "base/every_module.hpp":
            yield f"{path}:{number}: {file} is for tests, benchmarks and fuzzers"
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


found = [*problems(sys.argv[1]), *foreign_namespaces(sys.argv[1]), *circles(sys.argv[1]), *doubles(sys.argv[1])]
print("\n".join(found) or "all includes allowed")
sys.exit(1 if found else 0)
