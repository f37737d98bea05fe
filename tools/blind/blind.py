#!/usr/bin/env python3
"""Compare the program with an independent oracle on random scenes (docs/theory/blind.md).

Each scene has a cavity in an arbitrary frame, mirrors and objects of random shapes, surfaces and motion. The oracle of
this folder computes couplings, phase sensitivities and h of its routes from the equations of docs/theory, without code of
the program. Differences over their errors (pulls) must follow the normal distribution.

Examples:
  scripts/validation blind                         20 scenes
  scripts/validation blind --scenes 1000 --write   every night: the page and its picture
"""
import argparse
import concurrent.futures
import json
import pathlib
import sys

import numpy as np
from scipy import stats

from compare import HISTORIES, compare
from oracle import CONTROLS

KINDS = ("coupling", "levers", "strain")
SOURCE = pathlib.Path(__file__).resolve().parents[2]
REJECTED = 1e-3      # p value


def task(job):
    try:
        return compare(*job)
    except RuntimeError as failure:
        return failure


def one_a_scene(pulls, seed=7):
    """One pull of each scene, drawn at random: they are independent."""
    rng, scenes = np.random.default_rng(seed), {}
    for p in pulls:
        scenes.setdefault(p["scene"], []).append(p["pull"])
    return np.array([rng.choice(values) for values in scenes.values()])


def verdict(pulls):
    """Numbers of one kind: of all pulls, and the tests of one of each scene."""
    values, single = np.array([p["pull"] for p in pulls]), one_a_scene(pulls)
    result = {"pulls": len(values), "scenes": len(single), "mean": values.mean(), "deviation": values.std(), "1 sigma": np.mean(abs(values) < 1),
              "2 sigma": np.mean(abs(values) < 2), "largest": values[np.argmax(abs(values))]}
    result["Kolmogorov-Smirnov"] = stats.kstest(single, "norm").pvalue
    bins = max(2, min(20, len(single) // 10))
    counts = np.histogram(stats.norm.cdf(single), np.linspace(0, 1, bins + 1))[0]
    result["chi^2"] = stats.chisquare(counts).pvalue
    result["sum of squares"] = float(np.clip(2 * min(stats.chi2.sf((single**2).sum(), len(single)),
                                                     stats.chi2.cdf((single**2).sum(), len(single))), 0, 1))
    result["agree"] = min(result[t] for t in ("Kolmogorov-Smirnov", "chi^2", "sum of squares")) > REJECTED
    return {k: v if isinstance(v, (int, bool)) else float(v) if not isinstance(v, np.bool_) else bool(v) for k, v in result.items()}


def run_all(asked, progress=print):
    """Pulls by control, failures, and how many routes were left out."""
    jobs = [(asked.program, asked.seed + i, asked.histories, CONTROLS if i < asked.controls else ()) for i in range(asked.scenes)]
    pulls, failures, left_out = {control: [] for control in (None, *CONTROLS)}, [], 0
    with concurrent.futures.ProcessPoolExecutor(asked.jobs) as pool:
        for i, result in enumerate(pool.map(task, jobs), 1):
            if isinstance(result, Exception):
                failures.append(str(result))
                continue
            for control, found in result[0].items():
                pulls[control] += found
            left_out += result[1]
            if i % 10 == 0:
                progress(f"{i} of {asked.scenes} scenes", file=sys.stderr, flush=True)
    return pulls, failures, left_out


def summary(pulls, failures, left_out):
    kinds = {k: verdict([p for p in pulls[None] if p["kind"] == k]) for k in KINDS if any(p["kind"] == k for p in pulls[None])}
    controls = {}
    for control in CONTROLS:
        found = [p for p in pulls[control] if p["kind"] == ("levers" if control == "lever" else "coupling")]
        if found:
            controls[control] = {"pulls": len(found), "sum of squares": float(sum(p["pull"]**2 for p in found)),
                                 "rejected": bool(stats.chi2.sf(sum(p["pull"]**2 for p in found), len(found)) < 1e-9)}
    worst = sorted(pulls[None], key=lambda p: -abs(p["pull"]))[:5]
    return {"kinds": kinds, "controls": controls, "left_out": left_out, "failures": failures, "worst": worst}


def printed(result):
    yield f"{'':10s}{'pulls':>7s}{'mean':>8s}{'sd':>7s}{'<1σ':>8s}{'<2σ':>8s}{'largest':>9s}   p: KS, chi^2, sum of squares"
    for kind, v in result["kinds"].items():
        yield (f"{kind:10s}{v['pulls']:7d}{v['mean']:8.3f}{v['deviation']:7.3f}{v['1 sigma']:8.1%}{v['2 sigma']:8.1%}{v['largest']:9.2f}   "
               f"{v['Kolmogorov-Smirnov']:.3g}, {v['chi^2']:.3g}, {v['sum of squares']:.3g}  {'agrees' if v['agree'] else 'DISAGREES'}")
    for control, v in result["controls"].items():
        yield f"control, {control}: {v['pulls']} pulls, sum of squares {v['sum of squares']:.3g}: {'rejected' if v['rejected'] else 'NOT REJECTED'}"
    yield f"{result['left_out']} routes left out: the oracle does not resolve them"
    yield "largest pulls: " + "; ".join(f"{p['pull']:.2f} {p['kind']} scene {p['scene']} {p['route']}" for p in result["worst"])
    yield from (f"failed: {f}" for f in result["failures"])


def main():
    parser = argparse.ArgumentParser(prog="scripts/validation blind", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(SOURCE / "build/straytrace"))
    parser.add_argument("--scenes", type=int, default=20, help="number of scenes; default: 20")
    parser.add_argument("--seed", type=int, default=0, help="of the first scene; default: 0")
    parser.add_argument("--histories", type=int, default=HISTORIES, help=f"of each run; default: {HISTORIES}")
    parser.add_argument("--controls", type=int, default=5, help="scenes that are compared with wrong oracles too; default: 5")
    parser.add_argument("--jobs", type=int, default=2, help="scenes at a time; default: 2")
    parser.add_argument("--json", type=pathlib.Path, help="file for all pulls")
    parser.add_argument("--write", action="store_true", help="put the numbers and the picture into docs/theory/blind.md")
    asked = parser.parse_args()
    pulls, failures, left_out = run_all(asked)
    result = summary(pulls, failures, left_out)
    print("\n".join(printed(result)))
    if asked.json:
        asked.json.write_text(json.dumps(result | {"pulls": pulls[None]}, indent=1) + "\n", encoding="utf-8")
    if asked.write:
        from page import write_blind
        write_blind(pulls[None], result, asked)
    good = all(v["agree"] for v in result["kinds"].values()) and all(v["rejected"] for v in result["controls"].values())
    return 0 if good and not failures else 1


if __name__ == "__main__":
    sys.exit(main())
