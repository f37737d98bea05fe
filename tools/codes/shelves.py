"""Shelves of a driven table, measured: edges and levels of five runs with stated motion (tests/published/inputs.json, h1_2010).

The table behind the dark port of Enhanced LIGO Hanford was driven; what scatters on it, and how that moves with the table, is not known. So the level
of one run gives the recoupled fraction, the edges give the effective motion, and the levels of the other runs are predicted.
"""
import csv
import json
import math
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy as np

FOLDER = Path(__file__).resolve().parents[2] / "tests/published"
INPUTS = json.loads((FOLDER / "inputs.json").read_text(encoding="utf-8"))
WAVELENGTH = INPUTS["wavelength"]["value"]
SHARE = 0.1                                              # of the highest bin: the edge is the end of the last one above it
LOOP = 45                                                # Hz: the gain of the loop was measured from 40 Hz, where quiet light is as strong
LENGTH = 1e3                                             # m; it cancels
SCENE = """straytrace: 1
materials: {{face: {{scatter: {{model: lambertian, brdf: 1e-8*3.141592653589793*(1 mm/{wavelength} m)^2*(1 /sr)}}}}}}
bodies: {{table: {{motion: {{x: {{sine: {{amplitude: {amplitude} m peak, frequency: {frequency} Hz}}}}, others: still}}}}}}
scene:
  - {{name: face, shape: {{disk: {{outer_radius: 5 mm}}}}, side: front, facing: [-1, 0, 0], body: table, material: face}}
beams: {{out: {{on: face, radius: 1 mm, travel: [1, 0, 0], wavelength: {wavelength} m}}}}
ports: {{port: {{beam: out, at: face}}}}
interferometer: {{preset: fabry-perot-michelson, arm_length: {length} m, mirror_mass: 1e9 kg, input_transmission: 1.4 %, arm_power: 1 W,
  ports: {{port: {{at: arm, copies: 1}}}}}}
trace: {{histories: 32768, seed: 1}}
noise: {{band: [40 Hz, 200 Hz], points_per_decade: 100}}
"""


def measured():
    """Edges of bins in Hz, and {run: relative power above the quiet spectrum in 1/Hz}."""
    with open(FOLDER / "h1_2010.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    edges = np.array([float(row["from_Hz"]) for row in rows] + [float(rows[-1]["to_Hz"])])
    return edges, {run: np.array([float(row[run] or "nan") for row in rows]) for run in INPUTS["h1_2010"]["runs"]}


def predicted(program, amplitude, frequency):
    """Relative power in 1/Hz per recoupled fraction: 2 Im s of the program's h = lambda/(4 pi L) Im s (eq. 9.1), static phases of every value."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "table.yaml"
        scene.write_text(SCENE.format(amplitude=amplitude, frequency=frequency, wavelength=WAVELENGTH, length=LENGTH), encoding="utf-8")
        subprocess.run([program, "run", scene, "-o", scene.with_suffix(".h5"), "--quiet"], check=True, capture_output=True)
        with h5py.File(scene.with_suffix(".h5")) as file:
            return (2 * file["noise/total/mean"][:] * 4 * math.pi * LENGTH / WAVELENGTH) ** 2 / file["classes/mean"][0]


def edge(edges, power):
    seen = np.where(edges[:-1] > LOOP, np.nan_to_num(power), 0)
    return edges[np.flatnonzero(seen > SHARE * seen.max())[-1] + 1]


def compare(program, runs=tuple(INPUTS["h1_2010"]["runs"])):
    """{run: edge, edge for the stated motion, their ratio, recoupled fraction from the level, bins, measured and predicted power}."""
    edges, powers = measured()
    found = {}
    for name in runs:
        run = INPUTS["h1_2010"]["runs"][name]
        stated = edge(edges, predicted(program, run["amplitude"], run["frequency"]))
        seen = edge(edges, powers[name])
        ratio = seen / stated
        ours = predicted(program, ratio * run["amplitude"], run["frequency"])
        band = np.isfinite(powers[name]) & (edges[:-1] > LOOP) & (edges[1:] < INPUTS["h1_2010"]["band"]["high_over_edge"] * seen)
        width = np.diff(edges)[band]
        fraction = (powers[name][band] * width).sum() / (ours[band] * width).sum() if band.sum() > 4 else math.nan
        found[name] = {"edge": seen, "stated": stated, "ratio": ratio, "fraction": fraction, "bins": int(band.sum()), "measured": powers[name],
                       "predicted": ours, "edges": edges}
    return found


def run(program, _):
    """(lines of the page, function that draws, whether all agree, controls)."""
    found, d = compare(program), INPUTS["h1_2010"]
    first = found[d["level_from"]]
    lines = ["| run | motion of the table | edge, measured | for that motion | effective over stated motion | $f_r$ from the level | amplitude, measured over predicted |",
             "| --- | --- | --- | --- | --- | --- | --- |"]
    for name, f in found.items():
        motion = d["runs"][name]
        level = math.sqrt(f["fraction"] / first["fraction"])
        told = "input" if f is first else "too few bins" if math.isnan(level) else f"{level:.2f}"
        lines.append(f"| {name} | {motion['amplitude'] * 1e6:.1f} µm at {motion['frequency']} Hz | {f['edge']:.0f} Hz | {f['stated']:.0f} Hz | {f['ratio']:.2f} | "
                     f"{'–' if math.isnan(f['fraction']) else format(f['fraction'], '.2e')} | {told} |")
    good, controls = verdicts(found)
    return lines, lambda axis: draw(axis, found), all(good.values()), controls


def verdicts(found):
    """What must hold within the limits of inputs.json, and controls: {what: whether it is rejected}."""
    d = INPUTS["h1_2010"]
    level, edges = d["level_tolerance"]["value"], d["edge_tolerance"]["value"]

    def apart(one, other, power):
        return found[one]["edge"] / found[other]["edge"] / (d["runs"][one]["amplitude"] / d["runs"][other]["amplitude"]) ** power - 1
    levels = {run: math.sqrt(found[run]["fraction"] / found[d["level_from"]]["fraction"]) for run in ("02", "06")}
    good = {f"level of run {run}": abs(value - 1) < level for run, value in levels.items()}
    good |= {f"edges of {one} and {other}": abs(apart(one, other, 1)) < edges for one, other in (("06", "05"), ("02", "03"))}
    linear = levels["06"] * d["runs"]["05"]["amplitude"] / d["runs"]["06"]["amplitude"] * math.sqrt(found["05"]["edge"] / found["06"]["edge"])
    controls = {"level of 06 from 05, linear in the motion": abs(linear - 1) > level, "edges independent of the motion": abs(apart("06", "05", 0)) > edges}
    return good, controls


def draw(axis, found):
    fraction = found[INPUTS["h1_2010"]["level_from"]]["fraction"]
    for i, (name, f) in enumerate((n, f) for n, f in found.items() if not math.isnan(f["fraction"]) and n != "04"):
        run = INPUTS["h1_2010"]["runs"][name]
        middle = np.sqrt(f["edges"][1:] * f["edges"][:-1])
        axis.loglog(middle, np.sqrt(f["measured"]), "o", color=f"C{i}", markersize=3.5, markerfacecolor="white",
                    label=f"run {name}, {run['amplitude'] * 1e6:.0f} µm at {run['frequency']} Hz")
        axis.loglog(middle, np.sqrt(f["predicted"] * fraction), color=f"C{i}", linewidth=1)
    axis.set_ylim(1e-8, 1e-5)
    axis.set_xlabel("Hz")
    axis.set_ylabel("relative power noise / √Hz⁻¹")
    axis.set_title("circles: Enhanced LIGO Hanford 2010; lines: straytrace, $f_r$ of run 05, effective motion of each run", fontsize=8)
    axis.legend(fontsize=7)
