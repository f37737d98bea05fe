#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draw docs/theory/stray_gain.png: the gain of stray light in the arms of the presets, by the network solver.

Usage: draw_gain.py PROGRAM, the program dual_recycled_numbers of the build; with --table, print numbers instead.
"""
import collections
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plot

PICTURE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "theory" / "stray_gain.png"
PUBLIC = 15.7  # of the public ET model
# Okabe and Ito, distinguishable with every common kind of colour vision; dashed for detuned.
STYLES = {"et-hf 0": ("#0072B2", "-"), "et-hf -0.3": ("#0072B2", "--"), "et-lf 0": ("#D55E00", "-"),
          "et-lf -0.3": ("#D55E00", "--"), "aligo 0": ("#009E73", "-"), "adv 0": ("#CC79A7", "-"),
          "kagra 0": ("#E69F00", "-"), "ce 0": ("#56B4E9", "-")}


def curves(program):
    found = collections.defaultdict(lambda: ([], []))
    for line in subprocess.run([program, "gain"], check=True, capture_output=True, text=True).stdout.splitlines():
        name, tuning, hz, value = line.split()
        found[f"{name} {tuning}"][0].append(float(hz))
        found[f"{name} {tuning}"][1].append(float(value))
    return found


def draw(found):
    figure, axes = plot.subplots(figsize=(8.4, 4.6), dpi=100)
    for name, (hz, value) in found.items():
        colour, style = STYLES[name]
        preset, tuning = name.split()
        label = preset if not preset.startswith("et-") else f"{preset}, tuned" if tuning == "0" else f"{preset}, {tuning[1:]} rad off"
        axes.loglog(hz, value, style, color=colour, label=label)
    axes.axhline(PUBLIC, color="black", linewidth=1.2, linestyle=":", label="15.7, public ET model")
    axes.set(xlabel="frequency [Hz]", ylabel="effective arm gain $\\Gamma$ in eq. 9.2 [1]", xlim=(1, 100), ylim=(1, 300))
    axes.xaxis.set_major_formatter(lambda hz, _: f"{hz:g}")
    axes.yaxis.set_major_formatter(lambda gain, _: f"{gain:g}")
    axes.grid(which="both", alpha=0.2)
    axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0, frameon=False)
    figure.tight_layout()
    figure.savefig(PICTURE)
    print(f"{PICTURE.name}: {PICTURE.stat().st_size} bytes")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    lines = curves(sys.argv[1])
    if "--table" in sys.argv:
        for name, (hz, value) in lines.items():
            print(name, *(f"{f:.3g} Hz: {v:.4g}" for f, v in zip(hz, value) if any(abs(f / g - 1) < 0.02 for g in (1, 3.16, 10, 31.6, 100))))
    else:
        draw(lines)
