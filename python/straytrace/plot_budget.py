# SPDX-License-Identifier: BSD-3-Clause
"""Draws a noise budget from the JSON of straytrace budget: python3 -m straytrace.plot_budget BUDGET_JSON -o budget.png"""

import argparse
import json
import pathlib

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

from .plot import GREY, LIGHT, STYLE, plain_number  # noqa: E402
from .words import shortened  # noqa: E402

# One colour per fundamental noise, so that pictures of different detectors can be compared.
COLOURS = {
    "Quantum": "#AA3377",
    "Seismic": "#7B5B2E",
    "Newtonian": "#228833",
    "SuspensionThermal": "#0072B2",
    "CoatingBrownian": "#D62728",
    "CoatingThermoOptic": "#56B4E9",
    "SubstrateBrownian": "#E69F00",
    "SubstrateThermoElastic": "#BDAA00",
    "SubstrateThermoRefractive": "#8C8CD9",
    "ResidualGas": "#88CC44",
}
STRAY = ("#000000", "#CC3311", "#009988")
DASHED = (0, (5, 2))
SIZE = (8.5, 5.6)  # inches at 100 dpi


def values(numbers):
    return np.array([np.nan if x is None else x for x in numbers], dtype=float)


def draw(axes, budget):
    curves = budget["curves"]
    f = np.array(curves["frequency_Hz"])
    stray = 0
    for noise in curves["noises"]:
        asd = values(noise["strain"])
        if noise["kind"] == "stray light":
            colour = STRAY[stray % len(STRAY)]
            stray += 1
            axes.plot(f, asd, color=colour, lw=2.2, label=shortened(noise["name"], 30), zorder=5)
            if "sigma" in noise:
                sigma = values(noise["sigma"])
                axes.fill_between(f, np.maximum(asd - sigma, 1e-300), asd + sigma, color=colour, alpha=0.25, lw=0)
        else:
            style = "-" if noise["kind"] == "fundamental" else DASHED
            axes.plot(f, asd, color=COLOURS.get(noise["name"]), lw=1.3, ls=style, label=shortened(noise["name"], 30))
    total = values(curves["total"])
    axes.plot(f, total, color="black", lw=1.6, ls=(0, (1, 1)), label="total", zorder=4)
    shown = [total]
    for k, curve in enumerate(curves["curves"]):
        asd = values(curve["strain"])
        axes.plot(f, asd, color=GREY, lw=2.0, ls="-" if k == 0 else (0, (3, 1, 1, 1)), label=curve["name"])
        shown.append(asd)
        if k == 0:
            axes.plot(f, budget["margin"] * asd, color=GREY, lw=1.3, ls=DASHED, label=f"{curve['name']} × {budget['margin']:g}")
            shown.append(budget["margin"] * asd)
    for line, style in zip(curves["lines"], (":", (0, (3, 1, 1, 1, 1, 1)), (0, (1, 3)))):
        axes.plot(f, values(line["strain"]), color="#555555", lw=1.0, ls=style, label=line["name"])
    known = np.concatenate([c[np.isfinite(c) & (c > 0)] for c in shown])
    low, high = (known.min(), known.max()) if known.size else (1e-25, 1e-20)
    axes.set(xscale="log", yscale="log", xlim=(f[0], f[-1]), ylim=(max(low / 30, high * 1e-9), high * 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("budget", type=pathlib.Path)
    parser.add_argument("-o", "--out", type=pathlib.Path, required=True)
    asked = parser.parse_args()
    budget = json.loads(asked.budget.read_text())
    with plt.rc_context(STYLE | {"font.size": 9.5, "legend.fontsize": 8.5, "axes.titlesize": 10}):
        figure, axes = plt.subplots(figsize=SIZE)
        draw(axes, budget)
        axes.set_xlabel("frequency [Hz]")
        axes.set_ylabel(r"strain $h$ [1/$\sqrt{\mathrm{Hz}}$], one-sided")
        axes.set_title(shortened(budget["title"], 90))
        axes.xaxis.set_major_formatter(FuncFormatter(plain_number))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_locator(LogLocator(base=10, numticks=12))
        axes.grid(True, which="major", color=LIGHT, lw=0.7)
        axes.set_axisbelow(True)
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0)
        figure.text(0.01, 0.005, f"straytrace {budget['version']} ({budget['commit']})", fontsize=7, color=GREY)
        figure.tight_layout()
        figure.savefig(asked.out, dpi=100)


if __name__ == "__main__":
    main()
