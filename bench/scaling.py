#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""One trace by 1, 2, 4 ... threads, MPI ranks and a GPU, in turns; what a checkpoint and a single MPI rank cost.

Times are wall-clock times, the difference of a long and a short trace, so that they exclude setup: with other programs running
they say nothing about straytrace. The efficiency of n is T(1)/(n T(n)). That of n programs, each of which traces all histories in
one thread, is T(1)/T(n): what the machine gives to work that has nothing in common. Ranks trace four times the histories:
at the end of a job, rank 0 alone writes the run file.

Examples:
  scripts/bench scaling --keep      as many threads and ranks as there are cores; for the page
  scripts/bench scaling --quick     a few blocks: does it run?
"""
import concurrent.futures
import os
import pathlib
import statistics
import tempfile

from record import QUIET, SOURCE, Results, arguments, child, compared, in_turns, spread

BLOCK = 4096
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--bind-to", "none"]
IN_A_BOX = dict(QUIET, OMPI_MCA_btl_vader_single_copy_mechanism="none")   # containers forbid reading other processes
SCENE, SMALL = SOURCE / "examples/virgo_arm.yaml", SOURCE / "examples/arm_tube.yaml"


class Traces:
    def __init__(self, words, folder):
        self.words, self.run_file = words, pathlib.Path(folder) / "run.h5"
        self.scene = SMALL if words.quick else SCENE
        self.short, self.long, self.longest = (2, 8, 8) if words.quick else (16, 528, 2064)    # blocks

    def trace(self, blocks, *more, before=(), cores=None, env=None):
        self.run_file.unlink(missing_ok=True)
        return child([*before, self.words.program, "trace", self.scene, "-o", self.run_file, "--quiet", "--histories", blocks * BLOCK, *more],
                     core=cores, env=env)

    def beyond_setup(self, *more, blocks=None, **where):
        """(seconds by the clock, what the longer trace took)."""
        short, long = self.trace(self.short, *more, **where), self.trace(blocks or self.long, *more, **where)
        return long.seconds - short.seconds, long

    def histories(self, blocks):
        return (blocks - self.short) * BLOCK

    def threads(self, count, blocks=None):
        return self.beyond_setup("--threads", count, cores=first_cores(count), blocks=blocks)

    def programs(self, count):
        """Each does all the work: the time of one share."""
        cores = sorted(os.sched_getaffinity(0))[:count]
        def one(core):
            folder = self.run_file.parent / f"core{core}"
            folder.mkdir(exist_ok=True)
            return Traces(self.words, folder).beyond_setup("--threads", 1, cores=core)
        with concurrent.futures.ThreadPoolExecutor(count) as pool:
            done = list(pool.map(one, cores))
        return max(seconds for seconds, _ in done) / count, done[0][1]

    def ranks(self, count):
        return self.beyond_setup("--backend", "mpi", "--threads", 1, before=[*MPIRUN, "-n", count], cores=first_cores(count),
                                 env=IN_A_BOX, blocks=self.longest)


def first_cores(count):
    return ",".join(map(str, sorted(os.sched_getaffinity(0))[:count]))


def counts():
    """1, 2, 4 ... and all the cores."""
    cores = len(os.sched_getaffinity(0))
    return sorted({1, cores, *(2 ** k for k in range(10) if 2 ** k <= cores)})


def scaled(results, kind, way, repeats, histories):
    """A line for each number of threads, programs or ranks, with its efficiency relative to one."""
    taken = in_turns({n: (lambda n=n: way(n)) for n in counts()}, repeats)
    one = [seconds for seconds, _ in taken[1]]
    for n, turns in taken.items():
        seconds = [s for s, _ in turns]
        efficiency = [a / (n * b) for a, b in zip(one, seconds)]
        wanted = n > 1 and kind != "programs"
        goal = {"goal": {"of": "efficiency", "at_least": 0.95, "name": f"efficiency of {n} {kind}"}} if wanted else {}
        results.add(f"{n} {kind}" if n > 1 else f"1 {kind[:-1]}", kind=kind, n=n, ours=statistics.median(seconds), unit="s",
                    rate=histories / statistics.median(seconds), rate_unit="1/s", efficiency=statistics.median(efficiency),
                    spread=spread(efficiency if n > 1 else seconds), repeats=repeats,
                    peak_memory=max(done.peak_memory for _, done in turns), **goal)


def one_rank(results, traces, repeats):
    taken = in_turns({"mpi": lambda: traces.ranks(1), "plain": lambda: traces.threads(1, traces.longest)}, repeats)
    results.add("1 rank, compared with no MPI", kind="overhead", unit="s",
                **compared(*([seconds for seconds, _ in taken[way]] for way in ("mpi", "plain"))),
                peak_memory=max(done.peak_memory for _, done in taken["mpi"]),
                theirs_peak_memory=max(done.peak_memory for _, done in taken["plain"]))


def checkpoints(results, traces, repeats):
    """Processor time with many checkpoints compared with none; and one as a share of the 20 minutes between two."""
    interval = 0.05 if traces.words.quick else 0.25         # s
    def way(rule):
        return lambda: traces.trace(traces.long, "--threads", 1, "--checkpoint", rule, cores=first_cores(1))
    taken = in_turns({"with": way(f"{interval}s"), "without": way("off")}, repeats)
    each = [(a.cpu - b.cpu) / max(1, a.seconds // interval) for a, b in zip(taken["with"], taken["without"])]
    results.add("one checkpoint, processor time", kind="checkpoint", ours=statistics.median(each), unit="s", repeats=repeats,
                least=min(each), least_unit="s", most=max(each), most_unit="s", file_memory=traces.run_file.stat().st_size,
                share_of_20_min=statistics.median(each) / 1200,
                goal={"of": "share_of_20_min", "at_most": 1e-3, "name": "a checkpoint, as a share of the 20 min between two"})


def gpu(results, traces, repeats):
    version = child([traces.words.program, "--version"]).output
    device = next((line[6:] for line in version.splitlines() if line.startswith("cuda: ")), "not built")
    if device in ("not built", "built; no device here"):
        results.add("GPU", kind="gpu", skipped=f"skipped: no GPU ({device})")
        return
    taken = in_turns({"gpu": lambda: traces.beyond_setup("--backend", "cuda"), "core": lambda: traces.threads(1)}, repeats)
    results.add("GPU, compared with one thread", kind="gpu", device=device, unit="s",
                **compared(*([seconds for seconds, _ in taken[way]] for way in ("gpu", "core"))),
                peak_memory=max(done.peak_memory for _, done in taken["gpu"]),
                goal={"of": "ratio", "at_least": 300, "name": "GPU, cores of this kind"})


def main():
    words = arguments(__doc__).parse_args()
    words.program = words.program.resolve()
    repeats = 1 if words.quick else words.repeats
    with tempfile.TemporaryDirectory() as folder, Results("scaling", words) as results:
        traces = Traces(words, folder)
        scaled(results, "threads", traces.threads, repeats, traces.histories(traces.long))
        scaled(results, "programs", traces.programs, repeats, traces.histories(traces.long))
        scaled(results, "ranks", traces.ranks, repeats, traces.histories(traces.longest))
        one_rank(results, traces, repeats)
        checkpoints(results, traces, repeats)
        gpu(results, traces, repeats)


if __name__ == "__main__":
    main()
