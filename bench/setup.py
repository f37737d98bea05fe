#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Processor time of one core: of a run of one block, which is reading, set-up and writing, and of each history of long runs.

Examples:
  scripts/bench setup --keep      arms, a long pipe, the bench of the peers
  scripts/bench setup --quick     does it run?
"""
import os
import pathlib
import statistics
import sys
import tempfile

from ours import BLOCK
from record import SOURCE, Results, arguments, child, in_turns, spread

sys.path.insert(0, str(SOURCE / "bench/peers"))
import problems  # noqa: E402
import straytrace_scene  # noqa: E402

EXAMPLES = SOURCE / "examples"


def scenes(folder):
    """{name: (words of the command, most seconds of set-up)}."""
    peers = folder / "bench.yaml"
    peers.write_text(straytrace_scene.scene(problems.bench(), folder), encoding="utf-8")
    return {"Virgo arm": ([EXAMPLES / "virgo_arm.yaml"], 0.15), "ET-HF arm": ([EXAMPLES / "et_hf_arm.yaml"], None),
            "pipe with 2000 baffles": ([EXAMPLES / "pipe.yaml", "-p", "baffles=1000"], 0.5), "bench of the peers": ([peers], 0.3)}


def turn(words, scene, blocks, folder):
    """(seconds of one block, seconds per history, peak memory)."""
    def trace(histories):
        run = folder / "run.h5"
        run.unlink(missing_ok=True)
        return child([words.program, "trace", *scene, "-o", run, "--histories", histories, "--threads", 1, "--quiet"],
                     core=max(os.sched_getaffinity(0)))
    least, short, long = trace(1), trace(BLOCK), trace(BLOCK * (1 + blocks))
    return least.cpu, (long.cpu - short.cpu) / (BLOCK * blocks), long.peak_memory


def main():
    words = arguments(__doc__).parse_args()
    blocks, repeats = (1, 1) if words.quick else (64, words.repeats)
    with Results("setup", words) as results, tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        wanted = scenes(folder)
        taken = in_turns({name: lambda scene=scene: turn(words, scene, blocks, folder) for name, (scene, _) in wanted.items()}, repeats)
        for name, turns in taken.items():
            setup, each, memory = zip(*turns)
            most = wanted[name][1]
            goal = {"goal": {"of": "ours", "at_most": most, "name": f"set-up of {name}"}} if most else {}
            results.add(name, ours=statistics.median(setup), unit="s", spread=spread(setup), per_history=statistics.median(each),
                        per_history_unit="s", per_history_spread=spread(each), peak_memory=max(memory), repeats=repeats, **goal)


if __name__ == "__main__":
    main()
