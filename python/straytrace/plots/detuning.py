# SPDX-License-Identifier: BSD-3-Clause
"""Draws a scan of detuning: python3 -m straytrace.plots.detuning wave.json -o detuning.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from .style import LIGHT, ROUTE_COLOURS, draw_file


def draw(driven):
    points = sorted(driven["detunings"], key=lambda p: p["detuning"])
    detuning = np.array([p["detuning"] for p in points])
    circulating = np.array([p["circulating"] for p in points])
    orders = np.array([p["orders"] for p in points])
    figure, (inside, outside) = plt.subplots(2, 1, sharex=True, figsize=(9, 7), dpi=100, height_ratios=(2, 1))
    inside.semilogy(detuning, circulating, color="black", lw=1.5, label="all")
    for n in range(orders.shape[1]):
        power = circulating * orders[:, n]
        inside.semilogy(detuning, np.where(power > 0, power, np.nan), lw=1,
                        color=ROUTE_COLOURS[n % len(ROUTE_COLOURS)], label=f"order {n}")
    inside.set_ylim(bottom=max(circulating.min() * 1e-4, circulating.max() * 1e-12))
    inside.set_ylabel("circulating power per input power")
    inside.legend(ncol=3)
    for key, colour in (("reflected", ROUTE_COLOURS[0]), ("transmitted", ROUTE_COLOURS[1])):
        outside.plot(detuning, [p[key] for p in points], color=colour, label=key)
    outside.set_ylabel("per input power")
    outside.set_xlabel(f"detuning [free spectral ranges of {driven['free_spectral_range_hz']:.6g} Hz]")
    outside.legend()
    for axes in (inside, outside):
        axes.grid(True, which="major", color=LIGHT, lw=0.7)
    inside.set_title(f"field of the driven cavity, known to {driven['field_error']:.1g} of itself or better", fontsize=10)
    figure.tight_layout()
    return figure


def main(arguments=None):
    return draw_file(arguments, "detuning", "Draws a scan of detuning.",
                     "answer of straytrace wave --detuning --format json, or its key 'driven'", lambda answer: draw(answer.get("driven", answer)))


if __name__ == "__main__":
    sys.exit(main())
