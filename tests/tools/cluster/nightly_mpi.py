#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Ranks that fall silent under mpirun. Takes three minutes, most of them waiting. Usage: nightly_mpi.py PROGRAM"""
import os
import pathlib
import signal
import tempfile
import unittest

from cluster_support import BLOCK, attributes, bits, trace
from test_mpi import begun


class Silent(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def silenced(self, out, histories):
        child, ranks = begun(self, out, histories)
        os.kill(ranks[-1], signal.SIGSTOP)
        return child, ranks

    def test_others_do_its_blocks(self):
        out, one = self.folder / "job.h5", self.folder / "one.h5"
        child, _ = self.silenced(out, 1000 * BLOCK)
        said, complained = child.communicate(timeout=200)
        self.assertEqual(child.returncode, 0, complained)
        self.assertIn("does not answer", complained)
        self.assertIn("Where the light went", said)
        trace(one, "--histories", 1000 * BLOCK)
        self.assertEqual(bits(out), bits(one))

    def test_a_job_asked_to_stop_ends_with_85(self):
        out = self.folder / "job.h5"
        child, ranks = self.silenced(out, 10**10)
        os.kill(ranks[0], signal.SIGTERM)
        said, complained = child.communicate(timeout=200)
        self.assertEqual(child.returncode, 85, complained)
        self.assertIn("Where the light went", said)
        self.assertEqual(int(attributes(out)["complete"]), 0)


if __name__ == "__main__":
    unittest.main()
