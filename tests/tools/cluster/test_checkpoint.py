#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs that are killed, receive a signal or fill the disk: the file on the disk is a run that resumes to the same bits.
Usage: test_checkpoint.py PROGRAM"""
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from cluster_support import BLOCK, PROGRAM, QUIET, SCENE, attributes, bits, blocks, start, trace

LONG = str(10**9)


class Checkpoints(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.out = pathlib.Path(self.place.name) / "run.h5"

    def tearDown(self):
        self.place.cleanup()

    def begin(self, *words):
        return start("trace", *SCENE, "-o", self.out, "--histories", LONG, *words)

    def wait_for(self, there, child, seconds=60):
        until = time.monotonic() + seconds
        while not there():
            self.assertIsNone(child.poll(), "it ended early")
            self.assertLess(time.monotonic(), until, "too long")
            time.sleep(0.01)

    def goes_on_to_the_same_bits(self):
        count = (blocks(self.out) + 7) * BLOCK
        whole = self.out.with_name("whole.h5")
        trace(self.out, "--histories", count)
        trace(whole, "--histories", count)
        self.assertEqual(bits(self.out), bits(whole))
        self.assertEqual(int(attributes(self.out)["complete"]), 1)

    def test_asked_to_stop_while_it_reads(self):
        scene = self.out.with_name("long.yaml")
        scene.write_text(pathlib.Path(SCENE[0]).read_text() + "# a line\n" * 1200000)
        words = [str(scene), *SCENE[1:]]
        begun = time.monotonic()
        subprocess.run([str(PROGRAM), "check", *words], env=QUIET, check=True, capture_output=True)
        reading = time.monotonic() - begun
        child = start("trace", *words, "-o", self.out, "--histories", LONG)
        time.sleep(reading / 2)
        child.send_signal(signal.SIGUSR1)
        child.communicate()
        self.assertEqual(child.returncode, 85)
        self.assertEqual(int(attributes(self.out)["complete"]), 0)

    def test_killed_at_any_moment(self):
        stamp = None
        for more in (0, 0.13, 0.31):                             # seconds after a checkpoint: the next may be half written
            child = self.begin("--checkpoint", "0.1s")
            before = stamp
            self.wait_for(lambda: self.out.exists() and self.out.stat().st_ino != before, child)
            time.sleep(more)
            child.kill()
            child.communicate()
            stamp = self.out.stat().st_ino
            about = attributes(self.out)
            self.assertEqual(about["stopped_by"].decode() if isinstance(about["stopped_by"], bytes) else about["stopped_by"],
                             "checkpoint")
            self.assertEqual(int(about["complete"]), 0)
        self.goes_on_to_the_same_bits()
        for left in self.out.parent.glob("*.part-*"):            # of a file that was being written
            left.unlink()

    def test_without_checkpoints_a_kill_leaves_nothing(self):    # negative control
        child = self.begin("--checkpoint", "off")
        time.sleep(2)
        self.assertIsNone(child.poll())
        child.kill()
        child.communicate()
        self.assertFalse(self.out.exists())

    def test_signals_of_batch_systems(self):
        for number in (signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2):
            child = self.begin("--checkpoint", "0.1s")
            before = self.out.stat().st_mtime_ns if self.out.exists() else 0
            self.wait_for(lambda: self.out.exists() and self.out.stat().st_mtime_ns != before, child)
            child.send_signal(number)
            if number == signal.SIGUSR1:
                child.send_signal(number)                        # may come twice
            _, said = child.communicate(timeout=60)
            self.assertEqual(child.returncode, 85, f"{number}: {said}")
            self.assertIn("the same command resumes from here", said)
        self.goes_on_to_the_same_bits()

    def test_full_disk(self):
        trace(self.out, "--histories", 5 * BLOCK)
        before = self.out.read_bytes()
        words = ["trace", *SCENE, "-o", str(self.out), "--histories", LONG, "--checkpoint", "0.1s", "--max-time", "2.5s"]
        child = subprocess.run(["bash", "-c", 'trap "" XFSZ; ulimit -f 100; exec "$@"', "bash", str(PROGRAM), *words], text=True,
                               capture_output=True, env=QUIET)
        self.assertGreaterEqual(child.stderr.count("no checkpoint was written: cannot write"), 2, child.stderr)   # it continued
        self.assertIn("File too large", child.stderr)
        self.assertEqual(child.returncode, 2)                    # the end could not be written either
        self.assertEqual(self.out.read_bytes(), before)
        self.assertEqual(os.listdir(self.out.parent), ["run.h5"])
        self.goes_on_to_the_same_bits()


if __name__ == "__main__":
    unittest.main()
