#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""No kernel takes more instructions than stored. Usage: test_instructions.py PROGRAM, the build's bench_instructions"""
import pathlib
import sys
import unittest

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "bench"))
import instructions  # noqa: E402


class Instructions(unittest.TestCase):
    def test_no_more_than_stored(self):
        before, made_before = instructions.stored()
        made = instructions.made_with(PROGRAM.parent)
        found, notes = instructions.grown(instructions.counts(PROGRAM), made, before, made_before)
        print(*notes, sep="\n")
        self.assertEqual(found, [])

    def test_the_same_work_done_twice_is_refused(self):
        """The negative control: also by the looser limit for other compilers, and of this kernel alone."""
        before, made_before = instructions.stored()
        doubled = instructions.counts(PROGRAM, twice="tube_walk")
        for made in (made_before, dict(made_before, compiler="another")):
            found, _ = instructions.grown(dict(before, tube_walk=doubled["tube_walk"]), made, before, made_before)
            self.assertEqual([line.split(":")[0] for line in found], ["tube_walk"])

    def test_limits(self):
        made, other = {"compiler": "a"}, {"compiler": "b"}
        for growth, same, elsewhere in ((0.02, 0, 0), (0.04, 1, 0), (0.16, 1, 1)):
            for used, wanted in ((made, same), (other, elsewhere)):
                found, notes = instructions.grown({"k": 1 + growth}, used, {"k": 1}, made)
                self.assertEqual(len(found), wanted)
                self.assertEqual(any("15 %" in note for note in notes), used is other)     # a note states this
        self.assertEqual(len(instructions.grown({"new": 1}, made, {"old": 1}, made)[0]), 2)


if __name__ == "__main__":
    unittest.main()
