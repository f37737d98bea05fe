#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The sliders of a report give the numbers of `straytrace noise --set` (docs/theory/decisions.md, eq. D.8 to D.11).

Usage: test_what_if.py PROGRAM. The script of the page runs in node on the data of the page."""
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
DATA = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)
HARNESS = """
const {w, settings} = JSON.parse(require('fs').readFileSync(0));
const state = new WhatIf(w);
console.log(JSON.stringify(settings.map(setting => {
  const curve = state.curve(setting);
  return {...curve, total: state.total(curve), rows: state.rows(setting), words: settingWords(w, setting)};
})));
"""


def straytrace(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


def strain_at(hz, frequency, asd):
    """Between the centres of bins, by logarithms, as the program does."""
    low = max(0, max(i for i, f in enumerate(frequency) if f <= hz))
    x = math.log(hz / frequency[low]) / math.log(frequency[low + 1] / frequency[low])
    return math.exp((1 - x) * math.log(asd[low]) + x * math.log(asd[low + 1]))


class Sliders(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        held = tempfile.TemporaryDirectory()
        cls.addClassCleanup(held.cleanup)
        folder = pathlib.Path(held.name)
        straytrace("run", SOURCE / "examples/virgo_arm.yaml", "-o", folder, "--histories", 32768, "--quiet")
        cls.run_file = folder / "run.h5"
        cls.page = json.loads(DATA.search((folder / "report.html").read_text(encoding="utf-8")).group(1))
        cls.w, cls.budget = cls.page["what_if"], cls.page["budget"]

    def answers(self, settings, w=None):
        base, script = (SOURCE / "data/page/base.js").read_text(), (SOURCE / "data/page/what_if.js").read_text()
        typed = re.search(r"function typedArray\(.*?\n}\n", base, re.DOTALL).group(0)
        asked = json.dumps({"w": w or self.w, "settings": settings})
        done = subprocess.run(["node", "-e", typed + script + HARNESS], input=asked, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def settings(self, count):
        """Factors of all materials, below their limits, and of one body."""
        draw, factors = random.Random(1), self.w["moved"][0]["factors"]
        for k in range(count):
            strengths = [float(f"{10 ** draw.uniform(-1, math.log10(min(m['most'], 5))):.3g}") for m in self.w["materials"]]
            yield {"strengths": strengths, "body": 0 if k % 2 else -1, "factor": draw.choice(factors) if k % 2 else 1}

    def ratios(self, answer):
        """h of the page over that of the program, at the frequencies of the summary."""
        asd = [h * math.sqrt(p) for h, p in zip(self.budget["total"]["asd"], answer["psd"])]
        words = [w.strip("'") for w in answer["words"].split(" ")]
        told = json.loads(straytrace("noise", self.run_file, *words, "--format", "json", "--quiet"))["total_strain"]
        return [strain_at(t["frequency_Hz"], self.budget["frequency"], asd) / t["value"] for t in told], told

    def test_numbers_of_the_program(self):
        traced = json.loads(straytrace("noise", self.run_file, "--format", "json", "--quiet"))["total_strain"]
        for setting, answer in zip(list(self.settings(6)), self.answers(list(self.settings(6)))):
            moved = setting["body"] >= 0
            ratios, told = self.ratios(answer)
            for k, ratio in enumerate(ratios):
                self.assertAlmostEqual(ratio, 1, delta=4e-3 if moved else 2e-4)    # of a factor with three digits
                said = math.sqrt(answer["total"][k]) * traced[k]["value"]     # at the frequency, as the sentence says
                self.assertAlmostEqual(said / told[k]["value"], 1, delta=4e-3 if moved else 2e-4)
                error = answer["error"][self.w["bins"][k]["bin"]]
                self.assertAlmostEqual(error * told[k]["value"] / told[k]["sigma"], 1, delta=0.35)
        wrong = json.loads(json.dumps(self.w))                                     # negative control
        for exponents in wrong["exponents"]:
            exponents[2] += 1
        ratios, _ = self.ratios(self.answers(list(self.settings(1)), wrong)[0])
        self.assertTrue(any(abs(ratio - 1) > 0.02 for ratio in ratios))

    def test_as_traced_and_dark(self):
        ones = {"strengths": [1] * len(self.w["materials"]), "body": -1, "factor": 1}
        names = [m["name"] for m in self.w["materials"]]
        dark = {**ones, "strengths": [0 if name in ("input_mass", "test_mass") else 1 for name in names]}
        traced, without = self.answers([ones, dark])
        self.assertEqual(traced["words"], "")
        for share in traced["psd"] + traced["total"]:
            self.assertAlmostEqual(share, 1, delta=1e-5)
        for error, sigma, asd in zip(traced["error"], self.budget["total"]["sigma"], self.budget["total"]["asd"]):
            self.assertAlmostEqual(error / (sigma / asd), 1, delta=1e-3)
        self.assertEqual(set(without["psd"]), {0})                                 # light enters by the mirrors alone
        self.assertIn("--set 'test_mass=black'", without["words"])

    def test_rows(self):
        half = [0.5 if m["name"] == "baffle" else 1 for m in self.w["materials"]]
        answer, = self.answers([{"strengths": half, "body": -1, "factor": 1}])
        once = next(k for k, row in enumerate(self.w["rows"]) if row["name"] == "ITM·S > baffles_in·S > ITM·S")
        twice = next(k for k, row in enumerate(self.w["rows"]) if row["name"] == "ITM·S > baffles_in·S > baffles_in·S > ITM·S")
        for k, factor in ((once, 0.5), (twice, 0.25)):
            for before, now in zip(answer["rows"][k]["before"], answer["rows"][k]["now"]):
                self.assertAlmostEqual(now / before, factor, delta=1e-9)
        shares = [row["shares"][-1] for row in self.w["rows"] if len(row["terms"]) == 1]
        self.assertLess(sum(shares), 1.0001)
        self.assertGreater(sum(shares), 0.9)


if __name__ == "__main__":
    unittest.main()
