#!/usr/bin/env python3
"""Writes docs/reference/python.md from the docstrings of the package, or fails when it is another. Needs its libraries.

Usage: python_reference.py [--write]
"""
import dataclasses
import importlib
import inspect
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reference" / "python.md"
sys.path.insert(0, str(ROOT / "python"))
sys.dont_write_bytecode = True

import straytrace  # noqa: E402

HEAD = """# Python

Reference of `import straytrace`; see also the [guide](../guide/python.md). `tools/python_reference.py --write` makes this page from the
docstrings. Arrays are numpy arrays, `[n]` is over frequency, tables are pandas data frames. Strains are one-sided ASDs in
1/sqrt(Hz) unless stated otherwise.

"""
PARTS = (
    ("Models", "straytrace", ("Model", "Table", "Items", "quantity", "Check", "check", "run", "trace")),
    ("Results", "straytrace", ("open", "Run", "Noise", "Curve", "Bands", "Positions", "Routes", "EnergyBalance", "Receiver", "Receivers", "Wave", "WaveRing", "SeamCheck", "Irradiance", "Sensitivity", "SensitiveInput",
                               "Progress")),
    ("Paths", "straytrace", ("Paths", "Path", "PathColumn")),
    ("Scans", "straytrace", ("scan", "Scan", "ScanPoint")),
    ("Optimisation", "straytrace", ("optimise", "Optimum", "Candidate")),
    ("Interferometers", "straytrace", ("Interferometer",)),
    ("Errors", "straytrace", ("Problem", "InputError", "RunError", "NumericalError", "StraytraceWarning")),
    ("Inside the process", "straytrace.native", ("available", "Model", "Run", "open_run", "Noise")),
    ("FINESSE", "straytrace.finesse", ("response", "Response")),
    ("pygwinc", "straytrace.pygwinc", ("StrayLight", "read_strain")),
)
INTRODUCED = {"Paths": "straytrace.paths", "Inside the process": "straytrace.native", "FINESSE": "straytrace.finesse"}    # the docstring of the module comes first
FIELD = re.compile(r"^    (\w+): (.*?)(?:  +# (.*))?$")
ARGUMENT = re.compile(r"^([a-z]\w*(?:, [a-z]\w*)*): (.*)")


def prose(text):
    """Markdown of a docstring: `name: words` become a list, `::` and what is set in below it code."""
    out, inside = [], False
    for line in inspect.cleandoc(text).split("\n"):
        if inside and line and not line.startswith(" "):
            out[-1:] = ["```", ""]
            inside = False
        if inside:
            out.append(line[4:])
        elif line.endswith("::"):
            out += [line[:-1], "", "```python"]
            inside = True
        elif found := ARGUMENT.match(line):
            if out and out[-1] and not out[-1].startswith(("* ", "  ")):
                out.append("")
            out.append("* " + ", ".join(f"`{n}`" for n in found[1].split(", ")) + ": " + found[2])
        elif line and out and out[-1].startswith(("* ", "  ")):
            out.append("  " + line)
        else:
            out.append(line)
    if inside:
        out.append("```")
    return re.sub(r"```python\n\n", "```python\n", re.sub(r"``([^`\n]+)``", r"`\1`", "\n".join(out)))


def signature(name, thing):
    text = re.sub(r"\b(?:[a-z_]+\.)+([A-Z]\w+)", r"\1", str(inspect.signature(thing)))
    text = re.sub(r"(: |-> )(['\"])(.*?)\2", r"\1\3", re.sub(r"\((self|cls)(, )?", "(", text))
    return "\n".join(textwrap.wrap(name + text, 118, subsequent_indent=" " * (len(name) + 1), break_on_hyphens=False))


def fields(kind):
    """A row per field: type and the comment in the source."""
    rows = []
    for line in inspect.getsource(kind).split("\n"):
        found = FIELD.match(line)
        if found and found[1] in {f.name for f in dataclasses.fields(kind) if f.repr}:
            shown = found[2].split(" = ")[0].strip('"').replace("|", "\\|")
            rows.append(f"| `{found[1]}` | `{shown}` | {(found[3] or '').replace('|', chr(92) + '|')} |")
    return ["| field | type | |", "| --- | --- | --- |", *rows, ""] if rows else []


def of_class(name, kind):
    yield f"### {name}\n"
    if not dataclasses.is_dataclass(kind) and "__init__" in vars(kind) and name in ("Model",):
        yield f"```python\n{signature(name, kind.__init__)}\n```\n"
    yield prose(kind.__doc__) + "\n"
    if dataclasses.is_dataclass(kind):
        yield "\n".join(fields(kind))
    for key, member in vars(kind).items():
        function = getattr(member, "__func__", member)
        if key == "__call__" or not key.startswith("_"):
            if isinstance(member, property):
                yield f"`{name}.{key}`: {prose(member.fget.__doc__)}\n"
            elif inspect.isfunction(function) and function.__doc__:
                shown = name + ("." + key if key != "__call__" else "")
                yield f"```python\n{signature(shown, function)}\n```\n\n{prose(function.__doc__)}\n"


def page():
    text = HEAD
    for title, module, names in PARTS:
        home = importlib.import_module(module)
        text += f"## {title}\n\n"
        if title in INTRODUCED:
            text += prose(importlib.import_module(INTRODUCED[title]).__doc__) + "\n\n"
        for name in names:
            thing = getattr(home, name)
            if inspect.isclass(thing):
                text += "\n".join(of_class(name, thing)) + "\n"
            else:
                text += f"### {name}\n\n```python\n{signature(name, thing)}\n```\n\n{prose(thing.__doc__)}\n\n"
    return re.sub(r"\n{3,}", "\n\n", text).rstrip("\n") + "\n"


def main():
    missing = set(straytrace.__all__) - {name for _, _, names in PARTS for name in names} - {"open_run"}
    if missing:
        print(f"not on the page: {', '.join(sorted(missing))}")
        return 1
    if "--write" in sys.argv:
        PAGE.write_text(page(), encoding="utf-8")
    same = PAGE.exists() and PAGE.read_text(encoding="utf-8") == page()
    print("the page agrees with the code" if same else f"{PAGE} differs from the code: run tools/python_reference.py --write")
    return not same


if __name__ == "__main__":
    sys.exit(main())
