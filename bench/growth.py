#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""How cost grows: seconds of setup, time per history and memory against the number of baffles, triangles, routes, bodies; of the
noise stage against bodies and frequency bins; of a merge against the number of parts. Fitted exponents with error.

Examples:
  scripts/bench growth --keep                  all of it, for the page: about seven minutes
  scripts/bench growth --keep --group routes   one of baffles, triangles, routes, bodies, bins, parts
"""
import concurrent.futures
import math
import os
import pathlib
import statistics
import tempfile
import time

from growth_scenes import annuli, knobbly_bodies, room_with
from record import SOURCE, Results, arguments, child, spread

BLOCK = 4096
CORE = max(os.sched_getaffinity(0))
LOGARITHM = 0.15        # what ln n looks like as a power from 1e2 to 1e5 (0.13), and a little
ENOUGH, TOO_LONG = 12, 40           # s: sizes have two turns and more until ENOUGH are spent, one where it is TOO_LONG


class Group:
    """One thing that grows. `make(n)` prepares a size and returns how large it came out; `turn(n)` measures it once."""

    def __init__(self, words, folder):
        self.words, self.folder = words, folder

    @property
    def rings(self):
        return 50 if self.words.quick else 400

    def run(self, *command, **more):
        return child([self.words.program, *command], core=CORE, cwd=self.folder, **more)

    def traced(self, scene, *more, short=1, long=64):
        """Setup and time per history from the processor time of two lengths, in blocks; memory of the longer."""
        if self.words.quick:
            short, long = 1, 2
        taken = [self.run("trace", scene, *more, "-o", "run.h5", "--force", "--quiet", "--threads", 1, "--histories", blocks * BLOCK)
                 for blocks in (short, long)]
        each = (taken[1].cpu - taken[0].cpu) / ((long - short) * BLOCK)
        return {"setup": taken[0].cpu - short * BLOCK * each, "per_history": each, "memory": taken[1].peak_memory}

    def make(self, n):
        return n


class Baffles(Group):
    """The arm of examples/pipe.yaml with more and more baffles."""
    sizes, quick = (100, 300, 1000, 3000, 10000, 100000), (20, 40)
    limits = {"per_history": LOGARITHM}

    def turn(self, n):
        return self.traced(SOURCE / "examples/pipe.yaml", "-p", f"baffles={n // 2}")


class Triangles(Group):
    """Sixteen knobbly bodies in a box, in finer and finer triangles."""
    sizes, quick = (10**3, 10**4, 10**5, 10**6, 10**7), (10**3, 2 * 10**3)
    limits = {"per_history": LOGARITHM}

    def make(self, n):
        made = knobbly_bodies(self.folder / f"{n}.ply", n)
        (self.folder / f"{n}.yaml").write_text(room_with(f"{n}.ply"))
        return made

    def turn(self, n):
        return self.traced(f"{n}.yaml", long=64 if n < 10**6 else 256)  # rays are not to drown in the noise of the setup


class Routes(Group):
    """Four hundred annuli that a mirror sees, divided among more and more names."""
    sizes, quick = (1, 10, 100, 400), (1, 10)
    limits = {"per_history": LOGARITHM}

    def make(self, n):
        (self.folder / f"{n}.yaml").write_text(annuli(n, 1, self.rings))
        return n

    def turn(self, n):
        return self.traced(f"{n}.yaml", short=128, long=384)      # by then every route has been met


class Bodies(Group):
    """The same, every name with its own motion: trace and noise."""
    sizes, quick = (1, 10, 100, 400), (1, 10)
    limits = {"per_history": LOGARITHM, "noise": 1.1}

    def make(self, n):
        (self.folder / f"{n}.yaml").write_text(annuli(self.rings, n, self.rings))
        return n

    def turn(self, n):
        found = self.traced(f"{n}.yaml", short=128, long=384)
        return {**found, "noise": self.run("noise", "run.h5", "--quiet").cpu}


class Bins(Group):
    """The noise of a traced arm of Virgo on finer and finer grids of frequency."""
    sizes, quick = (20, 100, 500, 2000), (20, 40)
    limits = {"noise": 1.1}

    def make(self, n):
        if not (self.folder / "virgo.h5").exists():
            self.run("trace", SOURCE / "examples/virgo_arm.yaml", "-o", "virgo.h5", "--quiet", "--histories",
                     BLOCK * (2 if self.words.quick else 64))
        storm = (SOURCE / "examples/storm.yaml").read_text()
        (self.folder / f"{n}.yaml").write_text(storm + f"noise: {{band: [10 Hz, 1 kHz], points_per_decade: {n // 2}}}\n")
        return n

    def turn(self, n):
        done = self.run("noise", "virgo.h5", "--motion", f"{n}.yaml", "--quiet")
        return {"noise": done.cpu, "memory": done.peak_memory}


class Parts(Group):
    """Run files of `trace --slice I/N` of examples/pipe.yaml, one block each, made one run again."""
    sizes, quick = (10, 100, 1000), (3, 6)
    limits = {"merge": 1.1}

    def make(self, n):
        def slice_of(i):
            part = self.folder / f"{n}_{i:04}.h5"
            child([self.words.program, "trace", SOURCE / "examples/pipe.yaml", "-p", "baffles=20", "-o", part, "--quiet", "--threads", 1,
                   "--histories", n * BLOCK, "--slice", f"{i}/{n}"])
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(slice_of, range(1, n + 1)))
        return n

    def turn(self, n):
        done = self.run("merge", *sorted(self.folder.glob(f"{n}_*.h5")), "-o", "merged.h5", "--force", "--quiet")
        return {"merge": done.seconds, "memory": done.peak_memory}


GROUPS = {"baffles": Baffles, "triangles": Triangles, "routes": Routes, "bodies": Bodies, "bins": Bins, "parts": Parts}
NAMES = {"setup": "setup", "per_history": "time per history", "noise": "noise stage", "merge": "merge", "memory": "memory"}


def turns_of(group, sizes, words):
    """{size: [what each turn found]}, sizes in turns; a size whose time is over keeps what it has."""
    found, spent = {n: [] for n in sizes}, dict.fromkeys(sizes, 0.0)
    for k in range(1 if words.quick else words.repeats):
        for n in sizes:
            if k >= 2 and spent[n] > ENOUGH or k >= 1 and spent[n] > TOO_LONG:
                continue
            start = time.monotonic()
            found[n].append(group.turn(n))
            spent[n] += time.monotonic() - start
    return found


def exponent(points):
    """(exponent, standard error) of a power of n by least squares through the logarithms; the error is what the scatter of the
    points about the line says, None for two."""
    x, y = [math.log(n) for n, _ in points], [math.log(value) for _, value in points]
    middle = statistics.fmean(x)
    square = sum((a - middle) ** 2 for a in x)
    slope = sum((a - middle) * b for a, b in zip(x, y)) / square
    offset = statistics.fmean(y) - slope * middle
    left = sum((b - offset - slope * a) ** 2 for a, b in zip(x, y))
    return slope, math.sqrt(left / (len(x) - 2) / square) if len(x) > 2 else None


def tell(results, name, group, made, found):
    """A line for every size, then one for everything that was fitted."""
    points = {}
    for n, turns in found.items():
        line = {}
        for quantity in turns[0]:
            values = [turn[quantity] for turn in turns]
            line[quantity] = statistics.median(values)
            line[f"{quantity}_unit"] = "B" if quantity == "memory" else "s"
            line[f"{quantity}_spread"] = spread(values) if line[quantity] > 0 else None
            points.setdefault(quantity, []).append((made[n], line[quantity]))
        results.add(f"{made[n]} {name}", kind="point", group=name, n=made[n], repeats=len(turns), **line)
    for quantity, each in points.items():
        if min(value for _, value in each) <= 0:         # below the noise of the clock
            continue
        slope, error = exponent(each)
        limit = group.limits.get(quantity)
        goal = {"goal": {"of": "exponent", "at_most": limit, "name": f"{NAMES[quantity]} against {name}: exponent"}} if limit else {}
        (first, low), (last, high) = each[0], each[-1]
        results.add(f"{NAMES[quantity]} against {name}", kind="fit", group=name, quantity=quantity, exponent=slope, error=error,
                    first=low, last=high, per_item=(high - low) / (last - first), n_first=first, n_last=last,
                    **dict.fromkeys(("first_unit", "last_unit", "per_item_unit"), "B" if quantity == "memory" else "s"), **goal)
    if name == "parts" and made:
        last = points["merge"][-1]
        results.add(f"merge of {last[0]} parts", kind="goal", group=name, ours=last[1], unit="s", goal={"of": "ours", "at_most": 60})


def main():
    parser = arguments(__doc__)
    parser.add_argument("--group", choices=GROUPS, action="append", help="this one alone; more than one may be named")
    words = parser.parse_args()
    words.program = words.program.resolve()
    with Results("growth", words, "group") as results:
        for name in words.group or GROUPS:
            with tempfile.TemporaryDirectory() as folder:
                group = GROUPS[name](words, pathlib.Path(folder))
                sizes = group.quick if words.quick else group.sizes
                made = {n: group.make(n) for n in sizes}
                tell(results, name, group, made, turns_of(group, sizes, words))


if __name__ == "__main__":
    main()
