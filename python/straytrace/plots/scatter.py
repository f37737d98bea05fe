# SPDX-License-Identifier: BSD-3-Clause
"""Draws measured scatter with its fits: python3 -m straytrace.plots.scatter DATA.json -o data.png.

DATA.json is what `straytrace inspect FILE --format json` prints.
"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from .sheet import draw_json
from .style import GREY

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")  # Okabe and Ito
STYLES = {"abg": "-", "harvey": "--", "k-correlation": ":"}
OUT_OF_PICTURE = 3.0                 # dex of residual: drawn at the edge


def columns(points):
    """Arrays of incidence, offset, BSDF, error, limit, side of the specular direction."""
    return {key: np.array([p[key] for p in points]) for key in ("deg", "offset", "bsdf", "error", "limit", "towards")}


def draw_points(axes, data, incidences):
    for number, degrees in enumerate(incidences):
        colour = COLOURS[number % len(COLOURS)]
        here = data["deg"] == degrees
        for towards, face in ((True, colour), (False, "white")):
            sel = here & ~data["limit"] & (data["towards"] == towards)
            axes.errorbar(data["offset"][sel], data["bsdf"][sel], yerr=data["error"][sel], fmt="o", markersize=3.5,
                          markerfacecolor=face, markeredgecolor=colour, ecolor=colour, linewidth=0.8)
        sel = here & data["limit"]
        axes.plot(data["offset"][sel], data["bsdf"][sel], linestyle="none", marker="v", markersize=4, color=colour)
        axes.plot([], [], "o", color=colour, markersize=4, label=f"{degrees:g} deg")


def draw_fits(axes, fits, incidences):
    for fit in fits:
        for curve in fit.get("curves", []):
            number = int(np.argmin(np.abs(np.array(incidences) - curve["deg"])))
            axes.plot(curve["offset"], curve["bsdf"], linestyle=STYLES[fit["model"]], linewidth=1.2,
                      color=COLOURS[number % len(COLOURS)])
        if fit.get("curves"):
            axes.plot([], [], linestyle=STYLES[fit["model"]], color=GREY,
                      label=f"{fit['model']}: {fit['rms_log10']:.2g} dex")


def draw_residuals(axes, fit, data, incidences):
    residual = np.log10(data["bsdf"] / np.array(fit["fitted"]))
    for number, degrees in enumerate(incidences):
        sel = (data["deg"] == degrees) & ~data["limit"]
        axes.plot(data["offset"][sel], np.clip(residual[sel], -OUT_OF_PICTURE, OUT_OF_PICTURE), "o", markersize=2.5,
                  color=COLOURS[number % len(COLOURS)])
        sel = (data["deg"] == degrees) & data["limit"]
        axes.plot(data["offset"][sel], np.clip(residual[sel], -OUT_OF_PICTURE, OUT_OF_PICTURE), "v", markersize=3,
                  color=COLOURS[number % len(COLOURS)])
    axes.axhline(0, color=GREY, linewidth=0.8)
    axes.set_ylabel(f"{fit['model']}\nresidual [dex]", fontsize=7.5)


def notes_of(scatter):
    limits = scatter["audit"]["limits"]
    text = ["filled: towards the normal, open: away from it; lower: log10(measured / fitted)"]
    if limits:
        text.append(f"triangles: {limits} upper limits at the noise floor of {scatter['noise_floor']:g} /sr")
    return "\n".join(text)


def picture(scatter):
    data = columns(scatter["points"])
    incidences = sorted(set(data["deg"]))
    fits = [f for f in scatter["fits"] if not f["why_not"]]
    rows = 1 + len(fits)
    figure, all_axes = plt.subplots(rows, 1, figsize=(8, 5 + 1.1 * len(fits)), dpi=100, sharex=True, squeeze=False,
                                    height_ratios=[5] + [1.2] * len(fits))
    top = all_axes[0][0]
    draw_points(top, data, incidences)
    draw_fits(top, fits, incidences)
    top.set_xscale("log")
    top.set_yscale("log")
    low, high = data["bsdf"].min(), data["bsdf"].max()
    top.set_ylim(low / 5, high * 5)
    nearest = data["offset"][data["offset"] > 1e-6]
    top.set_xlim(nearest.min() / 2, 2.2)
    top.set_ylabel("BSDF [1/sr]")
    top.legend(ncols=2, fontsize=8)
    for axes, fit in zip(all_axes[1:, 0], fits):
        draw_residuals(axes, fit, data, incidences)
    for axes in all_axes[:, 0]:
        axes.grid(True, which="major", color="#d9d9d9", linewidth=0.6)
    all_axes[-1][0].set_xlabel(r"$|\beta-\beta_0|$ (direction cosines)")
    top.set_title(f"{scatter['file']}: {scatter['format']}, {scatter['wavelength'] * 1e9:g} nm")
    figure.text(0.01, 0.008, notes_of(scatter), fontsize=7.5, color=GREY, linespacing=1.4)
    figure.tight_layout(rect=(0, 0.045, 1, 1))
    return figure


def main(arguments=None):
    return draw_json("straytrace.plots.scatter", __doc__.splitlines()[0], picture, arguments)


if __name__ == "__main__":
    sys.exit(main())
