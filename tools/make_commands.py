#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Write the tables of docs/reference/commands.md from `--help` of every command; the text between them is written by hand.

Usage: make_commands.py [--write] PROGRAM [PAGE]

Without --write: exit code 1 when the page differs from the program.

Example:
  python3 tools/make_commands.py --write build/straytrace
"""
import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parents[1] / "docs/reference/commands.md"
LINKS = {"report": "report.md", "view": "report.md#view", "signal": "signal.md", "couple": "couple.md", "schema": "#explain"}
GROUP = re.compile(r"^([A-Z][\w -]*):$")
ENTRY = re.compile(r"^  (\S.*)$")
OPTION = re.compile(r"^((?:-\w,)?--[a-z][a-z0-9-]*(?:,--[a-z][a-z0-9-]*)*)(?: (?!  )(.*))?$")
ORDER = ("Model", "Light", "Motion", "Data", "Tracing", "Analysis", "Spectra", "Selection", "Picture", "Computing", "Output")


def entries_of(text):
    """(group, left column, right column) of what a help lists; the right column may begin on the next line."""
    group, open_entry = "", None
    for line in [*text.splitlines(), ""]:
        if open_entry and line.startswith(" " * 28) and line.strip():
            open_entry[2] = f"{open_entry[2]} {line.strip()}".strip()
            continue
        if open_entry:
            yield tuple(open_entry)
        open_entry = None
        if match := GROUP.match(line):
            group = match[1]
        elif group and (match := ENTRY.match(line)):
            left, _, right = match[1].partition("  ")
            open_entry = [group, left.strip(), right.strip()]
        elif not line.startswith(" "):
            group = ""


def help_of(program, *words):
    return list(entries_of(subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True).stdout))


def as_markdown(text):
    """Quoted values in code font, other characters escaped."""
    parts = re.split(r"""('[^']*"[^']*'|"[^"]*")""", text)
    plain = [re.sub(r"([|*_<\[\]])", r"\\\1", part) for part in parts[::2]]
    code = [f"`{part[1:-1]}`".replace("|", "\\|") for part in parts[1::2]] + [""]
    return "".join(a + b for a, b in zip(plain, code))


def options_of(program, words):
    """(group, names, description) of one command, and its subcommands."""
    for group, left, right in help_of(program, *words):
        if group == "Subcommands":
            yield None, left, right
        elif group.endswith("options") and (match := OPTION.match(left)):
            default = re.search(r"=(.+?)(?: REQUIRED)?$", match[2] or "")
            names = ", ".join(f"`{name}`" for name in match[1].split(","))
            notes = [right] + ([f"default: {default[1]}"] if default and "default" not in right else []) + \
                (["required"] if (match[2] or "").endswith("REQUIRED") else [])
            if "--help" not in match[1]:
                yield group.removesuffix(" options"), names, as_markdown("; ".join(note for note in notes if note))


def tables(program):
    """The two tables, by the names of their markers."""
    tasks = [entry for entry in help_of(program) if not entry[0].endswith("options")]
    commands = ["| task | command | purpose |", "| --- | --- | --- |"]
    for task, name, purpose in tasks:
        if re.fullmatch(r"[a-z]+", name):
            commands.append(f"| {task} | [{name}]({LINKS.get(name, '#' + name)}) | {as_markdown(purpose)} |")
    used, waiting = {}, [(name,) for _, name, _ in tasks if re.fullmatch(r"[a-z]+", name)]
    while waiting:
        words = waiting.pop(0)
        inner = []
        for group, names, text in options_of(program, words):
            if group is None:
                inner.append((*words, names))
            else:
                used.setdefault((group, names, text), []).append(" ".join(words))
        waiting = inner + waiting
    groups = sorted({group for group, _, _ in used}, key=lambda group: (ORDER.index(group) if group in ORDER else len(ORDER), group))
    options = []
    for group in groups:
        options += [f"### {group} options", "", "| option | commands | |", "| --- | --- | --- |"]
        options += [f"| {names} | {', '.join(of)} | {text} |" for (inside, names, text), of in used.items() if inside == group] + [""]
    return {"commands": "\n".join(commands) + "\n\n", "options": "\n".join(options) + "\n"}


def main():
    words = [word for word in sys.argv[1:] if word != "--write"]
    if not words or "--help" in words or "-h" in words:
        sys.exit(__doc__)
    page = pathlib.Path(words[1]) if len(words) > 1 else PAGE
    text = page.read_text(encoding="utf-8")
    made = text
    for name, table in tables(words[0]).items():
        marked = re.compile(rf"(?<=<!-- {name}: tools/make_commands.py -->\n\n).*?(?=<!-- end -->)", re.DOTALL)
        if not marked.search(made):
            sys.exit(f"{page}: no place for the table of {name}: <!-- {name}: tools/make_commands.py -->, an empty line, <!-- end -->")
        made = marked.sub(lambda _: table, made, count=1)
    if "--write" in sys.argv:
        page.write_text(made, encoding="utf-8")
    elif made != text:
        sys.exit(f"{page.name} differs from --help: run tools/make_commands.py --write {words[0]}")
    print(f"{page.name} agrees with --help")


if __name__ == "__main__":
    main()
