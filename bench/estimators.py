#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The ways to sample, on the same scenes: waiting for hits, connections, sub-paths from the receiver, targets, windows.

Every way gives the same value or the comparison is void. The figure of merit is 1/(relative error^2 x processor seconds); the ratio
is that of the default over the way, of all turns together. Errors are those of each turn, from the spread of its blocks.

Examples:
  scripts/bench estimators --keep      three scenes, five seeds each; for the page
  scripts/bench estimators --quick     does it run?
"""
import statistics

from agreement import Turn, apart, merit_of_all, together, why_void
from record import Results, arguments, lines_of, spread

GOAL = {"of": "ratio", "at_least": 100, "name": "figure of merit of a hard class, over law + connections"}
BEST = {"of": "ratio", "at_least": 0.9}                  # the default over the best way, all quantities of a scene together
HARD = ("photodiode behind a ring", "law + connections")


def read(lines):
    """{(scene, quantity): {way: [Turn]}} in the order of the lines."""
    found = {}
    for line, memory in lines:
        turn = Turn(line["value"], line["error"], line["seconds"], line["setup"], line["paths"], line["rays"] or None, memory)
        found.setdefault((line["scene"], line["quantity"]), {}).setdefault(line["way"], []).append(turn)
    return found


def fields_of(default, turns):
    """Of one way: its value, its merit, and how much better the default is."""
    value, error = together(turns)
    fields = {"value": value, "error": error, "theirs": merit_of_all(turns), "unit": "1/s", "repeats": len(turns),
              "setup": turns[0].setup, "setup_unit": "s", "peak_memory": turns[0].peak_memory}
    if turns[0].rays:
        fields |= {"rays": statistics.median(t.rays / t.seconds for t in turns), "rays_unit": "1/s"}
    if why := why_void(default, turns):
        return {**fields, "skipped": why}
    merit, between = merit_of_all(default), spread([a.merit / b.merit for a, b in zip(default, turns)])
    return {**fields, "ours": merit, "ratio": merit / fields["theirs"], "spread": between, "apart": apart(default, turns)}


def over_the_best(found, scene):
    """(way, geometric mean over the quantities of the ratio of the default to it, its spread between turns) of the best way that
    resolves all of them; None: no way does. All turns of a way count as one run."""
    of_way, of_turn = {}, {}
    quantities = [ways for (of, _), ways in found.items() if of == scene]
    for ways in quantities:
        default = ways["default"]
        for way, turns in ways.items():
            if way != "default" and not why_void(default, turns):
                of_way.setdefault(way, []).append(merit_of_all(default) / merit_of_all(turns))
                of_turn.setdefault(way, []).append([a.merit / b.merit for a, b in zip(default, turns)])
    means = {way: statistics.geometric_mean(ratios) for way, ratios in of_way.items() if len(ratios) == len(quantities)}
    if not means:
        return None
    best = min(means, key=means.get)
    return best, means[best], spread([statistics.geometric_mean(ratios) for ratios in zip(*of_turn[best])])


def write(results, found):
    for (scene, quantity), ways in found.items():
        default = ways["default"]
        for way, turns in ways.items():
            fields = fields_of(default, turns)
            if (quantity, way) == HARD and "ratio" in fields:
                fields["goal"] = GOAL
            results.add(f"{scene}, {quantity}: {way}", scene=scene, quantity=quantity, way=way, **fields)
    for scene in dict.fromkeys(scene for scene, _ in found):
        if best := over_the_best(found, scene):
            results.add(f"{scene}, all: {best[0]}", scene=scene, quantity="all", way=best[0], ratio=best[1], spread=best[2],
                        goal={**BEST, "name": f"figure of merit over the best way, {scene}"})


def main():
    parser = arguments(__doc__)
    parser.add_argument("--seconds", type=float, default=2, help="processor time of each turn (%(default)s)")
    words = parser.parse_args()
    seconds, turns = (0.05, 1) if words.quick else (words.seconds, words.repeats)
    with Results("estimators", words) as results:
        write(results, read(lines_of("bench_estimators", seconds, turns)))


if __name__ == "__main__":
    main()
