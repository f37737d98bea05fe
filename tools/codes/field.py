"""The field of a driven cavity against numbers that the manual of OSCAR prints, of OSCAR and of FINESSE.

OSCAR itself needs Matlab. Where its grid is too coarse for its answer, a power iteration in numpy on the same grid shows it.
"""
import json
import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np

SCENE = """straytrace: 1
materials: {{polished: {{specular: {{reflect: {reflect}}}}}}}
bodies: {{optics: {{motion: still}}}}
scene:
  - {{name: I, use: mirror, radius: {radius} m, radius_of_curvature: {curvature} m, facing: [0, 0, 1], body: optics, material: polished}}
  - {{name: E, use: mirror, radius: {radius} m, radius_of_curvature: {curvature} m, at: [0 m, 0 m, {length} m], facing: [0, 0, -1], body: optics,
     material: polished}}
beams: {{arm: {{cavity: [I, E], wavelength: {wavelength} m}}}}
receivers: {{at_E: {{on: E}}}}
wave:
  beam: arm
  crossover: 200 urad
  maps: {{I: {{spectrum: none}}, E: {{spectrum: none}}}}
  mirrors: {{I: {{transmission: {t[0]}, loss: {l[0]}}}, E: {{transmission: {t[1]}, loss: {l[1]}}}}}
  input: {{radius: {w} m, wavefront_curvature: {wavefront} /m}}
"""
UNITS = {"loss per round trip": ("ppm", 1e6)}


def inside(d, cavity, index=None):
    """Curvature of the wavefront behind the input mirror, whose concave face is a diverging lens for light from outside."""
    return 1 / cavity["wavefront"] + ((index or d["index"]) - 1) / d["curvature"]


def ours(program, d, cavity, wavefront):
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "cavity.yaml"
        scene.write_text(SCENE.format(reflect=1 - cavity["transmission"][1], radius=cavity["diameter"] / 2, curvature=d["curvature"], length=d["length"],
                                      wavelength=d["wavelength"], t=cavity["transmission"], l=cavity["loss"], w=cavity["radius"], wavefront=wavefront),
                         encoding="utf-8")
        out = subprocess.run([program, "wave", str(scene), "--order", "0", "--detuning", "0", "--format", "json", "--quiet"], check=False, capture_output=True, text=True)
    if out.returncode:
        raise SystemExit(out.stdout + out.stderr)
    found = json.loads(out.stdout)
    at = found["driven"]["detunings"][0]
    return {"circulating power": at["circulating"], "transmitted power": at["transmitted"], "reflected power": at["reflected"], "loss per round trip": found["loss"]}


def grid_loss(d, cavity, points, window, trips=400):
    """Of the fundamental mode on a grid whose points are inside a mirror or not: power iteration with mirrors that reflect all light."""
    x = (np.arange(points) + 0.5) * window / points - window / 2
    r2 = x[:, None] ** 2 + x[None, :] ** 2
    k = 2 * np.pi / d["wavelength"]
    q = 2 * np.pi * np.fft.fftfreq(points, window / points)
    leg = np.exp(-0.5j * (q[:, None] ** 2 + q[None, :] ** 2) / k * d["length"])
    mirror = np.exp(-1j * k * r2 / d["curvature"]) * (r2 < (cavity["diameter"] / 2) ** 2)
    half, curvature = d["length"] / 2, d["curvature"]
    rayleigh = math.sqrt(half * (curvature - half))
    w2 = d["wavelength"] / np.pi * rayleigh * (1 + (half / rayleigh) ** 2)
    field = np.exp(-r2 / w2 - 0.5j * k * r2 / curvature)                     # the Gaussian mode, reflected
    for _ in range(trips):
        field /= math.sqrt((abs(field) ** 2).sum())
        for _ in range(2):
            field = np.fft.ifft2(np.fft.fft2(field) * leg) * mirror
    return 1 - float((abs(field) ** 2).sum())


def compare(found, cavity, allowed):
    return {key: abs(found[key] / value - 1) < allowed[key] for key, value in cavity["printed"].items()}


def run(program, d):
    """(lines of the page, function that draws, whether all agree, controls)."""
    lines = ["| cavity | number | straytrace | printed by OSCAR's manual | ratio − 1 | verdict |", "| --- | --- | --- | --- | --- | --- |"]
    fine, controls, ratios = True, {}, []
    for name, cavity in d["cavities"].items():
        found = ours(program, d, cavity, inside(d, cavity))
        good = compare(found, cavity, d["allowed"])
        for key, value in cavity["printed"].items():
            unit, scale = UNITS.get(key, ("W", 1))
            lines.append(f"| {name} | {key} | {found[key] * scale:.7g} {unit} | {value * scale:.7g} {unit} | {found[key] / value - 1:+.2e} | "
                         f"{'agrees' if good[key] else '**disagrees**'} |")
            ratios.append((f"{name}: {key}", found[key] / value))
        if not good.get("loss per round trip", True):
            points, window = cavity["grid"]
            coarse, fine_grid = grid_loss(d, cavity, points, window), grid_loss(d, cavity, 1024, 0.4, 40)
            known = abs(coarse / cavity["printed"]["loss per round trip"] - 1) < d["allowed"]["loss per round trip"]
            known = known and abs(fine_grid / found["loss per round trip"] - 1) < d["allowed"]["loss per round trip"]
            lines.append(f"| {name} | the same by numpy, {points} × {points} points in {window} m; 1024 × 1024 in 0.4 m | {found['loss per round trip'] * 1e6:.4g} ppm | "
                         f"{coarse * 1e6:.4g}; {fine_grid * 1e6:.4g} ppm | | {'explained by the grid' if known else '**not explained**'} |")
            good["loss per round trip"] = known
        fine = fine and all(good.values())
        controls[f"{name}: input mirror without the lens"] = not all(compare(ours(program, d, cavity, inside(d, cavity, 1.0)), cavity, d["allowed"]).values())
        changed = dict(cavity, transmission=[1.003 * t for t in cavity["transmission"]])
        power = {"printed": {"circulating power": cavity["printed"]["circulating power"]}}
        controls[f"{name}: transmissions 0.3 % larger"] = not all(compare(ours(program, d, changed, inside(d, cavity)), power, d["allowed"]).values())
    return lines, lambda axis: draw(axis, ratios), fine, controls


def draw(axis, ratios):
    axis.barh([name for name, _ in ratios], [100 * (ratio - 1) for _, ratio in ratios], color="#9dbfd9")
    axis.axvline(0, color="#444444", linewidth=0.8)
    axis.set_xlabel("straytrace / printed by OSCAR's manual − 1, %")
    axis.invert_yaxis()
