#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rules of the comparison, files of the problems, and their readers. Usage: test_bench_peers.py STRAYTRACE"""
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(SOURCE / "bench"), str(SOURCE / "bench/peers")]
import agreement  # noqa: E402
import batches  # noqa: E402
import estimators  # noqa: E402
import peers  # noqa: E402
import problems  # noqa: E402
import real  # noqa: E402
import run_mitsuba  # noqa: E402
import run_povray  # noqa: E402
import straytrace_scene  # noqa: E402
from agreement import Turn  # noqa: E402


def turns(value, error, seconds=2.0):
    return [Turn(value, error, seconds, 0.5, 1000, 3000, 1 << 20)] * 2


class Agreement(unittest.TestCase):
    def test_equal_values_are_compared(self):
        line = peers.line_of(turns(1.0, 0.01), turns(1.02, 0.02))
        self.assertNotIn("skipped", line)
        self.assertAlmostEqual(line["ours"], 1 / (0.01 ** 2 * 2))
        self.assertAlmostEqual(line["ratio"], (0.02 / 1.02) ** 2 / 0.01 ** 2)

    def test_a_value_five_errors_off_makes_it_void(self):
        """The negative control: the same line with a value off by five standard errors of the difference."""
        ours, error = turns(1.0, 0.01), 0.02
        off = 5 * math.hypot(0.01, error) / math.sqrt(2)
        line = peers.line_of(ours, turns(1 + off, error))
        self.assertIn("void: values are 5.0 standard errors apart", line["skipped"])
        self.assertNotIn("ratio", line)
        self.assertNotIn("ours", line)

    def test_nothing_found_and_noise_are_not_compared(self):
        self.assertEqual(agreement.why_void(turns(1.0, 0.01), turns(0.0, 0.0)), "theirs found nothing")
        self.assertIn("not resolved", agreement.why_void(turns(1.0, 0.9), turns(1.0, 0.01)))

    def test_estimators_by_the_same_rule(self):
        def lines(value):
            for way, mean in (("law + connections", value), ("default: all", 1.0)):
                for turn in (1, 2):
                    yield {"scene": "s", "quantity": "photodiode behind a ring", "way": way, "turn": turn, "value": mean, "error": 0.01,
                           "seconds": 1, "setup": 0, "paths": 10, "rays": 20}, 1000
        found = estimators.read((line, memory) for line, memory in lines(1.0))
        default, law = (found[("s", "photodiode behind a ring")][way] for way in ("default: all", "law + connections"))
        self.assertAlmostEqual(estimators.fields_of(default, law)["ratio"], 1)
        law = estimators.read(lines(1.0 + 5 * 0.01))[("s", "photodiode behind a ring")]["law + connections"]
        self.assertIn("void", estimators.fields_of(default, law)["skipped"])

    def test_rare_scores_count(self):
        """Two of three turns miss the rare score; by the median (1/(0.01^2 2 s)) theirs would win, together it loses."""
        ours = [Turn(1.0, 0.02, 2.0, 0.5, 1000)] * 3
        theirs = [Turn(1.0, error, 2.0, 0.5, 1000) for error in (0.01, 0.01, 0.05)]
        self.assertAlmostEqual(peers.line_of(ours, theirs)["ratio"], (2 * 0.01 ** 2 + 0.05 ** 2) / (3 * 0.02 ** 2))
        self.assertGreater(statistics.median(t.merit for t in theirs), agreement.merit_of_all(ours))   # the control
        self.assertLess(agreement.merit_of_all(theirs), agreement.merit_of_all(ours))

    def test_variants_of_a_method_share_the_variance_of_a_path(self):
        """The scalar variant found a rare score, the other none: both have it, in proportion to their paths."""
        fast, slow = [Turn(1.0, 0.01, 2.0, 0.5, 3000)] * 2, [Turn(1.0, 0.05, 2.0, 0.5, 1000)] * 2
        taken = {"straytrace": turns(1.0, 0.01), "Mitsuba path, LLVM": fast, "Mitsuba path, scalar": slow, "Raysect": turns(1.0, 0.1),
                 "Mitsuba path, broken": [None]}
        both = peers.turns_of_method("Mitsuba path, LLVM", taken)
        self.assertEqual(both, fast + slow)
        of_a_path = (3000 * 3000 * 0.01 ** 2 + 1000 * 1000 * 0.05 ** 2) / (3000 + 1000)
        self.assertAlmostEqual(agreement.merit_of_all(fast, both), 1500 / of_a_path)
        self.assertAlmostEqual(agreement.merit_of_all(slow, both), 500 / of_a_path)
        self.assertAlmostEqual(agreement.merit_of_all(fast), 1500 / (3000 * 0.01 ** 2))   # the control: alone it looks better
        self.assertAlmostEqual(peers.line_of(turns(1.0, 0.01), fast, both)["theirs_to_percent"], 0.5 + 1e4 * of_a_path / 1500)
        nothing = [Turn(0.0, 0.0, 2.0, 0.5, 1000)] * 2                                     # its paths count
        self.assertAlmostEqual(agreement.variance(fast + nothing), 3000 * 3000 * 0.01 ** 2 / 4000 / 0.75 ** 2)

    def test_error_of_batches(self):
        values = [1.0, 2.0, 3.0, 6.0]
        self.assertEqual(batches.mean_and_error(values), (3.0, statistics.stdev(values) / 2))


class Problems(unittest.TestCase):
    def test_knobbly_body_is_closed(self):
        points, triangles = problems.knobbly(12)
        edges = {}
        for a, b, c in triangles:
            for edge in ((a, b), (b, c), (c, a)):
                edges[edge] = edges.get(edge, 0) + 1
        self.assertTrue(all(count == 1 and edges.get((b, a)) == 1 for (a, b), count in edges.items()))
        self.assertEqual(len(points) - len(edges) // 2 + len(triangles), 2)              # Euler

    def test_walls_look_inwards(self):
        room = problems.Room("room", (0, 0, 0), (1, 2, 3), problems.BLACK)
        for _, centre, normal, width, height in problems.walls(room):
            axis = max(range(3), key=lambda k: abs(normal[k]))
            self.assertGreater(normal[axis] * (room.high[axis] / 2 - centre[axis]), 0)
            self.assertEqual({width, height} | {room.high[axis]}, {1, 2, 3})

    def test_flat_radiance_picture(self):
        with tempfile.TemporaryDirectory() as place:
            file = pathlib.Path(place) / "a.hdr"
            file.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes([127, 0, 0, 129, 0, 0, 0, 0]))
            self.assertEqual(run_povray.pixels(file), [127.5 / 128, 0.0])

    def test_straytrace_meets_the_closed_form(self):
        """A lamp that faces the receiver: mean of cos cos/(pi d^2) over both, by midpoints (docs/theory/sampling.md)."""
        problem, total = problems.lit_square(), 0.0
        points = [(0.1 * math.sqrt((i + 0.5) / 80), 2 * math.pi * (j + 0.5) / 20) for i in range(80) for j in range(20)]
        grid = [0.1 * (k + 0.5) / 30 - 0.05 for k in range(30)]
        for r, phi in points:
            for x in grid:
                for y in grid:
                    d2 = (r * math.cos(phi) - x) ** 2 + (r * math.sin(phi) - y) ** 2 + 0.25
                    total += 0.25 / d2 ** 2 / math.pi
        expected = total / (len(points) * len(grid) ** 2) * problem.receiver.side ** 2
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            (folder / "scene.yaml").write_text(straytrace_scene.scene(problem, folder), encoding="utf-8")
            subprocess.run([PROGRAM, "trace", folder / "scene.yaml", "-o", folder / "run.h5", "--histories", "131072", "--quiet"], check=True,
                           capture_output=True)
            told = json.loads(subprocess.run([PROGRAM, "paths", folder / "run.h5", "--format", "json"], check=True, capture_output=True).stdout)
        power = told["receivers"][0]["power"]
        value, sigma = power["value"] / straytrace_scene.DIM, power["sigma"] / straytrace_scene.DIM
        self.assertLess(sigma, 2e-3 * expected)                                          # sees an error of 1 %
        self.assertLess(abs(value - expected), 5 * sigma)

    def test_lens_is_closed_glass(self):
        lens = real.Lens("lens", (0, 0, 0), (0, 0, 1), 0.0254, 0.1, 1.45)
        points, faces = run_mitsuba.glass(lens)
        volume = 0.0
        for a, b, c in ([points[i] for i in face] for face in faces):
            volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
        expected = 2 * math.pi * lens.sag ** 2 * (3 * lens.curvature_radius - lens.sag) / 3
        self.assertLess(abs(volume / expected - 1), 1e-3)                                # also sees a face turned inside out

    def test_straytrace_reads_every_problem(self):
        known = problems.PROBLEMS | real.REAL
        for name in ("tube", "long_tube", "bench", "two_bounces", "bench_behind", "baffles_wall", "trap_wall"):
            with self.subTest(name), tempfile.TemporaryDirectory() as place:
                scene = pathlib.Path(place) / "scene.yaml"
                scene.write_text(straytrace_scene.scene(known[name](), scene.parent), encoding="utf-8")
                done = subprocess.run([PROGRAM, "check", scene], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
