#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rays per second of the engine and of Embree, taking turns in one process on one core; goals of the engine.

Examples:
  scripts/bench engine --keep          all scenes, for the page
  scripts/bench engine --scene mesh    one of tube3, tube40, bench, mesh
"""
from record import Results, arguments, lines_of

SCENES = ("tube3", "tube40", "bench", "mesh")


def main():
    parser = arguments(__doc__, repeats=7)
    parser.add_argument("--scene", choices=SCENES, action="append", help="this scene alone; more than one may be named")
    words = parser.parse_args()
    rays, turns = (1 << 12, 1) if words.quick else (1 << 18, words.repeats)
    with Results("engine", words, "scene") as results:
        for scene in words.scene or SCENES:
            for line, memory in lines_of("bench_engine", scene, rays, turns):
                results.add(line.pop("case"), scene=scene, peak_memory=memory, **line)


if __name__ == "__main__":
    main()
