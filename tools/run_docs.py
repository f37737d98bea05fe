#!/usr/bin/env python3
"""Run the commands of the documents and compare what they print; check the complete scenes in them.

Usage: run_docs.py [--write] [--night] PROGRAM [ROOT] [NAME.md...]

Pages, all or those named, are read in the order of the list below, in one temporary folder that holds examples/, python/ and
build/straytrace. A page alone lacks the files that earlier pages make.
In a ```console block each line `$ command` is run. It must exit with 0, or with N where the line ends in `# exit N`.
The lines below it, if any, are what it prints, all and in this order; a line `...` stands for anything left out.
On every page a ```yaml block that begins with `straytrace:` is complete and must pass `straytrace check --strict`.
Where a comment `# NAME.yaml` comes first, it is also written to that file for later commands; a motion file, which has no `beams:` and
no `include:`, is not checked alone.
A block marked ```console night takes minutes: it is run with --night alone (scripts/nightly).
The table under "## Options" of the page of commands names for each command the options that its --help prints, and the table
under "## Commands" of README.md the commands that --help prints.
--write puts the nearest printed line in place of each line that differs; run the page again without it afterwards.
"""
import difflib
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PAGES = ("README.md", "docs/guide/*.md", "docs/reference/commands.md", "docs/reference/filter.md", "docs/reference/ghosts.md",
         "docs/reference/cad.md", "docs/reference/signal.md", "docs/reference/couple.md", "docs/reference/fit.md", "docs/reference/report.md",
         "docs/reference/maps.md", "docs/reference/layouts.md", "docs/reference/scatter/measured_files.md", "docs/theory/*.md")
NOT_RUN = ("scripts/setup", "scripts/build", "scripts/demo", "scripts/test", "scripts/lint")   # install or build
BLOCK = re.compile(r"^```(console|yaml)( night)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"# ([\w-]+\.yaml)\n(?=straytrace:)")
EXIT = re.compile(r"\s+# exit (\d+)$")
RUN_DEPENDENT = (                                        # all that may differ between two equal runs
    (re.compile(r"projected in [0-9.]+ s"), "projected in TIME s"),
    (re.compile(r"created +\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ"), "created DATE"),
    (re.compile(r"(straytrace \d+\.\d+\.\d+) \([0-9a-z-]+\)"), r"\1 (COMMIT)"),
)
README, COMMANDS_PAGE = PAGES[0], PAGES[2]
OPTION = re.compile(r"--[a-z-]+")
PROGRESS = re.compile(r"^(trace|ghosts|project|figure of merit)  ")     # comes with the clock


def normal(line):
    for pattern, word in RUN_DEPENDENT:
        line = pattern.sub(word, line)
    return line.rstrip()


def commands(block):
    """Command, exit code wanted, lines wanted as (their number in the block from 0, text)."""
    found = []
    for number, line in enumerate(block.splitlines()):
        if line.startswith("$ "):
            code = EXIT.search(line)
            found.append((EXIT.sub("", line[2:]), int(code.group(1)) if code else 0, []))
        elif line.strip() and found:
            found[-1][2].append((number, line))
    return found


def differences(wanted, printed):
    """(number of the expected line, its text, printed line or None); without a number: something more was printed."""
    lines = [line for line in map(normal, printed) if line and not PROGRESS.match(line)]
    at, gap = 0, False
    for number, line in wanted:
        if line.strip() == "...":
            gap = True
            continue
        rest = lines[at:] if gap else lines[at:at + 1]
        if normal(line) in rest:
            at += rest.index(normal(line)) + 1
        else:
            near = difflib.get_close_matches(normal(line), rest, 1, 0.5) if gap else rest
            yield number, line, near[0] if near else None
            at += rest.index(near[0]) + 1 if near else 0
        gap = False
    if wanted and not gap and at < len(lines):
        yield None, "", lines[at]


def run(command, folder):
    done = subprocess.run(["stdbuf", "-oL", "bash", "-c", command], cwd=folder, text=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return done.returncode, done.stdout


def problems_of_console(block, first, folder, corrected):
    """'corrected' maps the line of the page, counted from 0, to what is printed; the block begins at line 'first'."""
    for command, code, wanted in commands(block):
        if command.split()[0] in NOT_RUN:
            continue
        got, output = run(command, folder)
        if got != code:
            yield f"'{command}' exits with {got}, not {code}:\n{output}"
            continue
        for number, line, instead in differences(wanted, output.splitlines()):
            if line and instead:
                corrected[first + number] = instead
            yield f"'{command}' does not print '{line}'; there stands '{instead}'" if line else \
                f"'{command}' prints more: '{instead}'"


def problems_of_scene(block, folder):
    named = NAMED.match(block)
    if named or block.startswith("straytrace:"):
        name = named[1] if named else "scene_of_page.yaml"
        (folder / name).write_text(block, encoding="utf-8")
        motion = named and not re.search(r"^(beams|include):", block, re.MULTILINE)
        code, output = (0, "") if motion else run(f"build/straytrace check --strict {name}", folder)
        if code:
            yield f"the scene does not pass 'straytrace check --strict':\n{output}"


def problems_of_options(page, folder):
    """Options of the table against those of --help, command by command."""
    table = page.read_text(encoding="utf-8").split("\n## Options\n")[-1].split("\n## ")[0]
    rows = [[cell.strip() for cell in row.split(" | ")[:2]] for row in table.splitlines() if row.startswith("| `")]
    for command in sorted({name for row in rows for name in row[1].split(", ")}):
        named = {option for row in rows if command in row[1].split(", ") for option in OPTION.findall(row[0])}
        printed = set(re.findall(r"^  (?:-\w,)?(--[a-z-]+)", run(f"build/straytrace {command} --help", folder)[1], re.M))
        if wrong := sorted(named ^ (printed - {"--help"})):
            yield f"options of '{command}' in the table and in --help differ: {', '.join(wrong)}"
    if not rows:
        yield "no table of options found"


def problems_of_commands(page, folder):
    """Commands of the table of the README against those of --help."""
    table = page.read_text(encoding="utf-8").split("\n## Commands\n")[-1].split("\n## ")[0]
    named = set(re.findall(r"^\| `straytrace ([a-z]+)", table, re.M))
    printed = set(re.findall(r"^  (?!straytrace )([a-z]+) ", run("build/straytrace --help", folder)[1], re.M))
    if wrong := sorted(named ^ printed):
        yield f"commands in the table and in --help differ: {', '.join(wrong)}"


def problems_of(page, root, folder, corrected, night):
    text = page.read_text(encoding="utf-8")
    consoles = any(page in root.glob(pattern) for pattern in PAGES)
    for block in BLOCK.finditer(text):
        kind, at_night, content = block.groups()
        if at_night and not night:
            continue
        first = text.count("\n", 0, block.start(3))
        found = problems_of_scene(content, folder) if kind == "yaml" else \
            problems_of_console(content, first, folder, corrected) if consoles else ()
        for problem in found:
            yield f"{page.relative_to(root)}:{first}: {problem}"


def main(program, root, named, write, night):
    first = [page for pattern in PAGES for page in sorted(root.glob(pattern))]
    pages = first + [page for page in sorted((root / "docs").rglob("*.md")) if page not in first]
    if named:
        pages = [page for page in pages if page in named]
    if not first or len(pages) < len(named):
        print(f"{root}: pages not found; is the path right?")
        return 1
    found = []
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        (folder / "build").mkdir()
        (folder / "build" / "straytrace").symlink_to(program.resolve())
        for name in ("examples", "python"):
            if (root / name).is_dir():
                shutil.copytree(root / name, folder / name)
        for page in pages:
            corrected = {}
            found += problems_of(page, root, folder, corrected, night)
            if page == root / README:
                found += [f"{README}: {problem}" for problem in problems_of_commands(page, folder)]
            if page == root / COMMANDS_PAGE:
                found += [f"{COMMANDS_PAGE}: {problem}" for problem in problems_of_options(page, folder)]
            if write and corrected:
                lines = page.read_text(encoding="utf-8").split("\n")
                page.write_text("\n".join(corrected.get(number, line) for number, line in enumerate(lines)), encoding="utf-8")
    print("\n".join(found) or f"{len(pages)} pages do what they say")
    return 1 if found else 0


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word not in ("--write", "--night")]
    if not words:
        sys.exit(__doc__)
    places = [word for word in words[1:] if not word.endswith(".md")]
    sys.exit(main(pathlib.Path(words[0]), pathlib.Path(places[0] if places else pathlib.Path(__file__).parents[1]).resolve(),
                  {pathlib.Path(word).resolve() for word in words[1:] if word.endswith(".md")},
                  "--write" in sys.argv, "--night" in sys.argv))
