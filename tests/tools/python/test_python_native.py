# SPDX-License-Identifier: BSD-3-Clause
"""The engine inside this process: the bits of the commands, no second process and no temporary file, progress, interruption,
errors, and a package that works without the library."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

from python_arm import HISTORIES, SOURCE, arm

import numpy as np

import straytrace
from straytrace import native

STORM = {"bodies": {"mirrors": {"motion": "still"}, "tube": {"motion": {"z": {"peterson": "low"}, "others": "still"}}}}


def no_files(*_, **__):
    raise AssertionError("a process or a temporary file")


class Native(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.held = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.held.cleanup)
        cls.folder = pathlib.Path(cls.held.name)
        cls.states = []
        with unittest.mock.patch("subprocess.Popen", no_files), unittest.mock.patch("tempfile.mkdtemp", no_files):
            cls.model = native.Model(arm())
            cls.light = cls.model.trace(histories=HISTORIES, progress=cls.states.append)
            cls.noise = cls.light.noise()
            cls.stormy = cls.light.noise(motion=STORM)
            cls.dark = cls.light.noise(set=["steel=x0.25"])
        cls.process = straytrace.run(arm(), cls.folder / "run.h5", histories=HISTORIES, progress=False)

    def test_the_bits_of_the_commands(self):
        wanted = self.process.noise
        for own, other in ((self.noise.asd, wanted.total.mean), (self.noise.sigma, wanted.total.sigma),
                           (self.noise.edges, wanted.edges), (self.noise.design["adv-lal"], wanted.design["adv-lal"]),
                           (self.stormy.asd, self.process.noise(motion=STORM).total.mean)):
            np.testing.assert_array_equal(own, other)
        self.assertTrue(np.isfinite(self.noise.asd).all())
        self.assertFalse(np.array_equal(self.stormy.asd, self.noise.asd))                 # negative control
        np.testing.assert_array_equal(self.noise.at([10, 30]), wanted.at([10, 30]))
        self.assertEqual((self.light.histories, self.light.seed, self.light.complete), (HISTORIES, 1, True))
        self.assertEqual(self.model.hash, self.process.attributes["model_hash"])

    def test_other_inputs(self):
        """As `straytrace noise --set`; the routes that meet the baffle once follow the root of its BRDF."""
        wanted = {h["frequency_Hz"]: h["value"] for h in self.process.with_inputs("steel=x0.25")["total_strain"]}
        np.testing.assert_allclose(self.dark.at(list(wanted)), list(wanted.values()), rtol=1e-12)
        np.testing.assert_allclose(self.dark.asd / self.noise.asd, 0.5, rtol=0.01)

    def test_paths(self):
        table, wanted = self.noise.paths([10, 100]), self.process.paths().table()
        self.assertEqual(table["strain"].shape, (len(table["rank"]), 2, 2))
        self.assertEqual(table["sequence"][0], wanted["sequence"].iloc[0])
        np.testing.assert_allclose(table["share"][:, 0][table["resolved"]], wanted["share"][:table["resolved"].sum()], rtol=1e-9)

    def test_saved_and_opened(self):
        self.light.save(self.folder / "native.h5")
        for again in (native.open_run(self.folder / "native.h5").noise().asd,
                      straytrace.open(self.folder / "native.h5").noise.total.mean):
            np.testing.assert_array_equal(again, self.noise.asd)

    def test_progress_ends_a_trace(self):
        self.assertTrue(self.states)
        self.assertEqual(self.states[-1].histories, HISTORIES)

        def interrupted(_):
            raise KeyboardInterrupt

        run = self.model.trace(histories=1e9, progress=lambda state: state.histories < HISTORIES)
        self.assertFalse(run.complete)
        self.assertGreater(run.noise().asd[0], 0)
        self.assertFalse(self.model.trace(histories=1e9, progress=interrupted).complete)

        def broken(_):
            raise ZeroDivisionError

        with self.assertRaises(ZeroDivisionError):
            self.model.trace(histories=1e9, progress=broken)

    def test_all_problems_at_once(self):
        wrong = arm(beams={"arm": {"cavity": ["ITM", "ETM"], "wavelength": "1 kg"}}, nonsense=1)
        with self.assertRaises(straytrace.InputError) as ours:
            native.Model(wrong)
        with self.assertRaises(straytrace.InputError) as theirs:
            wrong.check()
        self.assertEqual(str(ours.exception), str(theirs.exception))
        self.assertGreater(len(ours.exception.problems), 1)
        with self.assertRaisesRegex(straytrace.InputError, "'mirrors' has no motion"):
            self.light.noise(motion={"bodies": {"tube": {"motion": "still"}}})
        with self.assertRaisesRegex(straytrace.InputError, "nowhere.h5"):
            native.open_run("nowhere.h5")
        with self.assertRaisesRegex(straytrace.InputError, "straytrace noise --set|steal"):
            self.light.noise(set=["steal=x2"])

    def test_without_the_library(self):
        """Everything else works; the message names the remedy."""
        code = ("import straytrace; from straytrace import native; assert not native.available(); straytrace.engine.ask('--version')\n"
                "try: native.Model('x.yaml')\nexcept straytrace.InputError as error: print(error)")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                              env={**os.environ, "PYTHONPATH": str(SOURCE / "python"), "STRAYTRACE_LIBRARY": "/nowhere/lib.so"})
        self.assertIn("/nowhere/lib.so", done.stdout)
        self.assertIn("build it with scripts/build", done.stdout)


if __name__ == "__main__":
    unittest.main()
