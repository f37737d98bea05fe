#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`trace --backend mpi` under mpirun: the bits of one process, from any number of ranks; a rank that is killed ends the job, and
its checkpoint resumes to the same bits. Usage: test_mpi.py PROGRAM"""
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from cluster_support import BLOCK, PROGRAM, QUIET, SCENE, SOURCE, ask, attributes, bits, blocks, trace

MANY = str(100 * BLOCK)
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root"]


def mpi(ranks, out, *words, scene=SCENE, **more):
    return subprocess.Popen([*MPIRUN, "-n", str(ranks), str(PROGRAM), "trace", *scene, "-o", str(out), "--backend", "mpi",
                             "--threads", "1", *map(str, words)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            env=dict(QUIET, OMPI_MCA_btl_vader_single_copy_mechanism="none"), **more)


def children(pid, name):
    """Processes below this one whose program has this name."""
    listed = subprocess.run(["ps", "-e", "-o", "pid=,ppid=,comm="], text=True, capture_output=True, check=True).stdout
    rows = [line.split(None, 2) for line in listed.splitlines()]
    below = {pid}
    for _ in range(4):
        below |= {int(p) for p, parent, _ in rows if int(parent) in below}
    return sorted(int(p) for p, _, comm in rows if int(p) in below and comm.strip() == name)


def begun(test, out, histories):
    """A job of three ranks after its first checkpoint, and the processes of the ranks."""
    child = mpi(3, out, "--histories", histories, "--checkpoint", "0.3s")
    until = time.monotonic() + 60
    while not out.exists() or blocks(out) == 0:
        test.assertIsNone(child.poll())
        test.assertLess(time.monotonic(), until)
        time.sleep(0.05)
    ranks = children(child.pid, PROGRAM.name)
    test.assertEqual(len(ranks), 3, ranks)
    return child, ranks


class Mpi(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.place.name)

    def tearDown(self):
        self.place.cleanup()

    def test_the_program_does_not_need_it(self):
        linked = subprocess.run(["ldd", str(PROGRAM)], text=True, capture_output=True, check=True).stdout
        self.assertIn("libhdf5", linked)
        self.assertNotIn("libmpi", linked)
        self.assertNotIn("open-rte", linked)

    def test_any_number_of_ranks(self):
        one = self.folder / "one.h5"
        trace(one, "--histories", MANY)
        for ranks in (1, 2, 4):
            out = self.folder / f"{ranks}.h5"
            child = mpi(ranks, out, "--histories", MANY)
            said, complained = child.communicate(timeout=120)
            self.assertEqual(child.returncode, 0, complained)
            self.assertEqual(bits(out), bits(one), ranks)
            self.assertEqual(said.count("Where the light went"), 1)                     # rank 0 speaks
        trace(self.folder / "control.h5", "--histories", MANY, "--seed", 2)
        self.assertNotEqual(bits(self.folder / "control.h5"), bits(one))

    def test_ranks_start_in_the_field_of_rank_0(self):
        """Paths start and end in the field of a cavity, which rank 0 computes and sends."""
        field, one, two = [SOURCE / "tests/scenes/crossover_arm.yaml"], self.folder / "one.h5", self.folder / "two.h5"
        ask("trace", *field, "-o", one, "--quiet", "--histories", 20 * BLOCK)
        child = mpi(2, two, "--histories", 20 * BLOCK, scene=field)
        _, said = child.communicate(timeout=120)
        self.assertEqual(child.returncode, 0, said)
        self.assertEqual(bits(two), bits(one))

    def test_a_killed_rank(self):
        out, whole = self.folder / "killed.h5", self.folder / "whole.h5"
        child, ranks = begun(self, out, 10**9)
        os.kill(ranks[-1], signal.SIGKILL)
        _, said = child.communicate(timeout=60)
        self.assertNotEqual(child.returncode, 0)
        self.assertIn("signal 9", said)                                                 # mpirun names the rank
        self.assertEqual(int(attributes(out)["complete"]), 0)
        count = (max(blocks(out), 100) + 50) * BLOCK
        trace(out, "--histories", count)
        trace(whole, "--histories", count)
        # Blocks that other ranks had done further on are kept, and what is missing before them is done.
        if blocks(out) == blocks(whole):
            self.assertEqual(bits(out), bits(whole))
        else:
            trace(self.folder / "longer.h5", "--histories", blocks(out) * BLOCK)
            self.assertEqual(bits(out), bits(self.folder / "longer.h5"))

    def test_errors_are_said_once(self):
        child = mpi(3, self.folder / "no" / "folder.h5", "--histories", MANY)
        _, said = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 2)
        self.assertEqual(said.count("error: there is no folder"), 1, said)
        child = mpi(2, self.folder / "x.h5", "-p", "R_t=-1 m")
        _, said = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 2)
        self.assertEqual(said.count("Nothing was run"), 1, said)


if __name__ == "__main__":
    unittest.main()
