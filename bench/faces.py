#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""A part from CAD by its exact faces, and the same part as triangles, with the given chord: set-up, rays, figure of merit, value.

The part is examples/data/cad_bench.step, all of it diffuse. A lamp lights it from above; what of its light the part sends to a square
next to the lamp is the value. Triangles of a coarse chord are another part: their value may differ, which the line states.

Examples:
  scripts/bench faces --keep      chords of 1 mm, 0.1 mm and 10 um; for the page
  scripts/bench faces --quick     does it run?
"""
import json
import os
import pathlib
import shutil
import statistics
import tempfile

from agreement import apart, merit_of_all, together, why_void
from ours import Ours
from record import BUILD, SOURCE, Results, arguments, child, in_turns, spread

PART = SOURCE / "examples/data/cad_bench.step"
CHORDS = ("1", "0.1", "0.01")                            # mm
DIM = 1e-6                                               # albedo of the lamp: what comes back to it is gone


def scene(file, units):
    def flat(name, shape, x, material):
        return {"name": name, "shape": shape, "at": [x, "0 m", "40 cm"], "facing": [0, 0, -1], "body": "all", "material": material}
    return {"straytrace": 1, "title": "faces", "bodies": {"all": {"motion": "still"}},
            "materials": {"lamp": {"scatter": {"model": "lambertian", "tis": DIM}}, "black": {},
                          "grey": {"scatter": {"model": "lambertian", "tis": 0.5}}},
            "scene": [{**flat("lamp", {"disk": {"outer_radius": "2 cm"}}, "10 cm", "lamp"), "side": "front"},
                      flat("receiver", {"rectangle": {"width": "4 cm", "height": "4 cm"}}, "-10 cm", "black"),
                      {"name": "part", "file": file.name, "units": units, "at": ["0 m", "0 m", "0 m"], "body": "all", "material": "grey"}],
            "beams": {"light": {"on": "lamp", "profile": "even", "radius": "2 cm", "travel": [0, 0, 1], "power": "1 W"}},
            "receivers": {"receiver": {"on": "receiver", "side": "front"}}}


def way(words, folder, name, file, units, core):
    place = folder / f"{name}.yaml"
    if file.parent != folder:
        shutil.copy(file, folder)
    place.write_text(json.dumps(scene(file, units), indent=1), encoding="utf-8")
    return Ours(words, place, core, DIM)


def triangles_in(stl):
    return int.from_bytes(stl.read_bytes()[80:84], "little")


def line_of(exact, other):
    """A line: ours by exact faces, theirs by triangles."""
    about = {"unit": "1/s", "repeats": len(exact), "setup_unit": "s", "theirs_setup_unit": "s", "rays_unit": "1/s", "theirs_rays_unit": "1/s"}
    for prefix, turns in (("", exact), ("theirs_", other)):
        value, error = together(turns)
        about |= {f"{prefix}value": value, f"{prefix}error": error, f"{prefix}setup": statistics.median(t.setup for t in turns),
                  f"{prefix}rays": statistics.median(t.rays / t.seconds for t in turns),
                  f"{prefix}peak_memory": max(t.peak_memory for t in turns)}
    about["apart"] = apart(exact, other)
    if why := why_void(exact, other):
        return {**about, "skipped": why}
    ours, theirs, between = merit_of_all(exact), merit_of_all(other), spread([a.merit / b.merit for a, b in zip(exact, other)])
    return {**about, "ours": ours, "theirs": theirs, "ratio": ours / theirs, "spread": between}


def main():
    parser = arguments(__doc__, repeats=3)
    parser.add_argument("--seconds", type=float, default=4, help="processor time of tracing, each turn (%(default)s)")
    parser.add_argument("--mesher", type=pathlib.Path, default=BUILD / "bench_faces_to_stl", help="what makes triangles (%(default)s)")
    words = parser.parse_args()
    if words.quick:
        words.seconds = 0.1
    core = max(os.sched_getaffinity(0))
    with Results("faces", words) as results, tempfile.TemporaryDirectory() as place:
        if not words.mesher.exists():
            results.add("exact faces", skipped="OpenCASCADE is not installed, so there is no STEP: scripts/setup")
            return
        folder = pathlib.Path(place)
        ways, stl = {"exact": way(words, folder, "exact", PART, "from_file", core)}, {}
        for chord in CHORDS[:1] if words.quick else CHORDS:
            stl[chord] = folder / f"chord_{chord}.stl"
            child([words.mesher, PART, stl[chord], chord])
            ways[chord] = way(words, folder, f"chord_{chord}", stl[chord], "mm", core)
        taken = in_turns(ways, 1 if words.quick else words.repeats)
        for chord, file in stl.items():
            results.add(f"triangles within {chord} mm", triangles=triangles_in(file), **line_of(taken["exact"], taken[chord]))


if __name__ == "__main__":
    main()
