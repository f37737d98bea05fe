# SPDX-License-Identifier: BSD-3-Clause
"""Draws a noise budget from the JSON of straytrace budget: python3 -m straytrace.plots.budget BUDGET_JSON -o budget.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .sheet import draw_json, frame, values
from .style import GREY, LIGHT, plain_number
from .words import shortened

# One colour per fundamental noise, so that pictures of different detectors can be compared.
COLOURS = {
    "Quantum": "#AA3377",
    "Seismic": "#7B5B2E",
    "Newtonian": "#228833",
    "SuspensionThermal": "#0072B2",
    "CoatingBrownian": "#E66101",
    "CoatingThermoOptic": "#56B4E9",
    "SubstrateBrownian": "#E69F00",
    "SubstrateThermoElastic": "#BDAA00",
    "SubstrateThermoRefractive": "#8C8CD9",
    "ResidualGas": "#88CC44",
}
STRAY = ("#D00000", "#00857A", "#7A00CC")   # thick: what the program is for
LINES = (":", (0, (3, 1, 1, 1, 1, 1)), (0, (1, 3)))
DASHED = (0, (5, 2))
SIZE = (10.0, 6.4)  # inches at 100 dpi


def fill(axes, f, noise, low, high, **style):
    """A band between two curves of the JSON."""
    axes.fill_between(f, np.maximum(values(noise[low]), 1e-300), values(noise[high]), **style)


def draw_stray_light(axes, f, noises):
    """Thick lines with a band of one standard error on each side, a pale one of realisations and a hatched one of
    inputs; returns the largest error over its value."""
    widest = 0.0
    for noise, colour in zip(noises, STRAY * len(noises)):
        asd = values(noise["strain"])
        note = noise.get("note", "")
        bound = (" (contains upper bounds; routes unresolved)" if note.startswith("no bound") else
                 " (at most)" if "upper bound" in note else " (lower bound)" if note else "")
        axes.plot(f, asd, color=colour, lw=2.2, label=shortened(noise["name"], 26) + bound, zorder=6)
        if "speckle_05" in noise:
            fill(axes, f, noise, "speckle_05", "speckle_95", color=colour, alpha=0.12, lw=0, zorder=1)
        if noise.get("inputs_stated"):
            fill(axes, f, noise, "input_low", "input_high", facecolor="none", hatch="////", edgecolor=colour, alpha=0.5,
                 lw=0.6, zorder=2)
        if "sigma" in noise:
            sigma = values(noise["sigma"])
            axes.fill_between(f, np.maximum(asd - sigma, 1e-300), asd + sigma, color=colour, alpha=0.35, lw=0, zorder=6)
            widest = max(widest, np.nanmax(np.where(asd > 0, sigma / np.where(asd > 0, asd, 1), 0), initial=0))
    return widest


def draw_references(axes, f, budget):
    """Design curves with the margin under the first, then lines that are not noises; returns the curves that must be visible."""
    shown = []
    for k, curve in enumerate(budget["curves"]["curves"]):
        asd = values(curve["strain"])
        axes.plot(f, asd, color=GREY, lw=2.0, ls="-" if k == 0 else (0, (3, 1, 1, 1)), label=curve["name"])
        shown.append(asd)
        if k == 0:
            label = f"{curve['name']} × {budget['margin']:g} (margin)"
            axes.plot(f, budget["margin"] * asd, color=GREY, lw=1.5, ls=DASHED, label=label)
            shown.append(budget["margin"] * asd)
    for line, style in zip(budget["curves"]["lines"], LINES):
        axes.plot(f, values(line["strain"]), color="#8a8a8a", lw=1.0, ls=style, label=line["name"])
    return shown


def draw(axes, budget):
    curves = budget["curves"]
    f = np.array(curves["frequency_Hz"])
    stray = [noise for noise in curves["noises"] if noise["kind"] == "stray light"]
    total = values(curves["total"])
    axes.plot(f, total, color="black", lw=2.8, label="total", zorder=5)
    widest = draw_stray_light(axes, f, stray)
    shown = [total] + draw_references(axes, f, budget)
    for noise in curves["noises"]:
        if noise["kind"] != "stray light":
            style = "-" if noise["kind"] == "fundamental" else DASHED
            axes.plot(f, values(noise["strain"]), color=COLOURS.get(noise["name"]), lw=1.2, ls=style,
                      label=shortened(noise["name"], 30))
    handles, labels = axes.get_legend_handles_labels()
    if any("sigma" in noise for noise in stray):
        handles.insert(1 + len(stray), Patch(color=STRAY[0], alpha=0.35, lw=0))
        labels.insert(1 + len(stray), f"± one standard error (≤ {100 * widest:.2g} %)")
    for wanted, patch, label in (
            ("speckle_05", Patch(color=STRAY[0], alpha=0.12, lw=0), "one realisation: 5 to 95 %"),
            ("inputs_stated", Patch(facecolor="none", hatch="////", edgecolor=STRAY[0], alpha=0.5, lw=0.6),
             "stated input uncertainty")):
        if any(wanted in noise for noise in stray):
            handles.insert(1 + len(stray), patch)
            labels.insert(1 + len(stray), label)
    axes.legend(handles, labels, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0)
    known = np.concatenate([c[np.isfinite(c) & (c > 0)] for c in shown])
    low, high = (known.min(), known.max()) if known.size else (1e-25, 1e-20)
    axes.set(xscale="log", yscale="log", xlim=(f[0], f[-1]), ylim=(max(low / 30, high * 1e-9), high * 3))


def footer(budget):
    """Program, date, and of each run the model, the seed and the histories."""
    lines = [f"straytrace {budget['version']} ({budget['commit']})    {budget['created']}"]
    runs = budget["runs"]
    for run in runs[:3]:
        histories = f"{int(run['histories']):,}".replace(",", " ")
        words = f"{run['name']}: {run['title'] or run['file']}    model {run['model_hash'][:12]}    seed {run['seed']}    "
        lines.append(f"{words}{histories} histories    {run['created']}")
    if len(runs) > 3:
        lines.append(f"and {len(runs) - 3} more runs")
    return "\n".join(lines)


def picture(budget):
    figure, axes = plt.subplots(figsize=SIZE, dpi=100)
    draw(axes, budget)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel(r"strain $h$ [1/$\sqrt{\mathrm{Hz}}$], one-sided")
    axes.xaxis.set_major_formatter(FuncFormatter(plain_number))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.yaxis.set_major_locator(LogLocator(base=10, numticks=12))
    axes.grid(True, which="major", color=LIGHT, lw=0.7)
    axes.set_axisbelow(True)
    frame(figure, axes, budget["title"], 80, footer(budget))
    return figure


def main(arguments=None):
    return draw_json("straytrace.plots.budget", __doc__, picture, arguments)


if __name__ == "__main__":
    sys.exit(main())
