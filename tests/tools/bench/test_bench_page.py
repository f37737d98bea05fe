#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page of benchmarks agrees with the lines in bench/results; how records are made. Usage: test_bench_page.py"""
import argparse
import json
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "bench"))
import page  # noqa: E402
import pictures  # noqa: E402
import record  # noqa: E402
from growth import exponent  # noqa: E402


class Page(unittest.TestCase):
    def test_is_what_the_lines_say(self):
        self.assertEqual(list(page.problems(page.PAGE, record.KEPT)), [])

    def test_another_number_is_seen(self):
        """The negative controls: a number changed in the page, and one changed in the lines."""
        with tempfile.TemporaryDirectory() as place:
            pages, kept = pathlib.Path(place) / "pages", pathlib.Path(place) / "results"
            pages.mkdir()
            shutil.copytree(record.KEPT, kept)
            for file in [page.PAGE, *page.PAGE.parent.glob("benchmarks_*.png")]:
                shutil.copy(file, pages)
            copy = pages / page.PAGE.name
            self.assertEqual(list(page.problems(copy, kept)), [])
            text = copy.read_text()
            row = next(line for line in text.splitlines() if line.startswith("| philox |"))
            copy.write_text(text.replace(row, re.sub(r"\d+", lambda number: str(int(number[0]) + 1), row)))
            self.assertNotEqual(list(page.problems(copy, kept)), [])
            copy.write_text(text)
            for bench in pictures.DRAWN:                 # a line more: the picture is not drawn from it
                file = kept / f"{bench}.jsonl"
                if file.exists():
                    file.write_text(file.read_text() + file.read_text().splitlines()[0] + "\n")
                    self.assertIn(f"{pictures.picture_of(pages, bench).name} is not drawn", "".join(page.problems(copy, kept)))

    def test_text_around_tables_stays(self):
        lines = {"one": [{"bench": "one", "case": "a|b", "ours": 2.0, "unit": "s", "date": "2026-01-01T", "commit": "c", "processor": "p",
                          "cores": 2, "load": 0.1, "compiler": "g", "flags": "-O3", "goal": {"of": "ours", "at_most": 1}, "met": False}]}
        text = "A\n<!-- goals -->\n<!-- end -->\nB\n<!-- bench one: case | ours, time -->\nold\n<!-- end -->\nC\n"
        new = page.written(text, lines)
        self.assertEqual([line for line in new.splitlines() if line in ("A", "B", "C", "old")], ["A", "B", "C"])
        self.assertIn("| case | time |", new)
        self.assertIn("| ≤ 1.00 s | 2.00 s |", new)
        self.assertIn("**no**", new)
        other = {"one": [*lines["one"], lines["one"][0] | {"processor": "q", "date": "2026-01-02T", "ours": 0.5, "met": True}]}
        both = page.written(text, other)                  # one goal, met on one of two processors; the table is of the last one
        self.assertIn("| a|b | one | ≤ 1.00 s | 2.00 s |  | **no** | 500 ms |  | yes |", both)
        self.assertIn("| a|b | 500 ms |\n\nMeasured 2026-01-02", both)
        self.assertEqual(page.written(new, lines), new)

    def test_numbers_as_they_are_read(self):
        for value, unit, text in ((5.123e7, "1/s", "51.2 M/s"), (0.44, "s", "440 ms"), (2.6e4, "s", "26000 s"), (40e6, "B", "40.0 MB"),
                                  (1.4e-6, "s", "1.40 µs"), (0.0253, "", "0.0253"), (4.76e-6, "", "4.76e-6"), (168.1, "instructions",
                                                                                                    "168 instructions")):
            self.assertEqual(page.with_unit(value, unit), text)


class Records(unittest.TestCase):
    def results(self, place, **words):
        words = {"quick": False, "keep": False, "program": pathlib.Path("none"), "results": pathlib.Path(place) / "r.jsonl", **words}
        return record.Results("page", argparse.Namespace(**words))

    def test_a_goal_that_is_missed_says_so(self):
        with tempfile.TemporaryDirectory() as place, self.results(place) as results:
            for goal, met in (({"of": "ratio", "at_least": 6}, True), ({"of": "ratio", "at_least": 7}, False),
                              ({"of": "ours", "at_most": 3}, True), ({"of": "ours", "at_most": 2}, False)):
                results.add("one", ours=2.5, ratio=6.5, goal=goal)
                self.assertEqual(results.lines[-1]["met"], met)
            lines = [json.loads(line) for line in results.words.results.read_text().splitlines()]
            self.assertEqual(lines, results.lines)
            self.assertTrue(all(line[key] for line in lines for key in ("commit", "compiler", "processor", "cores", "date")))

    def test_a_part_replaces_its_own_lines(self):
        with tempfile.TemporaryDirectory() as place:
            kept, record.KEPT = record.KEPT, pathlib.Path(place)
            try:
                for groups, chosen, wanted in (("ab", None, "ab"), ("b", ["b"], "ab"), ("a", None, "a")):
                    words = argparse.Namespace(quick=False, keep=True, program=pathlib.Path("none"), group=chosen,
                                               results=pathlib.Path(place) / "r.jsonl")
                    with record.Results("page", words, "group") as results:
                        for group in groups:
                            results.add("one", group=group, ours=len(groups))
                    lines = [json.loads(line) for line in (record.KEPT / "page.jsonl").read_text().splitlines()]
                    self.assertEqual("".join(line["group"] for line in lines), wanted)
            finally:
                record.KEPT = kept

    def test_lines_of_another_processor_stay(self):
        with tempfile.TemporaryDirectory() as place:
            kept, record.KEPT = record.KEPT, pathlib.Path(place)
            try:
                for processor, on_any, wanted in (("p", False, "p"), ("q", False, "pq"), ("p", False, "qp"), ("p", True, "p")):
                    words = argparse.Namespace(quick=False, keep=True, program=pathlib.Path("none"), results=pathlib.Path(place) / "r.jsonl")
                    with record.Results("page", words, on_any=on_any) as results:
                        results.about["processor"] = processor
                        results.add("one", ours=1)
                    lines = [json.loads(line) for line in (record.KEPT / "page.jsonl").read_text().splitlines()]
                    self.assertEqual("".join(line["processor"] for line in lines), wanted)
            finally:
                record.KEPT = kept

    def test_tiny_runs_are_not_kept(self):
        with self.assertRaises(SystemExit):
            self.results(".", quick=True, keep=True)

    def test_time_and_memory_of_a_child(self):
        """100 MB held and a tenth of a second of work, and not the memory of this process."""
        held = bytearray(300_000_000)
        done = record.child([sys.executable, "-c", "import time\nx = b'x' * 100_000_000\nwhile time.process_time() < 0.1: pass"])
        self.assertTrue(100e6 < done.peak_memory < 200e6, done.peak_memory)
        self.assertGreater(done.cpu, 0.1)
        self.assertGreater(len(held), 0)

    def test_ratio_and_spread(self):
        found = record.compared([2, 2, 4], [4, 8, 8])                            # ratios of turns 2, 4, 2
        self.assertEqual((found["ratio"], found["spread"], found["ours"], found["theirs"]), (2, 1, 2, 8))
        self.assertEqual(record.compared([4], [2], less_is_better=False)["ratio"], 2)

    def test_exponent(self):
        slope, error = exponent([(n, 3 * n ** 0.5) for n in (10, 100, 1000)])
        self.assertAlmostEqual(slope, 0.5)
        self.assertLess(error, 1e-6)
        self.assertIsNone(exponent([(1, 1), (2, 2)])[1])
        slope, error = exponent([(1, 1), (10, 20), (100, 100), (1000, 2000)])
        self.assertTrue(abs(slope - 1) < 2 * error and error > 0.05)


if __name__ == "__main__":
    unittest.main()
