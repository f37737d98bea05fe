#!/usr/bin/env python3
"""Compare docs/theory/validation.md with what its tests obtained in this build.

Every row must have its numbers, and the page must hold what was obtained: within half a tolerance, half a standard
error. --write puts the numbers of this build into the page; --show prints what tests or cases compared.

Examples:
  python3 tools/validation.py build            after ctest has run the tests: is the page up to date?
  python3 tools/validation.py build --show A11  expected, obtained and error of case A11
"""
import argparse
import os
import pathlib
import re
import sys

from validation_cells import Records, cells

SOURCE = pathlib.Path(__file__).resolve().parents[1]
PAGE = SOURCE / "docs/theory/validation.md"
BAR = re.compile(r"(?<!\\)\|")
TEST = re.compile(r"`([A-Za-z_]\w*\.(?:[A-Za-z]\w*|\*))`")
DEFINED = re.compile(r"^(?:TYPED_)?TEST(?:_[FP])?\((\w+),\s*(\w+)\)", re.MULTILINE)


class Row:
    """A line of a table that names tests."""

    def __init__(self, line, columns):
        self.columns = columns
        self.cells = [cell.strip() for cell in BAR.split(line)[1:-1]]
        self.tests = TEST.findall(self["test"]) if len(self.cells) == len(columns) else []

    def __getitem__(self, column):
        return self.cells[self.columns.index(column)]

    def __setitem__(self, column, text):
        self.cells[self.columns.index(column)] = text

    def line(self):
        return "| " + " | ".join(self.cells) + " |"


def rows_of(text):
    """(line number, row) of every table with a column "test"."""
    columns = None
    for number, line in enumerate(text.split("\n"), 1):
        if not line.startswith("|"):
            columns = None
        elif columns is None:
            columns = [cell.strip() for cell in BAR.split(line)[1:-1]]
        elif "test" in columns and not line.startswith("| ---"):
            yield number, Row(line, columns)


def defined_tests():
    for source in sorted((SOURCE / "tests").rglob("*.cpp")):
        yield from (f"{suite}.{name}" for suite, name in DEFINED.findall(source.read_text(encoding="utf-8")))


def expanded(tests, known):
    """Grooves.* as the tests of that suite."""
    for test in tests:
        if not test.endswith(".*"):
            yield test
            continue
        yield from (name for name in known if name.startswith(test[:-1]))


def compare(text, records, write):
    """Problems of the page, and the page with the numbers of this build."""
    lines, problems, known = text.split("\n"), [], list(defined_tests())
    for number, row in rows_of(text):
        where = f"{PAGE.relative_to(SOURCE)}:{number}: "
        if len(row.cells) != len(row.columns) or not row.tests:
            problems.append(where + "a row of this table has " + (
                "no test" if len(row.cells) == len(row.columns) else f"{len(row.columns)} cells, not {len(row.cells)}; write | as \\|"))
            continue
        tests = list(expanded(row.tests, known))
        found = cells(records, tests)
        if found is None:
            missing = [test for test in tests if records.read(test) is None]
            problems.append(where + f"no numbers of {', '.join(missing)}: run ctest --test-dir build -R tools.validation")
            continue
        for column, cell in zip(("obtained", "error"), found):
            if cell.differs(row[column]):
                if not write:
                    problems.append(where + f"{row['case']}: {column} is '{cell.text}', the page says '{row[column]}'")
                row[column] = cell.text
        lines[number - 1] = row.line()
    return problems, "\n".join(lines)


def named(words, text):
    """Tests of the page for names of tests, of suites or of cases."""
    known, found = list(defined_tests()), []
    for word in words:
        tests = [t for _, row in rows_of(text) for t in expanded(row.tests, known)
                 if word in re.split(r"[ ,]+", row["case"]) or re.fullmatch(word.replace("*", ".*"), t)]
        tests = tests or [t for t in known if re.fullmatch(word.replace("*", ".*"), t)]
        if not tests:
            raise SystemExit(f"validation: no case and no test '{word}'; {PAGE.relative_to(SOURCE)} lists them")
        found += [t for t in tests if t not in found]
    return found


def shown(test, comparisons):
    yield test
    if comparisons is None:
        yield "  no numbers: it has not run, or failed"
        return
    header = ("compared", "expected", "obtained", "error", "allowed", "of")
    rows = [header]
    for c in comparisons:
        for obtained, expected, allowed in ([c["worst"]] if c["count"] > 10 else c["samples"]):
            if None in (obtained, expected):
                continue
            sign = {"below": "< ", "above": "> "}.get(c["kind"], "")
            error = "" if sign else f"{obtained - expected:.2g}"
            limit = {"near": f"{allowed:.2g}", "mean": f"σ {allowed:.2g}"}.get(c["kind"], "")
            rows.append((c["what"][:70], f"{sign}{expected:.8g}", f"{obtained:.8g}", error, limit, str(c["count"])))
    widths = [max(len(row[i]) for row in rows) for i in range(len(header))]
    for row in rows:
        yield "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="build folder")
    parser.add_argument("--write", action="store_true", help="put the numbers of this build into the page")
    parser.add_argument("--show", nargs="+", metavar="NAME", help="tests, suites or cases to print")
    parser.add_argument("--names", nargs="+", metavar="NAME", help="only their tests, as a pattern for ctest -R")
    asked = parser.parse_args()
    records, text = Records(asked.build, SOURCE), PAGE.read_text(encoding="utf-8")
    if asked.names:
        print("^(" + "|".join(re.escape(test) for test in named(asked.names, text)) + ")")
        return 0
    if asked.show:
        print("\n".join(line for test in named(asked.show, text) for line in shown(test, records.read(test))))
        return 0
    problems, new = compare(text, records, asked.write)
    if asked.write and new != text:
        half = PAGE.with_suffix(".part")
        half.write_text(new, encoding="utf-8")
        os.replace(half, PAGE)
    print("\n".join(problems) or f"{sum(1 for _ in rows_of(text))} cases are as the page says")
    if problems and not asked.write:
        print(f"if these numbers are right: python3 tools/validation.py {asked.build} --write")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
