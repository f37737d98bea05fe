#!/usr/bin/env python3
"""How often printed Monte-Carlo errors hold (docs/theory/blind.md): runs of many seeds against their mean.

Each scene is run with several seeds. An error of one standard deviation should hold in 68.3 % of the runs, two in 95.4 %
(67.5 % and 94.6 % for an error that comes from 32 blocks).

Examples:
  scripts/validation coverage                            20 seeds of the examples in use
  scripts/validation coverage --write                    every night: the table of the page
  scripts/validation coverage examples/short_arm.yaml --seeds 40
"""
import argparse
import concurrent.futures
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from scipy import stats

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENES = ("short_arm", "new_arm", "arm_tube", "virgo_arm", "kagra_arm", "et_hf_arm", "pipe", "end_bench", "two_mirrors", "bench")
BINS = 4          # of the curve of h
LARGEST = 0.2     # relative error of a number that is tested: beyond, sums of few paths are not Gaussian


def numbers(program, scene, seed, histories):
    """{number: (value, error)} of a run: h in a few bins, couplings of resolved routes, and power on receivers, by routes and whole."""
    with tempfile.TemporaryDirectory() as folder:
        result = pathlib.Path(folder) / "run.h5"
        command = [program, "run", str(scene), "-o", str(result), "--quiet", "--threads", "1", "--histories", str(histories), "--seed", str(seed)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=900)
        if done.returncode:
            raise RuntimeError(f"{scene}: {done.stderr.strip()[:1000]}")
        found = {}
        with h5py.File(result) as file:
            for of, table in (("coupling", file["classes"]), ("power", file["received"])):
                for key, name, mean, error, good, reverse, kind in zip(*(table[k][:] for k in (
                        "hash", "name", "mean", "std_error", "trusted", "by_reverse", "kind"))):
                    if good and not reverse and not kind and not name.startswith(b"other"):
                        found[of, int(key)] = mean, error
            for key, mean, error, good in zip(file["names/receivers"][:], *(file["receivers"][k][:] for k in ("mean", "std_error", "trusted"))):
                if good:
                    found["power", key] = mean, error
            if "noise" in file and not len(file["noise/unresolved"]):
                h, sigma = file["noise/total/mean"][:], file["noise/total/sigma"][:]
                for i in np.linspace(0, len(h) - 1, BINS + 2).astype(int)[1:-1]:
                    found["h", int(i)] = h[i], sigma[i]
        return found


def pulls_of(runs, kind, least):
    """Deviations from the mean of the seeds, in printed errors, of numbers that are there for `least` seeds."""
    keys = {key for run in runs for key in run if key[0] == kind}
    found = []
    for key in sorted(keys, key=str):
        values = np.array([run[key] for run in runs if key in run])
        if len(values) < least:
            continue
        mean = values[:, 0].mean()
        if np.ptp(values[:, 0]) <= 1e-9 * abs(mean):       # exact: no error to judge
            continue
        if np.median(values[:, 1]) > LARGEST * mean:
            continue
        with np.errstate(divide="ignore"):                  # an error of 0 does not hold
            found.append((values[:, 0] - mean) / values[:, 1] * np.sqrt(len(values) / (len(values) - 1)))
    return found


DUE = [2 * stats.t.cdf(limit, 31) - 1 for limit in (1, 2)]   # shares within one and two errors from 32 blocks


def covered(pulls):
    """Shares within one and two errors, and their standard errors. Numbers of one run are taken as dependent: seeds count.

    The error is at least that of as many independent numbers with the share that is due: a share of 100 % does not scatter,
    but is not exact.
    """
    inside = [[np.mean([(abs(row[s]) < limit) for row in pulls if s < len(row)]) for s in range(max(map(len, pulls)))] for limit in (1, 2)]
    count = sum(map(len, pulls))
    return [(np.mean(share), max(np.std(share, ddof=1) / np.sqrt(len(share)), np.sqrt(due * (1 - due) / count)))
            for share, due in zip(inside, DUE)]


def agrees(shares):
    """Within three standard errors of what 32 blocks give; at least 3 % is allowed."""
    return all(abs(share - due) < max(3 * error, 0.03) for (share, error), due in zip(shares, DUE))


def task(job):
    try:
        return numbers(*job)
    except (RuntimeError, subprocess.TimeoutExpired) as failure:
        return failure


def measure(asked):
    scenes = [pathlib.Path(s) for s in asked.scenes] or [SOURCE / f"examples/{name}.yaml" for name in SCENES]
    with concurrent.futures.ProcessPoolExecutor(asked.jobs) as pool:
        for scene in scenes:
            runs = list(pool.map(task, [(asked.program, scene, 1000 + s, asked.histories) for s in range(asked.seeds)]))
            failures = [r for r in runs if isinstance(r, Exception)]
            if failures:
                yield scene.stem, "failed", str(failures[0])
                continue
            for kind in ("h", "coupling", "power"):
                pulls = pulls_of(runs, kind, asked.seeds)
                if pulls:
                    shares = covered(pulls)
                    yield scene.stem, kind, (len(pulls), shares, agrees(shares))


def main():
    parser = argparse.ArgumentParser(prog="scripts/validation coverage", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", help="scenes; default: ten examples")
    parser.add_argument("--program", default=str(SOURCE / "build/straytrace"))
    parser.add_argument("--seeds", type=int, default=20, help="runs of each scene; default: 20")
    parser.add_argument("--histories", type=int, default=131072, help="of each run; default: 131072")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time; default: 2")
    parser.add_argument("--write", action="store_true", help="put the table into docs/theory/blind.md")
    asked = parser.parse_args()
    lines = ["| scene | numbers | below 1σ (67.5 %) | below 2σ (94.6 %) | verdict |", "| --- | --- | --- | --- | --- |"]
    good = True
    for scene, kind, found in measure(asked):
        if kind == "failed":
            good = False
            print(f"{scene}: {found}", file=sys.stderr)
            continue
        count, ((one, one_error), (two, two_error)), fine = found
        good &= fine
        of = {"h": f"h in {count} bin{'s' if count > 1 else ''}", "coupling": f"{count} couplings", "power": f"{count} power{'s' if count > 1 else ''} on receivers"}[kind]
        lines.append(f"| {scene} | {of} | {100 * one:.1f} ± {100 * one_error:.1f} % | {100 * two:.1f} ± {100 * two_error:.1f} % | {'holds' if fine else '**does not hold**'} |")
        print(lines[-1], flush=True)
    if asked.write:
        from page import replace
        replace("coverage", [f"`scripts/validation coverage --seeds {asked.seeds}`, {asked.histories} histories each:", "", *lines])
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
