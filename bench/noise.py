#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The noise stage: seconds and memory for a million paths, its error, compared with time series; a stored run that is
projected anew with other motion.

Examples:
  scripts/bench noise --keep      a million records, motion of one, two and three shapes; for the page
  scripts/bench noise --quick     the same with few records: does it run?
"""
import json
import os
import pathlib
import tempfile

from record import SOURCE, Results, arguments, child, compared, in_turns, lines_of


def projected_anew(results, words):
    """`straytrace noise RUN` with another motion of the tube: everything from the file to the printed table."""
    histories = 1 << 14 if words.quick else 1 << 20
    core = max(os.sched_getaffinity(0))
    with tempfile.TemporaryDirectory() as folder:
        run = pathlib.Path(folder) / "run.h5"
        child([words.program, "trace", SOURCE / "examples/virgo_arm.yaml", "-o", run, "--histories", histories, "--quiet"])
        motion = SOURCE / "examples/storm.yaml"
        taken = in_turns({"noise": lambda: child([words.program, "noise", run, "--motion", motion, "--quiet", "--format", "json"],
                                                 core=core)}, 1 if words.quick else words.repeats)["noise"]
        about = json.loads(taken[0].output)
        results.add("a stored run with other motion", histories=histories, routes=len(about["routes"]), unit="s",
                    peak_memory=max(t.peak_memory for t in taken), goal={"of": "ours", "at_most": 1},
                    **compared([t.cpu for t in taken]))


def main():
    words = arguments(__doc__).parse_args()
    records, turns = (1000, 1) if words.quick else (10**6, words.repeats)
    with Results("noise", words) as results:
        for shapes in (1, 2, 3):
            for line, memory in lines_of("bench_noise", shapes, records, turns):
                results.add(line.pop("case"), peak_memory=memory, **line)
        projected_anew(results, words)


if __name__ == "__main__":
    main()
