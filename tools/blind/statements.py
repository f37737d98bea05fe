#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How often stated ranges hold, other than Monte-Carlo errors (docs/theory/blind.md): repetition with drawn truths.

band: inputs are drawn from their stated uncertainties. speckle: static phases are drawn. scatter, baffle: fits of data drawn about
a known truth. bounds: short runs with unresolved routes against a long one.

Examples:
  scripts/validation statements                         all, 200 trials each
  scripts/validation statements band speckle --trials 50
"""
import argparse
import concurrent.futures
import csv
import io
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from scipy import stats

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ONE, TWO = (2 * stats.norm.cdf(n) - 1 for n in (1, 2))
WEAK = {"power-law": {"asd": "1e-12 m/sqrt(Hz)", "at": "10 Hz", "exponent": -2, "from": "1 Hz", "to": "100 Hz"}}
SWING = {"line": {"at": "3 Hz", "width": "0.3 Hz", "rms": "1 um rms"}}
TONE = {"sine": {"amplitude": "3e-12 m peak", "frequency": "12 Hz"}}
VALUES = {"mirror": (1e-5, "/sr"), "ring": (0.01, "/sr"), "wall": (0.01, "/sr"), "swing": (1, "")}     # parameters of the arm


def along(motion, **more):
    return {"z": {**motion, **more}, "others": "still"}


def arm(ring, tube="still", known=None):
    """An arm with a ring and a tube, which move independently. `known` adds to the materials how well each BRDF is known."""
    def material(name, **more):
        return {"scatter": {"model": "lambertian", "brdf": name}, **more, **(known or {}).get(name, {})}
    mirror = {"use": "mirror", "radius": "0.125 m", "radius_of_curvature": "256 m", "body": "mirrors", "material": "hr"}
    return json.dumps({
        "straytrace": 1, "params": {name: f"{value!r} {unit}".strip() if unit else value for name, (value, unit) in VALUES.items()},
        "materials": {"hr": material("mirror", specular={"reflect": 0.99}), "steel": material("ring"), "rust": material("wall")},
        "bodies": {"mirrors": {"motion": "still"}, "ring": {"motion": ring}, "tube": {"motion": tube}},
        "scene": [{"name": "A", "at": ["0 m"] * 3, "facing": [0, 0, 1], **mirror}, {"name": "B", "at": ["0 m", "0 m", "192 m"], "facing": [0, 0, -1], **mirror},
                  {"name": "ring", "shape": {"disk": {"inner_radius": "0.3 m", "outer_radius": "0.5 m"}}, "at": ["0 m", "0 m", "96 m"],
                   "facing": [0, 0, -1], "body": "ring", "material": "steel"},
                  {"name": "tube", "shape": {"cylinder": {"radius": "0.4 m", "from": "10 m", "to": "90 m"}}, "side": "inner", "body": "tube", "material": "rust"}],
        "beams": {"arm": {"cavity": ["A", "B"], "power": "1 kW"}}, "ports": {m: {"beam": "arm", "at": m} for m in "AB"}, "ghosts": "off",
        "interferometer": {"preset": "fabry-perot-michelson", "arm_length": "192 m", "arms": 1, "mirror_mass": "10 kg", "input_transmission": 0.014},
        "noise": {"band": ["5 Hz", "50 Hz"], "points_per_decade": 4}})


class Trials:
    """Runs of one program in one folder, `jobs` at a time."""
    def __init__(self, program, folder, count, jobs):
        self.program, self.folder, self.count, self.jobs = program, pathlib.Path(folder), count, jobs

    def each(self, trial, count=None):
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            return np.array(list(pool.map(trial, range(count or self.count))))

    def call(self, *words):
        done = subprocess.run([str(w) for w in (self.program, *words)], capture_output=True, text=True, timeout=600, cwd=self.folder)
        if done.returncode:
            raise RuntimeError(f"{' '.join(map(str, words[:3]))}: {done.stderr.strip()[-600:]}")
        return done.stdout

    def run(self, scene, name, *words, histories=4096, seed=1):
        """The group `noise` of a run, of the keys that are used here."""
        if isinstance(scene, str):
            scene, text = self.folder / f"{name}.yaml", scene
            scene.write_text(text, encoding="utf-8")
        self.call("run", scene, "-o", f"{name}.h5", "--histories", histories, "--seed", seed, "--threads", 1, "--force", "--quiet", *words)
        with h5py.File(self.folder / f"{name}.h5") as found:
            group = found["noise"]
            return {key: group[key][:] for key in ("frequency_edges", "total/mean", "total/sigma", "bands/input_low", "bands/input_high",
                                                   "bands/speckle_05", "bands/speckle_95", "unresolved")}


def at(found, hz):
    return int(np.searchsorted(found["frequency_edges"], hz) - 1)


def band(trials):
    """Each input is drawn log-normal with its stated standard deviation, or evenly in the logarithm of its bracket; the scene is traced anew."""
    spread = {"mirror": ({"uncertainty": "30 %"}, 1.3), "ring": ({"uncertainty": "factor 1.5"}, 1.5), "wall": ({"uncertainty": "factor 2"}, 2.0), "swing": (None, 1.4)}
    bracket = {"mirror": (7e-6, 2e-5), "ring": (5e-3, 2e-2), "wall": (0.005, 0.015)}
    uncertain = {name: more for name, (more, _) in spread.items()}
    bracketed = {name: {"bracket": [f"{low} /sr", f"{VALUES[name][0]} /sr", f"{high} /sr"]} for name, (low, high) in bracket.items()}
    swung = {"scale": "swing", "uncertainty": "40 %"}
    for what, scene, names in (("weak motion", arm(along(WEAK, **swung), along(WEAK), uncertain), spread),
                               ("wrapped fringes", arm(along(SWING, **swung), along(WEAK), uncertain), spread), ("brackets", arm(along(WEAK), along(WEAK), bracketed), bracket)):
        stated = trials.run(scene, "band")
        i = at(stated, 12)

        def drawn(trial, scene=scene, names=names, i=i):
            rng, words = np.random.default_rng([17, trial]), []
            for name in names:
                factor = rng.normal(0, np.log(spread[name][1])) if names is spread else rng.uniform(*np.log(bracket[name])) - np.log(VALUES[name][0])
                value, unit = VALUES[name]
                words += ["-p", f"{name}={value * float(np.exp(factor)):.9g} {unit}".strip()]
            return trials.run(scene, f"band{trial}", *words)["total/mean"][i]
        change, low, high = (np.log(h / stated["total/mean"][i]) for h in (trials.each(drawn), stated["bands/input_low"][i], stated["bands/input_high"][i]))
        sure = names is bracket
        yield f"input band, {what}", "h within the band", 1 if sure else ONE, (low - 1e-6 < change) & (change < high + 1e-6), sure
        if not sure:
            yield f"input band, {what}", "ln h within twice the band", TWO, (2 * low < change) & (change < 2 * high), False


def speckle(trials):
    """Static phases and motion are drawn by `project`, in time; a tone has the same power in each draw, a spectrum hundreds of lines in the bin."""
    for what, scene, seconds, bound in (("a tone", arm(along(TONE)), 8, False), ("one body", arm(along(WEAK)), 64, False),
                                        ("two bodies", arm(along(WEAK), along(WEAK)), 64, False), ("wrapped fringes", arm(along(SWING)), 256, True)):
        found = trials.run(scene, "speckle")
        i = at(found, 12)
        low, high = found["frequency_edges"][i:i + 2]

        def drawn(trial, seconds=seconds, low=low, high=high):
            name = f"speckle{trial}.hdf5"
            trials.call("project", "speckle.h5", "--seed", trial + 1, "--duration", f"{seconds} s", "-o", name, "--threads", 1, "--quiet")
            with h5py.File(trials.folder / name) as file:
                h = file["h"][:]
            f, psd = np.fft.rfftfreq(len(h), seconds / len(h)), 2 * abs(np.fft.rfft(h))**2 * seconds / len(h)**2
            return np.sqrt(psd[(f >= low) & (f < high)].sum() / seconds / (high - low))
        h = trials.each(drawn)
        yield f"speckle, {what}", "h from `speckle_05` to `speckle_95`", 0.9, (found["bands/speckle_05"][i] < h) & (h < found["bands/speckle_95"][i]), bound


def abg(angles, incidence, a, b, g):
    return a / (b + abs(np.sin(np.radians(angles)) - np.sin(np.radians(incidence)))**g)


def scatter(trials):
    """BSDF of an ABg surface at three incidences, with 5 % of noise that is stated."""
    truth = {"a": 1.5e-3, "b": 0.01, "g": 1.5}
    angles = np.concatenate([5 + 10**np.linspace(-0.3, 1.8, 25)])

    def drawn(trial):
        rng, file = np.random.default_rng([23, trial]), trials.folder / f"scan{trial}.csv"
        lines = ["# wavelength: 1064 nm", "# angles: from_normal", "# polarisation_in: unpolarised", "# polarisation_out: both", "# noise_floor: none",
                 "theta_i [deg], theta_s [deg], brdf [1/sr], error [1/sr]"]
        for angle, brdf in zip(angles, abg(angles, 5, **truth)):
            lines.append(f"5, {angle:.6f}, {brdf * (1 + 0.05 * rng.standard_normal()):.8g}, {0.05 * brdf:.8g}")
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
        fit = next(f for f in json.loads(trials.call("inspect", file.name, "--format", "json"))["fits"] if f["model"] == "abg")
        return [(p["value"] - truth[p["name"]]) / p["error"] for p in fit["parameters"]]
    pulls = trials.each(drawn)
    for name, values in zip(truth, pulls.T):
        for limit, due in ((1, ONE), (2, TWO)):
            yield f"fit of scatter, {name}", f"truth within {limit}σ", due, abs(values) < limit, False


def baffle(trials):
    """Photodiodes of examples/instrumented_baffle.yaml on a baffle that is displaced, behind mirrors of other heights, with 1 % of noise."""
    scene, truth = SOURCE / "examples/instrumented_baffle.yaml", {"shift_x": 0.4, "shift_y": -0.2}

    def drawn(trial):
        rng, name = np.random.default_rng([29, trial]), f"watts{trial}.csv"
        words = [w for k, v in truth.items() for w in ("-p", f"{k}={v} mm")] + ["-p", f"draw_I={2 * trial + 101}", "-p", f"draw_E={2 * trial + 102}"]
        trials.call("wave", scene, "--csv", name, "--quiet", *words)
        rows = list(csv.DictReader(io.StringIO((trials.folder / name).read_text(encoding="utf-8"))))
        lines = ["photodiode, power [W], error [W]"]
        for row in rows:
            power = float(row["power [W]"])
            error = 0.01 * power + 1e-9
            lines.append(f"{row['photodiode']}, {rng.normal(power, error):.6g}, {error:.3g}")
        (trials.folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
        free = [w for k in truth for w in ("--free", f"{k}=-2..2 mm")]
        fit = json.loads(trials.call("fit", "baffle", scene, "--measured", name, *free, "--quiet", "--threads", 1, "--format", "json"))
        return [(p["value"] - truth[p["name"]]) / p["sigma"] for p in fit["parameters"]]
    pulls = trials.each(drawn, max(10, trials.count // 5))
    for limit, due in ((1, ONE), (2, TWO)):
        for name, values in zip(truth, pulls.T):
            yield f"fit of a baffle, {name}", f"truth within {limit}σ", due, abs(values) < limit, False


def bounds(trials):
    """Totals of short runs of the Virgo example, with whatever is unresolved in them, against a run of 262144 histories."""
    scene = SOURCE / "examples/virgo_arm.yaml"
    truth = trials.run(scene, "truth", histories=1 << 18)
    i = at(truth, 30)
    for histories in (2048, 8192, 32768):
        found = [trials.run(scene, f"short{s}", histories=histories, seed=100 + s) for s in range(max(20, trials.count // 2))]
        pulls = np.array([(f["total/mean"][i] - truth["total/mean"][i]) / np.hypot(f["total/sigma"][i], truth["total/sigma"][i]) for f in found])
        lower = np.array([len(f["unresolved"]) > 0 for f in found])
        for what, of, rows in (("lower bound", "truth above h − 2σ", pulls[lower] < 2), ("total", "truth within 2σ", abs(pulls[~lower]) < 2)):
            if len(rows):
                yield f"{what}, {histories} histories", of, stats.norm.cdf(2) if what == "lower bound" else TWO, rows, what == "lower bound"


CASES = {f.__name__: f for f in (band, speckle, scatter, baffle, bounds)}


def judged(stated, inside, bound):
    """(share, its binomial error, whether so few or so many are likelier than 0.27 %, three standard errors)."""
    n = len(inside)
    error = np.sqrt(max(stated * (1 - stated), 1 / (4 * n)) / n)
    return np.mean(inside), error, stats.binomtest(int(np.sum(inside)), n, stated, "less" if bound else "two-sided").pvalue > 0.0027


def main():
    parser = argparse.ArgumentParser(prog="scripts/validation statements", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="case", choices=[[], *CASES], help=f"{', '.join(CASES)}; default: all")
    parser.add_argument("--program", default=str(SOURCE / "build/straytrace"))
    parser.add_argument("--trials", type=int, default=200, help="of each case (a fifth for baffle, a half for bounds); default: 200")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time; default: 2")
    parser.add_argument("--write", action="store_true", help="put the table into docs/theory/blind.md")
    asked = parser.parse_args()
    lines = ["| statement | of what | stated | found | trials | verdict |", "| --- | --- | --- | --- | --- | --- |"]
    good = True
    for case in asked.cases or CASES:
        with tempfile.TemporaryDirectory() as folder:
            for name, of, stated, inside, bound in CASES[case](Trials(asked.program, folder, asked.trials, asked.jobs)):
                share, error, fine = judged(stated, inside, bound)
                good &= bool(fine)
                lines.append(f"| {name} | {of} | {'at least ' * bound}{100 * stated:.3g} % | {100 * share:.1f} ± {100 * error:.1f} % | {len(inside)} | "
                             f"{'holds' if fine else '**does not hold**'} |")
                print(lines[-1], flush=True)
    if asked.write:
        from page import replace
        replace("statements", [f"`scripts/validation statements --trials {asked.trials}`:", "", *lines])
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
