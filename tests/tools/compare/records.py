# SPDX-License-Identifier: BSD-3-Clause
"""Comparisons of a test in Python, for docs/theory/validation.md; tests/support/recorded.cpp does this for the others."""
import json
import os
import pathlib
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[3]
SAMPLES = 16


class Records:
    """Comparisons of the test `name`, written by write() into the build folder of the program under test."""

    def __init__(self, name, program):
        self.path = pathlib.Path(program).resolve().parent / "validation" / f"{name}.json"
        self.path.unlink(missing_ok=True)                   # a test that fails leaves no result
        self.name, self.places, self.curves = name, {}, []

    def near(self, what, obtained, expected, tolerance):
        """Whether the two agree; kept if they do."""
        gap = abs(obtained - expected)
        return gap <= tolerance and self._keep("near", what, obtained, expected, tolerance, gap / tolerance)

    def below(self, what, obtained, limit):
        return obtained < limit and self._keep("below", what, obtained, limit, 0, obtained / limit)

    def curve(self, what, x, obtained, expected):
        """Two curves over one axis, for pictures; what they must agree to is a matter of near() and below()."""
        self.curves.append({"what": what, "x": list(map(float, x)), "obtained": list(map(float, obtained)),
                            "expected": list(map(float, expected))})

    def _keep(self, kind, what, obtained, expected, allowed, used):
        caller = sys._getframe(2)
        at = f"{pathlib.Path(caller.f_code.co_filename).resolve().relative_to(SOURCE)}:{caller.f_lineno}"
        sample = [float(obtained), float(expected), float(allowed)]
        place = self.places.setdefault((at, what), {"kind": kind, "at": at, "what": what, "against": "", "count": 0,
                                                    "samples": [], "worst": sample, "used": -1.0})
        place["count"] += 1
        if len(place["samples"]) < SAMPLES:
            place["samples"].append(sample)
        if used > place["used"]:
            place.update(used=float(used), worst=sample)
        return True

    def write(self):
        self.path.parent.mkdir(exist_ok=True)
        half = self.path.with_suffix(".part")
        half.write_text(json.dumps({"test": self.name, "comparisons": list(self.places.values()), "curves": self.curves}, indent=1) + "\n")
        os.replace(half, self.path)
