#!/usr/bin/env python3
"""Fail for a circle of imports among the Python modules of the tree. Imports within functions count, those for types alone
(`if TYPE_CHECKING:`) do not. Usage: check_imports.py [ROOT]"""
import ast
import pathlib
import sys

FOLDERS = ("python", "tools", "tests", "bench")


def import_nodes(node):
    """Import statements that run, wherever they are."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.Import, ast.ImportFrom)):
            yield child
        elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            yield from (found for part in child.orelse for found in import_nodes(ast.Module([part], [])))
        else:
            yield from import_nodes(child)


def module_file(folder, dotted):
    """The file of `dotted` below `folder`, or None."""
    place = folder.joinpath(*dotted.split(".")) if dotted else folder
    for file in (place.with_suffix(".py"), place / "__init__.py"):
        if file.is_file():
            return file
    return None


def imported_files(path, scripts, packages):
    """{file: line} of what a module imports: of its own folder or package, of folders of scripts, of the folder of packages."""
    found = {}
    own = [packages] if (path.parent / "__init__.py").exists() else [path.parent, *scripts, packages]
    for node in import_nodes(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names, folders = [alias.name for alias in node.names], own
        else:
            base = f"{node.module}." if node.module else ""
            names = [node.module or "", *(base + alias.name for alias in node.names)]
            folders = [path.parents[node.level - 1]] if node.level else own
        for name in names:
            file = next((file for folder in folders if (file := module_file(folder, name))), None)
            if file and file != path:
                found.setdefault(file, node.lineno)
    return {file: line for file, line in found.items()           # a package is loaded before its modules
            if file.name != "__init__.py" or file.parent not in path.parents}


def circles(graph):
    """Each circle once, as the list of its files."""
    state, trail = {}, []

    def visit(file):
        state[file] = "open"
        trail.append(file)
        for other in graph.get(file, ()):
            if state.get(other) == "open":
                yield trail[trail.index(other):]
            elif other not in state:
                yield from visit(other)
        trail.pop()
        state[file] = "done"

    for file in graph:
        if file not in state:
            yield from visit(file)


def main(root):
    files = [file for folder in FOLDERS for file in sorted((root / folder).rglob("*.py")) if "corpus" not in file.parts]
    if not files:
        print(f"{root}: no Python modules found in {', '.join(FOLDERS)}; is the path right?")
        return 1
    scripts = sorted({file.parent for file in files if not (file.parent / "__init__.py").exists()})
    graph = {file: imported_files(file, scripts, root / "python") for file in files}
    found = []
    for circle in circles(graph):
        first, second = circle[0], (circle + circle)[1]
        way = " -> ".join(str(file.relative_to(root)) for file in [*circle, first])
        found.append(f"{first.relative_to(root)}:{graph[first][second]}: closes a circle of imports: {way}")
    print("\n".join(found) or f"{len(files)} Python modules import each other in no circle")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()))
