#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Profiles of `straytrace apertures` against scipy: a Hankel transform by quadrature, and a two-dimensional FFT.
Usage: test_diffraction.py PROGRAM (R2.27, docs/theory/diffraction.md, eq. 5.7)"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.fft import fft2, ifft2
from scipy.integrate import quad
from scipy.special import j0

from records import Records

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
RECORDS = Records("tools.diffraction", PROGRAM)
LAMBDA, W, RADIUS = 1064e-9, 10e-3, 12e-3
K = 2 * np.pi / LAMBDA

SCENE = """straytrace: 1
params: {{shift: {shift} mm}}
materials: {{black: {{}}}}
bodies: {{bench: {{motion: still}}}}
scene:
  - {{name: stop, {shape}, at: [shift, 0 m, 1 m], facing: [0, 0, 1], body: bench, material: black}}
  - {{name: screen, shape: {{disk: {{outer_radius: 50 cm}}}}, at: [0 m, 0 m, 200 m], facing: [0, 0, -1], body: bench, material: black}}
beams: {{laser: {{from: [0 m, 0 m, 0 m], facing: [0, 0, 1], waist: {{radius: 10 mm, ahead: 1 m}}}}}}
receivers: {{screen: {{on: screen}}}}
"""
HARD = "shape: {disk: {inner_radius: 12 mm, outer_radius: 10 cm}}"
TEETH = "shape: {serrated_cone: {inner_radius: 10 mm, outer_radius: 10 cm, half_angle: 90 deg, tooth_depth: 4 mm, " \
        "teeth: 400}}"


def profile(shape, distance, points, shift=0):
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "scene.yaml"
        scene.write_text(SCENE.format(shape=shape, shift=shift))
        out = subprocess.run([PROGRAM, "apertures", scene, "--profile", "stop", "--distance", f"{distance} m", "--points",
                              str(points), "--format", "json", "--quiet"], check=True, text=True, stdout=subprocess.PIPE)
    return json.loads(out.stdout)


def hankel(rho, z, open_share, reach):
    """|field| of the waist behind a round opening of which `open_share(r)` of each circle is open."""
    def integrand(r):
        return r * open_share(r) * np.exp(-(r / W) ** 2) * j0(K * rho * r / z) * np.exp(0.5j * K * r * r / z)
    parts = [quad(lambda r: getattr(integrand(r), part), 0, reach, limit=2000, epsabs=1e-13, points=[10e-3])[0]
             for part in ("real", "imag")]
    return (K / z) ** 2 * (parts[0] ** 2 + parts[1] ** 2)


def check(wanted, found, tolerance, what=""):
    return RECORDS.below(f"largest difference of intensity, {what}", np.max(np.abs(np.array(wanted) - np.array(found))), tolerance)


hard = profile(HARD, 60, 11)
assert abs(hard["w_m"] / W - 1) < 1e-9 and abs(hard["clipped"] / np.exp(-2 * (RADIUS / W) ** 2) - 1) < 1e-9
assert abs(hard["axis_factor_far"] / (1 - np.exp(-(RADIUS / W) ** 2)) ** 2 - 1) < 1e-9      # eq. 5.7
exact = [hankel(abs(x), 60, lambda r: 1.0, RADIUS) for x in hard["x_m"]]
assert check(exact, hard["intensity"], 1e-6, "round hole")
assert not check(exact, hard["intensity_without_rim"], 1e-2)                                  # control: no aperture

serrated = profile(TEETH, 60, 11)
mean = [hankel(abs(x), 60, lambda r: np.clip((14e-3 - r) / 4e-3, 0, 1), 14e-3) for x in serrated["x_m"]]
assert check(mean, serrated["intensity"], 1e-6, "teeth")
assert not check(mean, hard["intensity"], 1e-3)                                               # control: a smooth rim

# Off centre, by the angular spectrum on a grid.
cells, width = 3072, 0.24
x = (np.arange(cells) - cells // 2) * width / cells
across, up = np.meshgrid(x, x, indexing="ij")
field = np.exp(-(across**2 + up**2) / W**2) * (np.hypot(across - 5e-3, up) < RADIUS)
frequency = np.fft.fftfreq(cells, width / cells)
phase = np.exp(-1j * np.pi * LAMBDA * 60 * (frequency[:, None] ** 2 + frequency[None, :] ** 2))
behind = np.abs(ifft2(fft2(field, workers=2) * phase, workers=2)) ** 2
off = profile(HARD, 60, 9, shift=5)
grid = [behind[np.argmin(np.abs(x - p)), cells // 2] for p in off["x_m"]]
assert check(grid, off["intensity"], 1e-2, "off centre")
assert not check(grid, profile(HARD, 60, 9)["intensity"], 5e-2)                               # control: the offset forgotten
RECORDS.write()
print("diffraction: as expected")
