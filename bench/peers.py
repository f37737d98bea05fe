#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whole problems against other programs: what share of the light of a lamp reaches a receiver after scatter.

Each program gets the same scene (bench/peers/problems.py), one core and about the same processor time per turn, in turns. The figure of merit is
1/(relative error^2 x processor seconds of sampling) of all turns together; set-up (reading, trees, tables, compiling) is listed
separately. Where two values differ by more than four standard errors the comparison is void and says so. Programs:
scripts/setup --peers.

Examples:
  scripts/bench peers --keep                      all problems and programs, for the page
  scripts/bench peers --only mesh,raysect         one problem, one program
  scripts/bench peers --quick                     does it run?
"""
import json
import os
import pathlib
import shutil
import statistics
import sys
import tempfile

from agreement import Turn, apart, merit_of_all, seconds_to_percent, together, why_void
from ours import Ours
from record import QUIET, SOURCE, Results, arguments, child, in_turns, spread

sys.path.insert(0, str(SOURCE / "bench/peers"))
import problems  # noqa: E402
import straytrace_scene  # noqa: E402

HOME = SOURCE / "build/peers"
LLVM = sorted(pathlib.Path("/usr/lib").glob("*/libLLVM.so.19*"))
ASKED = {"tube": {}, "long_tube": {}, "bench": {}, "mesh": {}, "two_bounces": {"POV-Ray"}}   # and the only programs that solve it
# name: (file that runs it, its --way, what must be there)
PROGRAMS = {
    "Mitsuba path, LLVM": ("run_mitsuba.py", "llvm_ad_mono:path", "mitsuba"),
    "Mitsuba path, scalar": ("run_mitsuba.py", "scalar_rgb:path", "mitsuba"),
    "Mitsuba particles, LLVM": ("run_mitsuba.py", "llvm_ad_mono:ptracer", "mitsuba"),
    "Radiance": ("run_radiance.py", "", "pyradiance"),
    "Raysect": ("run_raysect.py", "", "raysect"),
    "POV-Ray": ("run_povray.py", "", "povray"),
}
ONE_PROBLEM = set().union(*ASKED.values())
MERIT_OVER_MITSUBA = {"tube": 1.5, "bench": 4, "mesh": 1.5}
# How many times the turns of others: estimates with so heavy a tail that a few turns say nothing about their error.
MORE_TURNS = {("bench", "Mitsuba path"): 4}


def missing(what, way):
    """Why this program cannot be run here; "" if it can."""
    if what == "povray":
        return "" if shutil.which("povray") else "povray is not installed: scripts/setup --peers"
    if not list(HOME.glob(f"lib/python*/site-packages/{what}/__init__.py")):
        return f"{what} is not in build/peers: scripts/setup --peers"
    return "Debian's libllvm19 is not installed: scripts/setup --peers" if way.startswith("llvm") and not LLVM else ""


class Theirs:
    def __init__(self, words, folder, core, name, problem):
        file, way, _ = PROGRAMS[name]
        self.seed, self.core, self.failed = 0, core, ""
        self.command = [HOME / "bin/python", SOURCE / "bench/peers" / file, problem, "--folder", folder, "--seconds", words.seconds,
                        *(["--way", way] if way else [])]

    def __call__(self):
        """A turn; None, and why in `failed`, where the program fails."""
        self.seed += 1
        env = dict(QUIET, OMP_NUM_THREADS="1", **({"DRJIT_LIBLLVM_PATH": str(LLVM[-1])} if LLVM else {}))
        try:
            done = child([*self.command, "--seed", self.seed], core=self.core, env=env)
        except SystemExit as failure:
            self.failed = f"it failed: {str(failure).strip().splitlines()[-1][:200]}"
            return None
        said = json.loads(done.output[done.output.rindex("\n{" if "\n{" in done.output else "{"):])
        return Turn(**said, peak_memory=done.peak_memory)


def side(prefix, turns, of_method=()):
    """Fields of one side of a line."""
    value, error = together(turns)
    found = {"value": value, "error": error, "seconds": statistics.median(t.seconds for t in turns),
             "setup": statistics.median(t.setup for t in turns),
             "paths": statistics.median(t.paths / t.seconds for t in turns), "paths_unit": "1/s",
             "peak_memory": max(t.peak_memory for t in turns), "to_percent": seconds_to_percent(turns, of_method)}
    if turns[0].rays:
        found |= {"rays": statistics.median(t.rays / t.seconds for t in turns), "rays_unit": "1/s"}
    found |= {f"{key}_unit": "s" for key in ("seconds", "setup", "to_percent")}
    return {prefix + key: v for key, v in found.items() if v != float("inf")}


def line_of(ours, theirs, of_method=()):
    fields = {**side("", ours), **side("theirs_", theirs, of_method), "unit": "1/s", "repeats": len(ours)}
    if why := why_void(ours, theirs):
        return {"skipped": why, **fields}
    merits = {"ours": merit_of_all(ours), "theirs": merit_of_all(theirs, of_method)}
    between = spread([a.merit / b.merit for a, b in zip(ours, theirs)])
    return {**merits, "ratio": merits["ours"] / merits["theirs"], "spread": between, "apart": apart(ours, theirs), **fields}


def method_of(name):
    """Of variants of a program that draw the same paths: 'Mitsuba path' of 'Mitsuba path, LLVM' and 'Mitsuba path, scalar'."""
    return name.split(",")[0]


def turns_of_method(name, taken):
    return [turn for other, turns in taken.items() if method_of(other) == method_of(name) for turn in turns if turn]


def turns_by_program(problem, ways, words):
    """{program: turns of all the ways that took as many, "straytrace" among them}."""
    repeats = {name: 1 if words.quick else words.repeats * MORE_TURNS.get((problem, method_of(name)), 1)
               for name in ways if name != "straytrace"}
    taken = {}
    for count in sorted(set(repeats.values())):
        group = {name: way for name, way in ways.items() if repeats.get(name, count) == count}
        turns = in_turns(group, count)
        taken |= {name: turns for name in group}
    return taken


def compare(results, words, problem, core):
    programs = [name for name in words.programs if (name in ASKED[problem] if ASKED[problem] else name not in ONE_PROBLEM)]
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        (folder / "scene.yaml").write_text(straytrace_scene.scene(problems.PROBLEMS[problem](), folder), encoding="utf-8")
        ways, absent = {"straytrace": Ours(words, folder / "scene.yaml", core, straytrace_scene.DIM)}, {}
        for name in programs:
            _, way, what = PROGRAMS[name]
            if why := missing(what, way):
                absent[name] = why
            else:
                (folder / what).mkdir(exist_ok=True)
                ways[name] = Theirs(words, folder / what, core, name, problem)
        taken = turns_by_program(problem, ways, words)
    lines = {}
    for name in programs:
        why = absent.get(name) or ways[name].failed
        group = taken.get(name)
        lines[name] = {"skipped": why} if why else line_of(group["straytrace"], group[name], turns_of_method(name, group))
    set_goal(problem, lines)
    for name, fields in lines.items():
        results.add(f"{problem}: {name}", problem=problem, program=name, **fields)


def set_goal(problem, lines):
    """The goal belongs to the best variant of Mitsuba."""
    ratios = {name: fields["ratio"] for name, fields in lines.items() if name.startswith("Mitsuba") and "ratio" in fields}
    if problem in MERIT_OVER_MITSUBA and ratios:
        lines[min(ratios, key=ratios.get)]["goal"] = {"of": "ratio", "at_least": MERIT_OVER_MITSUBA[problem],
                                                      "name": f"figure of merit over the best variant of Mitsuba, {problem}"}


def chosen(words):
    """Problems and programs that --only names by a part of their names; all if it names none of the kind."""
    named = [part.strip().lower() for part in words.only.split(",") if part.strip()]
    taken = [[name for name in all_ if any(part in name.lower() for part in named)] or list(all_) for all_ in (ASKED, PROGRAMS)]
    lost = [part for part in named if not any(part in name.lower() for name in (*ASKED, *PROGRAMS))]
    if lost:
        sys.exit(f"--only: nothing is called '{lost[0]}'. Problems: {', '.join(ASKED)}; programs: {', '.join(PROGRAMS)}")
    return taken


def main():
    parser = arguments(__doc__, repeats=3)
    parser.add_argument("--seconds", type=float, default=4, help="processor time of sampling, each turn (%(default)s)")
    parser.add_argument("--only", default="", help="problems and programs, by part of their names, with commas")
    words = parser.parse_args()
    if words.keep and words.only:
        sys.exit("--keep: the lines of all problems and programs are replaced together; leave --only out")
    asked, words.programs = chosen(words)
    if words.quick:
        words.seconds = 0.2
    core = max(os.sched_getaffinity(0))
    with Results("peers", words) as results:
        for problem in asked:
            compare(results, words, problem, core)


if __name__ == "__main__":
    main()
