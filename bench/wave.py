#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fourier transforms of fields: there and back with the rows and columns of a leg in a long arm, and with all of them, compared with
scipy.fft, which transforms all.

Examples:
  scripts/bench wave --keep      512, 1024 and 2048 points per side; for the page
  scripts/bench wave --quick     once and with few points: does it run?
"""
import json
import os

from record import BUILD, Results, arguments, child, compared, in_turns

THEIRS = """
import sys, time
import numpy, scipy.fft
points, repeats = map(int, sys.argv[1:])
i = numpy.arange(points * points)
field, least = (i % 97 + 1j * (i % 31)).reshape(points, points), 1e9
for _ in range(repeats):
    start = time.thread_time()
    field = scipy.fft.ifft2(scipy.fft.fft2(field, overwrite_x=True), overwrite_x=True)
    least = min(least, time.thread_time() - start)
print(least)
"""


def main():
    words = arguments(__doc__).parse_args()
    core = max(os.sched_getaffinity(0))
    sizes, repeats, turns = ((64,), 1, 1) if words.quick else ((512, 1024, 2048), 20, words.repeats)
    with Results("wave", words) as results:
        for points in sizes:
            taken = in_turns({
                "ours": lambda: json.loads(child([BUILD / "bench_wave", points, repeats], core=core).output),
                "theirs": lambda: float(child(["/usr/bin/python3", "-c", THEIRS, points, repeats], core=core).output)}, turns)
            for kind, name, goal in (("pruned", "leg of a long arm", 2), ("whole", "all rows and columns", 1)):
                copies = compared([t[kind] for t in taken["ours"]], [t["copy"] for t in taken["ours"]])
                results.add(f"{points} × {points}, {name}", unit="s", library=taken["ours"][0]["library"], copies=1 / copies["ratio"],
                            goal={"of": "ratio", "at_least": goal}, **compared([t[kind] for t in taken["ours"]], taken["theirs"]))


if __name__ == "__main__":
    main()
