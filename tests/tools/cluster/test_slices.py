#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Slices of a run, merged: the same bits as one run; parts that do not fit are errors that name them; gaps are listed, accepted and
filled; numbers of histories beyond 2^32; memory that does not grow. Usage: test_slices.py PROGRAM"""
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from cluster_support import BLOCK, PROGRAM, QUIET, SCENE, ask, attributes, bits, blocks, trace

MANY = str(10 * BLOCK)  # 80 blocks of 512


class Slices(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.place.name)
        cls.one = cls.folder / "one.h5"
        trace(cls.one, "--histories", MANY)
        cls.parts = [cls.folder / f"part{n:02}.h5" for n in range(1, 13)]                # more of them than blocks
        for n, part in enumerate(cls.parts, 1):
            trace(part, "--histories", MANY, "--slice", f"{n}/12", "--threads", 1 + n % 2)

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def merge(self, parts, *words, code=0, name="run.h5"):
        return ask("merge", *parts, "-o", self.folder / name, *words, code=code)

    def test_all_parts_are_one_run(self):
        self.merge(reversed(self.parts), name="all.h5")
        self.assertEqual(bits(self.folder / "all.h5"), bits(self.one))
        self.assertIn("identical to the last bit", ask("diff", self.one, self.folder / "all.h5"))
        trace(self.folder / "seed2.h5", "--histories", MANY, "--seed", 2)                # negative control
        self.assertNotEqual(bits(self.folder / "seed2.h5"), bits(self.one))
        noise = [ask("noise", run, "-o", self.folder / "noise.h5", "--quiet", "--force") for run in (self.one, self.folder / "all.h5")]
        self.assertEqual(*noise)

    def test_what_a_part_says_of_itself(self):
        about = attributes(self.parts[6])
        self.assertEqual(list(about["slice"]), [7, 12])
        self.assertEqual(int(about["all_blocks"]), 80)
        self.assertEqual([blocks(p) for p in self.parts], [int(80 * n / 12) - int(80 * (n - 1) / 12) for n in range(1, 13)])
        ask("paths", self.parts[6])                                                     # a run like any other

    def test_gaps_are_listed_taken_and_filled(self):
        some = [p for n, p in enumerate(self.parts, 1) if n not in (4, 5, 9)]
        said = self.merge(some, code=2, name="gaps.h5")
        self.assertFalse((self.folder / "gaps.h5").exists())
        for words in ("20 of 80 blocks of histories are missing", "blocks 20 to 32", "slices 4 to 5, 9 of 12", "--partial"):
            self.assertIn(words, said)
        commands = [line.strip() for line in said.splitlines() if line.strip().startswith("straytrace trace")]
        self.assertEqual(len(commands), 3)
        self.merge(some, "--partial", name="gaps.h5")
        self.assertEqual(blocks(self.folder / "gaps.h5"), 60)
        self.assertEqual(int(attributes(self.folder / "gaps.h5")["complete"]), 0)
        ask("noise", self.folder / "gaps.h5", "-o", self.folder / "noise2.h5")           # a valid, smaller run
        ask("trace", self.folder / "gaps.h5", "--quiet")                                # resumes in place
        self.assertEqual(bits(self.folder / "gaps.h5"), bits(self.one))
        away = self.folder / "away"                                                     # the printed commands work
        away.mkdir()
        for command in commands:
            words = shlex.split(command.replace(str(self.folder) + "/part04", str(away) + "/part04")
                                .replace(f"-o {self.folder}", f"-o {away}"))
            ask(*words[1:], "--quiet")
        self.merge([*some, *sorted(away.glob("part*.h5"))], name="filled.h5")
        self.assertEqual(bits(self.folder / "filled.h5"), bits(self.one))

    def test_what_does_not_fit_is_refused(self):
        twice = self.folder / "twice.h5"
        shutil.copy(self.parts[7], twice)
        said = self.merge([*self.parts, twice], code=2, name="no.h5")
        self.assertIn("both contain blocks 46 to 52", said)
        self.assertIn("part08.h5", said)
        self.assertIn("twice.h5", said)
        other = self.folder / "other.h5"
        trace(other, "--histories", MANY, "--slice", "1/12", "--seed", "3")
        self.assertIn("seed 3", self.merge([*self.parts[2:], other], code=2, name="no.h5"))
        ask("trace", *SCENE, "-p", "R_t=0.51 m", "-o", other, "--histories", MANY, "--slice", "1/12", "--force")
        self.assertIn("another model", self.merge([other, *self.parts[2:]], code=2, name="no.h5"))
        damaged = bytearray(self.parts[6].read_bytes())
        damaged[len(damaged) // 2] ^= 1
        twice.write_bytes(damaged)
        self.assertIn("damaged", self.merge([*self.parts[:6], twice], code=2, name="no.h5"))
        self.assertFalse((self.folder / "no.h5").exists())

    def test_a_longer_run_is_not_replaced(self):
        longer = self.folder / "longer.h5"
        trace(longer, "--histories", 14 * BLOCK)
        before = longer.read_bytes()
        self.assertIn("contains 32 blocks of histories that are in no part", self.merge(self.parts, code=2, name="longer.h5"))
        self.assertEqual(longer.read_bytes(), before)
        self.merge(self.parts, "--force", name="longer.h5")
        self.assertEqual(bits(longer), bits(self.one))
        self.merge(self.parts, name="longer.h5")                                        # as much as is there

    def test_what_cannot_be_sliced(self):
        out = self.folder / "cannot.h5"
        said = trace(out, "--slice", "1/3", "--until", "h_total < 5 %", code=2)
        self.assertIn("needs the histories of all slices together", said)
        self.assertIn("--histories", said)
        for wrong in ("0/3", "4/3", "1", "a/b", "-1/3"):
            self.assertIn("7/200", trace(out, f"--slice={wrong}", code=2))
        self.assertIn("contains slice 1/12", trace(self.parts[0], "--slice", "2/12", "--histories", MANY, code=2))
        self.assertIn("contains slice 1/12", trace(self.parts[0], "--slice", "1/12", "--histories", 20 * BLOCK, code=2))
        self.assertIn("straytrace merge", ask("run", self.parts[0], "-o", self.folder / "r.h5", code=2))
        self.assertFalse(out.exists())

    def test_a_slice_that_was_stopped_goes_on(self):
        part, whole = self.folder / "stopped.h5", self.folder / "whole.h5"
        words = ("--histories", 900 * BLOCK, "--slice", "2/3")
        trace(part, *words, "--max-time", "0.05s", code=85)
        self.assertLess(blocks(part), 300)
        ask("trace", part, "--quiet")
        trace(whole, *words)
        self.assertEqual(bits(part), bits(whole))

    def test_the_end_of_a_trillion_histories(self):
        """Numbers of histories beyond 2^32: sums and replays of the last block of 1e12 histories."""
        out = self.folder / "end.h5"
        slices = 244140625                                                              # one block each
        said = trace(out, "--histories", "1e12", "--slice", f"{slices}/{slices}", code=2)
        self.assertIn("7/200", said)                                                    # at most 9999999
        trace(out, "--histories", "1e12", "--slice", "9999999/9999999")
        about = attributes(out)
        self.assertEqual(int(about["all_blocks"]), slices)
        import h5py
        with h5py.File(out) as run:
            kept = run["records/history"][:]
            self.assertGreater(len(kept), 100)                                          # each was replayed to its bits
            self.assertTrue(np.all((kept >= 10**12 - 30 * BLOCK) & (kept < 10**12)))
            self.assertGreater(int(run["nodes/first_block"][0]), 2**27)
        number = int(kept[0])
        told = ask("trace", out, "--history", number)
        self.assertIn(f"history {number}", told)
        events = json.loads(ask("trace", out, "--history", number, "--format", "json"))
        self.assertNotEqual(events, json.loads(ask("trace", out, "--history", number % 2**32, "--format", "json")))

    def test_memory_grows_with_routes_not_with_histories(self):
        def peak(count):
            words = ["/usr/bin/python3", "-c", "import os, resource, sys\n"
                     "child = os.spawnvp(os.P_WAIT, sys.argv[1], sys.argv[1:])\n"
                     "print(child, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)",
                     str(PROGRAM), "trace", *SCENE, "-o", str(self.folder / "memory.h5"), "--quiet", "--force", "--threads", "1",
                     "--seed", str(count), "--histories", str(count)]
            done = subprocess.run(words, text=True, capture_output=True, env=QUIET, check=True)
            code, kib = done.stdout.split()[-2:]
            self.assertEqual(code, "0", done.stderr)
            return int(kib) * 1024
        few, many = 32 * BLOCK, 512 * BLOCK
        grown = peak(many) - peak(few)
        self.assertLess(grown, 8e6)                                                     # 1.97e6 histories more
        self.assertGreater((many - few) * 8, 8e6)                                       # one double each would be seen


if __name__ == "__main__":
    os.chdir(tempfile.gettempdir())
    unittest.main()
