# SPDX-License-Identifier: BSD-3-Clause
"""Draws a sensitivity: python3 -m straytrace.plots.sensitivity sensitivity.json -o sensitivity.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from .style import GREY, LIGHT, ROUTE_COLOURS, draw_file

MOST_INPUTS = 12
CLASSES = ("strength", "shape", "motion", "response", "traced")


def bars(data, bin_number):
    """(name, class, elasticity, sigma, effect of one stated sigma or None) of the inputs, the smallest first."""
    rows = []
    for entry in data["inputs"]:
        value = entry["elasticity"][bin_number]
        if value is None:
            continue
        stated = entry["one_sigma_factor"] > 1
        rows.append((entry["name"], entry["class"], value, entry["elasticity_sigma"][bin_number] or 0.0,
                     abs(value) * np.log(entry["one_sigma_factor"]) if stated else None))
    rows.sort(key=lambda row: abs(row[2]))
    return rows[-MOST_INPUTS:]


def draw_panel(axes, rows, hz):
    for k, (_, kind, value, sigma, effect) in enumerate(rows):
        colour = ROUTE_COLOURS[CLASSES.index(kind)]
        axes.barh(k, value, color=colour, height=0.7, xerr=sigma or None, ecolor=GREY, capsize=3)
        if effect is not None:
            axes.annotate(f"one sigma: {100 * np.expm1(effect):.3g} % of h", (value, k), xytext=(6 if value >= 0 else -6, 0),
                          textcoords="offset points", va="center", ha="left" if value >= 0 else "right", fontsize=8,
                          color=GREY)
    axes.set_yticks(range(len(rows)), [row[0] for row in rows], fontsize=9)
    axes.axvline(0, color=GREY, lw=1)
    axes.grid(True, axis="x", color=LIGHT, lw=0.7)
    axes.set_axisbelow(True)
    low, high = axes.get_xlim()
    axes.set_xlim(low * (1.6 if low < 0 else 1), high * 1.6)
    axes.set_title(f"{hz:g} Hz", fontsize=10)


def draw(data):
    frequency = np.array(data["frequency"])
    panels = [(hz, rows) for hz in data["at"] if frequency[0] <= hz <= frequency[-1]
              and (rows := bars(data, int(np.argmin(np.abs(np.log(frequency / hz))))))]
    height = sum(max(1.4, 0.34 * len(rows) + 0.6) for _, rows in panels) + 0.9
    figure, all_axes = plt.subplots(len(panels), 1, figsize=(9, height), dpi=100, squeeze=False,
                                    gridspec_kw={"height_ratios": [len(rows) + 1 for _, rows in panels]})
    for axes, (hz, rows) in zip(all_axes[:, 0], panels):
        draw_panel(axes, rows, hz)
    all_axes[-1, 0].set_xlabel("elasticity d ln h / d ln p, bars: one standard error (Monte Carlo)")
    present = [c for c in CLASSES if any(row[1] == c for _, rows in panels for row in rows)]
    handles = [plt.Rectangle((0, 0), 1, 1, color=ROUTE_COLOURS[CLASSES.index(c)]) for c in present]
    figure.legend(handles, present, loc="upper right", ncols=len(present), fontsize=9)
    figure.tight_layout(rect=(0, 0, 1, 0.97))
    return figure


def main(arguments=None):
    return draw_file(arguments, "sensitivity", "Draws a sensitivity.", "JSON of straytrace sensitivity", draw)


if __name__ == "__main__":
    sys.exit(main())
