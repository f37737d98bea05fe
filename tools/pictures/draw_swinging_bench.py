#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draw docs/theory/swinging_bench.png: strain of a bench behind an end mirror that swings, for two positions of the scatterer a
wavelength over 8 apart (R5.03), from examples/benches/swinging_bench.yaml.

Usage: draw_swinging_bench.py PROGRAM [ROOT]. Stops when the lines are not in the quadratures of their order."""
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

SWING = 1.0  # Hz


def noise_at(program, scene, phase, folder):
    subprocess.run([program, "run", scene, "-p", f"phi={phase}deg", "-o", folder, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    import straytrace

    return straytrace.open_run(f"{folder}/run.h5").noise


def check_orders(noise, odd, even):
    """Lines of odd order are in one quadrature only, lines of even order in the other."""
    for order in range(3, 31):
        at = np.searchsorted(noise.edges, order * SWING, side="right") - 1
        strong, weak = (odd[at], even[at]) if order % 2 else (even[at], odd[at])
        assert strong > 1e3 * weak, f"line {order}"


def main(program, root):
    sys.path.insert(0, str(root / "python"))
    scene, picture = root / "examples" / "benches" / "swinging_bench.yaml", root / "docs" / "theory" / "swinging_bench.png"
    figure, panels = plt.subplots(1, 2, figsize=(9.6, 4.4), dpi=100, sharey=True)
    for axes, phase, name in zip(panels, (0, 90), ("$x_0 = 0$", "$x_0 = \\lambda/8$")):
        with tempfile.TemporaryDirectory() as folder:
            noise = noise_at(program, scene, phase, folder)
            total, f, design = noise.total, noise.frequency, noise.design["adv-lal"]
            check_orders(noise, *((total.phase, total.amplitude) if phase == 0 else (total.amplitude, total.phase)))
        axes.stairs(total.amplitude, noise.edges, color="#D55E00", lw=1.2, label="radiation pressure (9.4)")
        axes.stairs(total.phase, noise.edges, color="#0072B2", lw=1.2, label="phase (9.3)")
        axes.plot(f, design, color="#6b6b6b", lw=1.6, ls="--", label="adv-lal")
        axes.set(xscale="log", yscale="log", xlim=(2.5, 40), ylim=(1e-24, 1e-16), xticks=(3, 5, 10, 20, 30), xlabel="frequency [Hz]",
                 title=f"scatterer at {name}")
        axes.xaxis.set_major_formatter(lambda hz, _: f"{hz:g}")
        axes.xaxis.set_minor_formatter(lambda hz, _: "")
        axes.grid(which="major", alpha=0.3)
    panels[0].set_ylabel(r"strain [1/$\sqrt{\mathrm{Hz}}$], one-sided")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=4, fontsize=8.5, frameon=False)
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    figure.savefig(picture)
    print(f"{picture.name}: {picture.stat().st_size} bytes")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]).resolve(),
         pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).parents[2]).resolve())
