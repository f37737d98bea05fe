#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Ranks that fall silent under mpirun. Takes three minutes, most of them waiting. Usage: nightly_mpi.py PROGRAM"""
import os
import pathlib
import signal
import tempfile
import time
import unittest

from cluster_support import BLOCK, PROGRAM, attributes, bits, blocks, trace
from test_mpi import children, mpi


class Silent(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def begun(self, out, histories):
        """A job of three ranks after its first checkpoint, the last rank stopped."""
        child = mpi(3, out, "--histories", histories, "--checkpoint", "0.3s")
        until = time.monotonic() + 60
        while not out.exists() or blocks(out) == 0:
            self.assertIsNone(child.poll())
            self.assertLess(time.monotonic(), until)
            time.sleep(0.05)
        ranks = children(child.pid, PROGRAM.name)
        self.assertEqual(len(ranks), 3, ranks)
        os.kill(ranks[-1], signal.SIGSTOP)
        return child, ranks

    def test_others_do_its_blocks(self):
        out, one = self.folder / "job.h5", self.folder / "one.h5"
        child, _ = self.begun(out, 1000 * BLOCK)
        said, complained = child.communicate(timeout=200)
        self.assertEqual(child.returncode, 0, complained)
        self.assertIn("does not answer", complained)
        self.assertIn("Where the light went", said)
        trace(one, "--histories", 1000 * BLOCK)
        self.assertEqual(bits(out), bits(one))

    def test_a_job_asked_to_stop_ends_with_85(self):
        out = self.folder / "job.h5"
        child, ranks = self.begun(out, 10**10)
        os.kill(ranks[0], signal.SIGTERM)
        said, complained = child.communicate(timeout=200)
        self.assertEqual(child.returncode, 85, complained)
        self.assertIn("Where the light went", said)
        self.assertEqual(int(attributes(out)["complete"]), 0)


if __name__ == "__main__":
    unittest.main()
