#!/usr/bin/env python3
"""Write the tables of docs/reference/library.md from the output of `straytrace library`.

Usage: make_library_page.py [--check] PROGRAM

--check changes nothing and fails when the page is not up to date.
"""
import json
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parents[1] / "docs" / "reference" / "library.md"
NUMBER = re.compile(r'^  (\w+): \{value: ([^,]+), status: (\w+), source: "([^"]*)"\}', re.MULTILINE)


def table(titles, rows):
    lines = ["| " + " | ".join(titles) + " |", "| " + " | ".join("---" for _ in titles) + " |"]
    return "\n".join(lines + ["| " + " | ".join(cell.replace("|", "\\|") or " " for cell in row) + " |" for row in rows])


def joined(*texts):
    return "; ".join(text for text in texts if text)


def materials(entries):
    by_file = {}
    for e in entries:
        by_file.setdefault(e["include"], []).append(
            (f"`{e['name']}`", e["value"], e["wavelength"], e["status"], joined(e["source"], e["note"])))
    titles = ("material", "value, or low / mid / high", "wavelength", "status", "source")
    return "\n\n".join(f"`{file}`\n\n" + table(titles, rows) for file, rows in by_file.items())


def detectors(entries):
    numbers = {e["name"]: {n: rest for n, *rest in NUMBER.findall(e["text"])} for e in entries}
    names = list(next(iter(numbers.values())))
    mark = {"assumed": " †", "derived": " ‡"}
    return table(("", *(f"`{d}`" for d in numbers)),
                 [(f"`{n}`", *(v[n][0] + mark.get(v[n][1], "") for v in numbers.values())) for n in names])


def media(entries):
    return table(("medium", "index", "at", "source"),
                 [(f"`{e['name']}`", e["value"][2:], e["wavelength"], e["source"]) for e in entries])


def parts(entries):
    by_file = {}
    for e in entries:
        if e["include"]:
            by_file.setdefault(e["include"], []).append((f"`{e['name']}`", e["note"], e["value"], e["source"]))
    return "\n\n".join(f"`{file}`\n\n" + table(("part", "what", "parameters (defaults)", "sizes from"), rows)
                       for file, rows in by_file.items())


def main(program, check):
    said = subprocess.run([program, "library", "--format", "json"], text=True, capture_output=True, check=True).stdout
    entries = json.loads(said)
    text = old = PAGE.read_text(encoding="utf-8")
    for kind, made in (("material", materials), ("detector", detectors), ("medium", media), ("part", parts)):
        body = made([e for e in entries if e["kind"] == kind])
        mark = re.compile(rf"(<!-- {kind}: made by tools/make_library_page.py -->\n).*?(<!-- end -->)", re.DOTALL)
        if not mark.search(text):
            sys.exit(f"{PAGE.name}: no place for the table of kind '{kind}'")
        text = mark.sub(lambda m: f"{m.group(1)}\n{body}\n\n{m.group(2)}", text)
    if text == old:
        return
    if check:
        sys.exit(f"{PAGE.name} is not what the library says: run tools/make_library_page.py build/straytrace")
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--check"]
    if len(words) != 1:
        sys.exit(__doc__)
    main(words[0], "--check" in sys.argv)
