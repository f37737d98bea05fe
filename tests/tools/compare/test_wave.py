#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Loss of a cavity of two round mirrors (case V2 of docs/theory/wave.md) against FINESSE 3 with aperture maps.

Usage: test_wave.py PROGRAM. The modes of FINESSE are sums of Hermite-Gauss modes up to an order, on which its loss depends
without settling (8: 38.48, 10: 39.86, 12: 38.98, 14: 38.61, 16: 41.16 ppm; the pixels of the maps change them by less than
0.6 %). All are above eq. W.10, 38.334 ppm. So the loss must differ from their mean by no more than they differ among each
other, and that is all that FINESSE can tell; eq. W.10 fixes it to 1e-4. FINESSE lives in a virtual environment that
`scripts/setup --test` makes.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

from environment import require_finesse
from records import Records

SCENE = """straytrace: 1
materials: {polished: {specular: {reflect: 0.9999}}}
bodies: {optics: {motion: still}}
scene:
  - {name: I, use: mirror, radius: 50 mm, radius_of_curvature: 2500 m, at: [0 m, 0 m, 0 m], facing: [0, 0, 1],
     body: optics, material: polished}
  - {name: E, use: mirror, radius: 50 mm, radius_of_curvature: 2500 m, at: [0 m, 0 m, 1000 m], facing: [0, 0, -1],
     body: optics, material: polished}
beams: {arm: {cavity: [I, E]}}
receivers: {at_E: {on: E}}
wave: {beam: arm, crossover: 200 urad, grid: {points: 384, window: 0.4 m}, maps: {I: {spectrum: none}, E: {spectrum: none}}}
"""
TRANSMISSIONS = 0.014, 0.001
ORDERS = 8, 10, 12


def ours(program):
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "scene.yaml"
        scene.write_text(SCENE)
        out = subprocess.run([program, "wave", scene, "--order", "0", "--format", "json", "--quiet"], check=True, text=True,
                             stdout=subprocess.PIPE)
    return json.loads(out.stdout)["loss"]


def theirs(order, radius=0.05, points=201, half=0.06):
    model = finesse.Model()
    model.parse(f"""
        l laser P=1
        m ITM T={TRANSMISSIONS[0]} L=0 Rc=-2500
        m ETM T={TRANSMISSIONS[1]} L=0 Rc=2500
        s in laser.p1 ITM.p1
        s arm ITM.p2 ETM.p1 L=1000
        cav C ITM.p2 ETM.p1.i
        modes(maxtem={order})
        """)
    x = numpy.linspace(-half, half, points)
    for mirror in (model.ITM, model.ETM):
        mirror.surface_map = Map(x, x, amplitude=circular_aperture(x, x, radius))
    size = numpy.abs(model.run(Eigenmodes("C", 0)).eigvalues).max() ** 2
    return 1 - size / ((1 - TRANSMISSIONS[0]) * (1 - TRANSMISSIONS[1]))


def main():
    records = Records("tools.wave", sys.argv[1])
    loss, modal = ours(sys.argv[1]), [theirs(order) for order in ORDERS]
    mean, spread = sum(modal) / len(modal), max(modal) - min(modal)
    good = records.near("loss per round trip, mean of FINESSE to orders 8, 10, 12", loss, mean, spread)
    clipped = 2 * 2.718281828 ** (-2 * (0.05 / 20.5755e-3) ** 2)  # control: eq. 5.5 at both mirrors
    control = abs(clipped - mean) > 10 * spread
    listed = ", ".join(f"{1e6 * m:.4f}" for m in modal)
    print(f"{'ok  ' if good else 'FAIL'} loss {1e6 * loss:.4f} ppm, FINESSE {listed} ppm")
    print(f"{'ok  ' if control else 'FAIL'} control: a clipped Gaussian loses {1e6 * clipped:.4f} ppm")
    if good and control:
        records.write()
    sys.exit(not (good and control))


require_finesse(sys.argv[1])
import finesse
import numpy
from finesse.analysis.actions import Eigenmodes
from finesse.knm import Map
from finesse.utilities.maps import circular_aperture
main()
