# SPDX-License-Identifier: BSD-3-Clause
"""Draws a scan: python3 -m straytrace.plots.scan scan.json -o scan.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from .style import GREY, LIGHT, ROUTE_COLOURS, draw_file

MOST_CURVES = 12


def positions(axis):
    """Positions of the values of a parameter, and their labels where they are not numbers."""
    numbers = [np.nan if n is None else n for n in axis["numbers"]]
    if np.all(np.isfinite(numbers)):
        return dict(zip(axis["values"], numbers)), None
    return {value: i for i, value in enumerate(axis["values"])}, axis["values"]


def number(x):
    return np.nan if x is None else x


def quantity(point, compared):
    chosen = point["worst_ratio"] if compared else point["strain"][0]
    return number(chosen["value"]), number(chosen["sigma"])


def draw(scan):
    first, others = scan["parameters"][0], scan["parameters"][1:]
    compared = any(p["worst_ratio"]["value"] is not None for p in scan["points"])
    places, labels = positions(first)
    curves = {}
    for point in scan["points"]:
        key = ", ".join(f"{a['name']} = {point['settings'][a['name']]}" for a in others)
        curves.setdefault(key, []).append((places[point["settings"][first["name"]]], *quantity(point, compared),
                                           bool(point["unresolved"])))
    figure, axes = plt.subplots(figsize=(9, 6), dpi=100)
    for k, (key, rows) in enumerate(list(curves.items())[:MOST_CURVES]):
        x, y, sigma, bound = (np.array(column) for column in zip(*rows))
        colour = ROUTE_COLOURS[k % len(ROUTE_COLOURS)]
        axes.errorbar(x, y, yerr=sigma, fmt="-", color=colour, capsize=3, label=key or None)
        bound = bound.astype(bool)
        axes.plot(x[~bound], y[~bound], "o", color=colour)
        axes.plot(x[bound], y[bound], "^", color=colour, mfc="white")
    if compared:
        axes.axhline(1, color=GREY, lw=1.5, ls=(0, (6, 2)))
        axes.annotate(f"line: {scan['line']}", (1, 1), xycoords=("axes fraction", "data"), xytext=(-4, 4),
                      textcoords="offset points", ha="right", color=GREY)
    bottom, top = axes.dataLim.intervaly
    if compared:
        bottom, top = min(bottom, 1), max(top, 1)
    if top > 3 * bottom:
        axes.set_yscale("log")
    values = np.array(list(places.values()), dtype=float)
    steps = np.diff(np.log(values)) if len(values) > 2 and np.all(values > 0) else np.array([])
    if labels is None and steps.size and np.allclose(steps, steps[0], rtol=1e-6):
        axes.set_xscale("log")
    if labels is not None:
        axes.set_xticks(range(len(labels)), labels)
    unit = f" [{first['unit']}]" if first["unit"] and labels is None else ""
    axes.set_xlabel(first["name"] + unit)
    axes.set_ylabel("worst h over the line" if compared else r"h at 10 Hz [1/$\sqrt{\mathrm{Hz}}$]")
    axes.grid(True, which="major", color=LIGHT, lw=0.7)
    title = f"{scan['model']}: total strain noise, bars: one standard error (Monte Carlo)"
    if any(p["unresolved"] for p in scan["points"]):
        title += "\nopen triangles: routes are unresolved; lower bounds unless upper bounds are in them"
    axes.set_title(title, fontsize=10)
    if others:
        axes.legend()
    if len(curves) > MOST_CURVES:
        axes.annotate(f"{len(curves) - MOST_CURVES} more curves are in the table", (0, 0), xycoords="axes fraction",
                      xytext=(6, 6), textcoords="offset points", fontsize=9, color=GREY)
    figure.tight_layout()
    return figure


def main(arguments=None):
    return draw_file(arguments, "scan", "Draws a scan.", "scan.json of straytrace scan",
                     draw)


if __name__ == "__main__":
    sys.exit(main())
