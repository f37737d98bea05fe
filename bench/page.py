#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Write the tables and pictures of docs/develop/benchmarks.md from the lines in bench/results.

In the page a table stands between a line that says what it shows and a line that ends it:

  <!-- bench engine: case | ours | theirs | ratio | spread -->
  <!-- bench engine where group=tube3: case, ray paths | ours -->
  <!-- goals -->
  <!-- end -->

Columns are fields of the lines, "field, heading" where the heading is another. Text around the tables is written by hand.

Examples:
  bench/page.py            write the page and the pictures
  bench/page.py --check    fail where the page is not what the lines say
"""
import argparse
import difflib
import json
import pathlib
import re
import sys

import pictures
from record import KEPT, SOURCE, newest

PAGE = SOURCE / "docs" / "develop" / "benchmarks.md"
PLACE = re.compile(r"^<!-- (bench|goals)(?: ([^\n]*?))? -->\n.*?^<!-- end -->$", re.MULTILINE | re.DOTALL)
TABLE = re.compile(r"(\w+)(?: where (\w+)=([^:]+))?: (.*)")
PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))


def digits(value, count=3):
    """The number with so many digits, without an exponent where that reads well."""
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        rounded = float(f"{value:.{count}g}")
        return f"{rounded:.0f}" if abs(rounded) >= 10 ** (count - 1) else f"{value:#.{count}g}".rstrip(".")
    mantissa, exponent = f"{value:.{count - 1}e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"


def with_unit(value, unit):
    """51.2 M/s of 51.2e6 and "1/s"; values other than rates, times and memory keep their number."""
    if unit not in ("1/s", "s", "B"):
        return f"{digits(value)} {unit}".strip()
    factor, prefix = next(((f, p) for f, p in PREFIXES if abs(value) >= f), PREFIXES[-1])
    if unit == "s" and factor > 1:
        factor, prefix = 1, ""
    return f"{digits(value / factor)} {prefix}{unit.replace('1/s', '/s')}"


def cell(line, field):
    value = line.get(field)
    if field == "theirs" and value == 0 and "skipped" in line:  # no light was found, which does not mean a merit of zero
        return ""
    if value is None:
        return line["skipped"] if field == "ours" and "skipped" in line else ""
    if field == "goal":
        return " ".join(goal_of(line))
    if isinstance(value, bool):
        return "yes" if value else "**no**"
    counted = isinstance(value, int) and not field.endswith("memory") and f"{field}_unit" not in line
    if isinstance(value, str) or counted:
        return str(value)
    if field == "spread" or field.endswith("_spread"):
        return f"{100 * value:.0f} %"
    unit = "B" if field.endswith("memory") else line.get("unit", "") if field in ("ours", "theirs") else line.get(f"{field}_unit", "")
    return with_unit(value, unit)


def goal_of(line):
    goal = line["goal"]
    sign, value = ("≥", goal["at_least"]) if "at_least" in goal else ("≤", goal["at_most"])
    unit = "B" if goal["of"].endswith("memory") else line.get("unit", "") if goal["of"] in ("ours", "theirs") else ""
    return sign, with_unit(value, unit)


def rows(headings, body):
    return "\n".join(["| " + " | ".join(headings) + " |", "|" + " --- |" * len(headings),
                      *("| " + " | ".join(row) + " |" for row in body)])


def measured_on(lines):
    """The sentence below a table."""
    def each(key):
        return ", ".join(sorted({str(line[key]) for line in lines}))
    loads = [line["load"] for line in lines]
    return (f"Measured {each('date')[:10]} at {each('commit')} on {each('processor')}, {each('cores')} cores, load "
            f"{min(loads):.1f} to {max(loads):.1f}; {each('compiler')}, `{each('flags')}`.")


def table(words, results):
    found = TABLE.fullmatch(words)
    if not found:
        sys.exit(f"{PAGE}: '{words}' is not 'bench NAME [where FIELD=VALUE]: FIELD | FIELD ...'")
    bench, key, value, columns = found.groups()
    lines = newest([line for line in results.get(bench, []) if key is None or str(line.get(key)) == value])
    if not lines:
        return f"Not measured yet: `scripts/bench {bench} --keep`."
    fields = [(column.strip() + ",").split(",")[:2] for column in columns.split("|")]
    headings = [(heading.strip() or field.replace("_", " ")) for field, heading in fields]
    return rows(headings, [[cell(line, field) for field, _ in fields] for line in lines]) + "\n\n" + measured_on(lines)


def goals(results):
    """One row for each goal, with what each processor reached."""
    lines = [line for bench in sorted(results) for line in results[bench] if "goal" in line]
    processors = sorted({line["processor"] for line in lines})
    reached = {}
    for line in lines:
        reached.setdefault((line["goal"].get("name", line["case"]), line["bench"]), {})[line["processor"]] = line

    def cells_of(line):
        return [cell(line, line["goal"]["of"]), cell(line, "spread"), cell(line, "met")] if line else [""] * 3
    table_of_goals = rows(["goal", "bench", "wanted", *(heading for p in processors for heading in (p, "spread", "met"))],
                          [[*goal, cell(list(of.values())[-1], "goal"), *(c for p in processors for c in cells_of(of.get(p)))]
                           for goal, of in reached.items()])
    return "\n\n".join([table_of_goals, *(measured_on([line for line in lines if line["processor"] == p]) for p in processors)])


def results_of(folder):
    return {file.stem: [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
            for file in sorted(folder.glob("*.jsonl"))}


def written(text, results):
    """The page with the values of the lines."""
    def fill(place):
        kind, words = place.groups()
        body = goals(results) if kind == "goals" else table(words, results)
        return f"<!-- {' '.join(filter(None, place.groups()))} -->\n\n{body}\n\n<!-- end -->"
    return PLACE.sub(fill, text)


def problems(page, folder):
    """Differences between the page with its pictures and the lines."""
    text = page.read_text(encoding="utf-8")
    wanted = written(text, results_of(folder))
    yield from (line for line in difflib.unified_diff(text.split("\n"), wanted.split("\n"), page.name, "the lines", "", n=0))
    yield from pictures.outdated(page.parent, folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; say what differs and exit with 1")
    parser.add_argument("--results", type=pathlib.Path, default=KEPT, help="folder of the lines (bench/results)")
    parser.add_argument("--page", type=pathlib.Path, default=PAGE, help="the page; its pictures are in the same folder")
    words = parser.parse_args()
    if not words.check:
        words.page.write_text(written(words.page.read_text(encoding="utf-8"), results_of(words.results)), encoding="utf-8")
        pictures.draw(words.page.parent, words.results)
        return 0
    found = list(problems(words.page, words.results))
    print("\n".join(found + ["scripts/bench page writes it anew"]) if found else f"{words.page.name} is what the lines say")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
