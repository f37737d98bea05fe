#!/usr/bin/env python3
"""Records of the tests, as the cells "obtained" and "error" of docs/theory/validation.md; used by validation.py.

A record (build/validation/NAME.json, written by tests/support/recorded.cpp and tests/tools/compare/records.py) holds the comparisons of
one test that passed: kind, text in the source, count, the first numbers and those nearest to the limit.
"""
import json
import math
import pathlib
import re

PIECES = 10                                             # numbers of a row that are shown
LISTED = 10                                             # longer series are represented by their worst number
LABEL = 36                                              # letters of a label
STANDARD_ERRORS = 5                                     # what a Monte-Carlo mean may be off (tests/support/statistics.hpp)
NUMBER = r"(<1|−?\d+(?:\.\d+)?(?:e[-−]?\d+)?)"


class Cell:
    """Text, and for each number in it how far another machine may be off."""

    def __init__(self):
        self.parts = []                                 # text, or (text of a number, slack)

    @property
    def text(self):
        return "".join(part if isinstance(part, str) else part[0] for part in self.parts)

    def add(self, *parts):
        self.parts += parts
        return self

    def differs(self, stored):
        """Whether a cell of the page is not what was obtained."""
        pattern = "".join(re.escape(part) if isinstance(part, str) else NUMBER if re.fullmatch(NUMBER, part[0]) else re.escape(part[0])
                          for part in self.parts)
        found = re.fullmatch(pattern, stored)
        if not found:
            return True
        numbers = [part for part in self.parts if not isinstance(part, str) and re.fullmatch(NUMBER, part[0])]
        value = lambda text: float(text.replace("−", "-").replace("<1", "0"))
        return any(abs(value(was) - value(now)) > slack + 1e-9 * abs(value(now))
                   for was, (now, slack) in zip(found.groups(), numbers))


def number(value, quantum, slack):
    """(text, slack) of a value known to the quantum, with at most seven digits."""
    if value == 0 or not math.isfinite(value):
        return ("0" if value == 0 else str(value)), slack
    top = int(f"{abs(value):.6e}".partition("e")[2])
    last = math.floor(math.log10(quantum)) if quantum > 0 else top - 6
    digits = min(max(top - last, 0), 6)
    if -4 < top < 6:
        text = f"{abs(value):.{max(digits - top, 0)}f}"
        text = re.sub(r"\.0+$", "", text) if quantum == 0 else text
    else:
        mantissa, power = f"{abs(value):.{digits}e}".split("e")
        text = f"{mantissa}e{int(power)}"
    step = 10.0**(top - digits)
    return ("−" if value < 0 and float(text) else "") + text, slack + step


def rough(value):
    """Two digits: of numbers that are only small."""
    return number(value, abs(value) / 10, 0)[0]


def count_of(comparison):
    return f"{comparison['count']}", 0.2 * comparison["count"] if comparison["count"] > 50 else 0


def unscaled(c):
    """A ratio to a number of the source, "length / 8.5e-17" against 1, as that number."""
    found = re.fullmatch(r"(.*) / (\d[\d.]*(?:e-?\d+)?)", c["what"])
    if c["kind"] != "near" or c["against"] != "1" or not found or re.search(r" [-+] (?![^(]*\))", found.group(1)):
        return c
    scale = float(found.group(2))
    return dict(c, what=found.group(1), against=found.group(2), worst=[scale * v for v in c["worst"]],
                samples=[[scale * v for v in s] for s in c["samples"]])


def first_argument(text):
    """x of "deviation(x, y)", the whole of anything else."""
    found = re.fullmatch(r"deviation\((.*)\)", text)
    if not found:
        return text
    depth = 0
    for i, letter in enumerate(found.group(1)):
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            return found.group(1)[:i]
    return found.group(1)


def label_of(comparison):
    """Label of a number: the words of the test or the compared expression, shortened, as Markdown."""
    text = re.sub(r"\b(?:std|testing|ifo)::|\.get<[\w:]+>\(\)|\bstatic_cast<double>", "", first_argument(comparison["what"]))
    text = re.sub(r"\bfabs\b", "abs", " ".join(text.split()))
    if len(text) > LABEL:
        text = text[:LABEL - 1].rstrip(" ,(") + "…"
    return re.sub(r"([\\`*_$\[\]<>|~])", r"\\\1", text)


class Shown:
    """One comparison as the page shows it."""

    def __init__(self, comparison, upper=None):
        self.c, self.kind, self.upper = comparison, comparison["kind"], upper
        self.samples = [s for s in comparison["samples"] if None not in s]
        self.listed = comparison["count"] <= LISTED

    def pieces(self):
        """The numbers, each a list of parts for Cell.add."""
        if self.kind in ("near", "mean") and all(expected == 0 for _, expected, _ in self.samples):
            return [self.residual()]
        if self.kind == "below" or self.kind == "above":
            return [self.limited()]
        if not self.listed:
            return [self.series()]
        if len(self.samples) > 3 and len({expected for _, expected, _ in self.samples}) == 1:
            ends = [self.value(*s) for s in (min(self.samples), max(self.samples))]
            return [[*ends[0], " to ", *ends[1]]] if ends[0][0][0] != ends[1][0][0] else ends[:1]
        return [self.value(*s) for s in self.samples]

    def series(self):
        """A long one by its size and its worst number."""
        obtained, expected, allowed = self.c["worst"]
        gap = abs(obtained - expected)
        if self.kind == "equal":
            return [count_of(self.c), " numbers"]
        return [count_of(self.c), " numbers off by at most ", (rough(gap), allowed / 2)]

    def value(self, obtained, expected, allowed):
        if self.kind == "mean":
            return [number(obtained, allowed / 3, allowed / 2), " ± ", (rough(allowed), allowed / 4)]
        return [number(obtained, allowed / 10, max(allowed / 2, 1e-9 * abs(expected)))]

    def residual(self):
        obtained, _, allowed = self.c["worst"]
        return ["off by " if self.kind == "near" else "0 ± ", (rough(abs(obtained) if self.kind == "near" else allowed), allowed)]

    def limited(self):
        obtained, limit, _ = self.c["worst"]
        if self.upper is not None:
            slack = abs(self.upper - limit) / 2
            return [number(obtained, slack / 5, slack), " in ", (f"{limit:g}", 0), " to ", (f"{self.upper:g}", 0)]
        sign = " < " if self.kind == "below" else " > "
        return [(rough(obtained), abs(limit) / 2 if self.kind == "below" else math.inf), sign, (rough(limit), abs(limit))]

    def error(self):
        """Largest error as a share of what is allowed; None where there is only a lower bound."""
        if self.kind == "above":
            return None
        if self.kind == "equal":
            return 0
        return max(self.c["used"] or 0, 0) / (STANDARD_ERRORS if self.kind == "mean" else 1)


class Records:
    def __init__(self, build, source):
        self.folder, self.source = pathlib.Path(build) / "validation", pathlib.Path(source)
        self.lines = {}

    def read(self, test):
        """Comparisons of a test, those of all types of a typed one, or None where it has not run."""
        suite, _, name = test.partition(".")
        files = [self.folder / f"{test}.json", *sorted(self.folder.glob(f"{suite}-*.{name}.json"))]
        found = [json.loads(f.read_text(encoding="utf-8"))["comparisons"] for f in files if f.exists()]
        return merged([unscaled(c) for comparisons in found for c in comparisons]) if found else None

    def is_control(self, comparison):
        """Whether the source calls it a control, in its statement or in the comment right above."""
        file, _, line = comparison["at"].rpartition(":")
        if file not in self.lines:
            self.lines[file] = (self.source / file).read_text(encoding="utf-8").split("\n")
        lines, at = self.lines[file], int(line) - 1
        reach = 1 if file.endswith(".py") else 6            # lines of a statement
        end = next((i for i in range(at, min(at + reach, len(lines))) if ";" in lines[i]), at)
        above = lines[at - 1] if at and at <= len(lines) and lines[at - 1].lstrip().startswith("//") else ""
        return "control" in " ".join([above, *lines[at:end + 1]]).lower()

    def shown(self, test):
        """Comparisons of a test that the page shows: equalities, or else bounds; controls never."""
        comparisons = self.read(test)
        if comparisons is None:
            return None
        kept = [c for c in comparisons if not self.is_control(c)]
        upper = {c["what"]: c["worst"][1] for c in kept if c["kind"] == "below"}
        paired = {c["what"] for c in kept if c["kind"] == "above"} & set(upper)
        pairs = [Shown(c, upper[c["what"]]) for c in kept if c["kind"] == "above" and c["what"] in paired]
        single = [Shown(c) for c in kept if c["what"] not in paired or c["kind"] not in ("above", "below")]
        strong = [s for s in single if s.kind in ("near", "mean")] + pairs + [s for s in single if s.kind == "below"]
        return strong or [s for s in single if s.kind == "equal"] or [s for s in single if s.kind == "above"]


def merged(comparisons):
    """Comparisons at one place of the source, of several types, as one."""
    together = {}
    for c in comparisons:
        key = c["at"], c["what"]
        if key not in together:
            together[key] = dict(c)
            continue
        t = together[key]
        worst = c if (c["used"] or 0) > (t["used"] or 0) else t
        t.update(count=t["count"] + c["count"], samples=t["samples"] + c["samples"], used=worst["used"], worst=worst["worst"])
    return list(together.values())


def cells(records, tests):
    """Cells "obtained" and "error" of a row; None where a test has no record."""
    obtained, error = Cell(), Cell()
    budget = max(3, PIECES // max(len(tests), 1))
    for i, test in enumerate(tests):
        shown = records.shown(test)
        if shown is None:
            return None
        if i:
            obtained.add("; ")
            error.add("; ")
        add_obtained(obtained, shown, budget)
        add_error(error, shown)
    return obtained, error


def add_obtained(cell, shown, budget):
    pieces = []
    for label, piece in ((label_of(s.c), piece) for s in shown for piece in s.pieces()):
        if (label, piece) not in pieces:
            pieces.append((label, piece))
    before = None
    for i, (label, piece) in enumerate(pieces[:budget]):
        cell.add("" if i == 0 else ", " if label == before else " · ", *([] if label == before else [f"{label}: "]), *piece)
        before = label
    if len(pieces) > budget:
        cell.add(" …")
    if not pieces:
        cell.add("as stated")


def add_error(cell, shown):
    """The largest error, in per cent of what is allowed."""
    errors = [100 * e for e in (s.error() for s in shown) if e is not None]
    if not errors:
        cell.add("–")
        return
    largest = max(errors)
    cell.add((f"{largest:.0f}" if largest >= 1 or not largest else "<1", 60), " %")
