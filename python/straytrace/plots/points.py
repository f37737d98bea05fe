# SPDX-License-Identifier: BSD-3-Clause
"""The picture of a scan made in Python: noise of every point, and its largest ratio to the margin line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, NullFormatter

from .style import GREY, LIGHT, plain_number
from .words import shortened

if TYPE_CHECKING:
    from ..curves import Noise
    from ..scans import Scan

SIZE = (12.0, 5.2)  # inches at 100 dpi
MOST_IN_LEGEND = 8


def label(params: dict[str, Any]) -> str:
    """The parameters of a point."""
    return str(shortened(", ".join(f"{name} = {value}" for name, value in params.items()), 30))


def draw_line(axes: Any, noise: "Noise") -> None:
    """The margin line: margin times the first design curve."""
    for name, design in list(noise.design.items())[:1]:
        axes.plot(noise.frequency, noise.margin * design, color=GREY, lw=1.5, ls=(0, (6, 2)),
                  label=f"{name} × {noise.margin:g} (margin)")


def draw_noise(axes: Any, scan: "Scan") -> None:
    """Curves with one standard error on each side, coloured in the order of the points."""
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.92, len(scan.points)))
    for point, colour in zip(scan.points, colours):
        noise = point.run.noise
        if noise is None:
            continue
        f, h, sigma = noise.frequency, noise.total.mean, noise.total.sigma
        axes.plot(f, h, color=colour, lw=1.6, label=label(point.params) + noise.bound)
        axes.fill_between(f, np.maximum(h - sigma, 1e-300), h + sigma, color=colour, alpha=0.25, lw=0)
    for noise in [point.run.noise for point in scan.points if point.run.noise is not None][:1]:
        draw_line(axes, noise)
    axes.set(xscale="log", yscale="log", xlabel="frequency [Hz]", ylabel=r"strain $h$ [1/$\sqrt{\mathrm{Hz}}$], one-sided")
    axes.xaxis.set_major_formatter(FuncFormatter(plain_number))
    axes.xaxis.set_minor_formatter(NullFormatter())
    if len(scan.points) <= MOST_IN_LEGEND:
        axes.legend(fontsize=8.5)


def draw_ratios(axes: Any, scan: "Scan") -> None:
    """Points with one standard error; above 1 the requirement is not met."""
    worst = np.array([point.worst() for point in scan.points])
    place = np.arange(len(worst))
    axes.errorbar(place, worst[:, 0], worst[:, 1], fmt="o", color="#0072B2", capsize=3)
    axes.axhline(1, color=GREY, lw=1.5, ls=(0, (6, 2)))
    axes.set_xticks(place, [label(point.params) for point in scan.points], rotation=30, ha="right")
    axes.set(yscale="log", xlim=(-0.5, len(worst) - 0.5), title="Largest ratio to the margin line")


def draw(scan: "Scan") -> Any:
    """The figure."""
    figure, (left, right) = plt.subplots(1, 2, figsize=SIZE, dpi=100, width_ratios=(1.5, 1))
    draw_noise(left, scan)
    left.set_title("Stray-light noise of the points")
    draw_ratios(right, scan)
    for axes in (left, right):
        axes.grid(True, which="major", color=LIGHT, lw=0.7)
        axes.set_axisbelow(True)
    figure.tight_layout()
    return figure
