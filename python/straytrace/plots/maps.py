# SPDX-License-Identifier: BSD-3-Clause
"""The maps of a receiver: image, directions, quadrants."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm

from .overview import footer
from .style import GREY

STYLE = {"font.size": 9, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left"}


def scaled(half):
    """Length unit in which a map is drawn, and its factor."""
    for factor, unit in ((1.0, "m"), (1e2, "cm"), (1e3, "mm"), (1e6, "um")):
        if half * factor >= 1:
            return factor, unit
    return 1e6, "um"


def norm_of(values):
    """Logarithmic when the light spans more than two decades; at most six are shown."""
    seen = values[np.isfinite(values) & (values > 0)]
    if seen.size == 0 or seen.max() < 100 * seen.min():
        return None
    return LogNorm(max(seen.min(), 1e-6 * seen.max()), seen.max())


def relative_error(mean, error):
    """In per cent; NaN where it is not resolved. Old files hold 0 where the square of faint light underflowed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(error > 0, 100 * error / mean, np.nan)


def outlines(receiver):
    """Of the cells of a map without stated pixels [m]; arcs have a corner every two degrees."""
    found = []
    for low, high, first, last in receiver.cells:
        if receiver.chart != "polar":
            found.append([(low, first), (high, first), (high, last), (low, last)])
            continue
        angle = np.linspace(first, last, max(2, int(np.ceil((last - first) / 0.035)) + 1))
        out, back = (np.column_stack([r * np.cos(t), r * np.sin(t)]) for r, t in ((high, angle), (low, angle[::-1])))
        found.append(np.vstack([out, back]))
    return found


def draw_cells(axes, values, cells, **style):
    low, high = style.pop("vmin", None), style.pop("vmax", None)
    image = axes.add_collection(PolyCollection(cells, array=np.ma.masked_invalid(values), **style))
    if low is not None:
        image.set_clim(low, high)
    corners = np.vstack([np.asarray(c) for c in cells])
    axes.set_xlim(corners[:, 0].min(), corners[:, 0].max())
    axes.set_ylim(corners[:, 1].min(), corners[:, 1].max())
    return image


def draw_panel(figure, axes, values, half, unit, title, label, nothing="no light seen", cells=None, **style):
    if not np.isfinite(values).any():
        axes.text(0.5, 0.5, nothing, ha="center", va="center", transform=axes.transAxes)
    if cells is not None:
        image = draw_cells(axes, values, cells, **style)
    else:
        image = axes.imshow(values, origin="lower", extent=(-half[0], half[0], -half[1], half[1]),
                            interpolation="nearest", **style)
    axes.set_facecolor("#e6e6e6")                # where nothing was seen or resolved
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    axes.set_title(title)
    figure.colorbar(image, ax=axes, label=label, shrink=0.85)


def panels_of(receiver, watt):
    """(values, half sizes, unit, title, label, style) of each panel."""
    relative = "" if watt else " per W of the main mode"
    power = watt or 1.0
    found = []
    if receiver.image is not None:
        cells = outlines(receiver) if receiver.cells is not None else None
        reach = max(receiver.half) if cells is None else max(np.abs(c).max() for c in cells)
        factor, unit = scaled(reach)
        half = [factor * h for h in receiver.half]
        drawn = {} if cells is None else {"cells": [factor * np.asarray(c) for c in cells]}
        irradiance = receiver.image * power / receiver.areas
        found.append((irradiance, half, unit, "Irradiance", f"W/m²{relative}",
                      {"cmap": "viridis", "norm": norm_of(irradiance)} | drawn))
        error, nothing = relative_error(receiver.image, receiver.image_error), "no light seen"
        title = "One standard error"
        if np.any(np.isfinite(receiver.image) & ~np.isfinite(error)):
            title, nothing = title + " (grey: not resolved)", "not resolved"
        found.append((error, half, unit, title, "% of the irradiance",
                      {"cmap": "cividis", "vmin": 0, "nothing": nothing} | drawn))
        if receiver.field is not None:
            field = receiver.field * np.sqrt(power)
            found.append((np.abs(field) ** 2, half, unit, "Coherent irradiance", f"W/m²{relative}",
                          {"cmap": "viridis"} | drawn))
            found.append((np.angle(field), half, unit, "Phase", "rad",
                          {"cmap": "twilight", "vmin": -np.pi, "vmax": np.pi} | drawn))
    if receiver.angles is not None:
        sine = receiver.angle_sine
        solid = (2 * sine) ** 2 / receiver.angles.size
        values = receiver.angles * power / solid
        found.append((values, [sine, sine], "direction cosine", "Directions of arrival",
                      f"W per unit of direction cosine²{relative}", {"cmap": "viridis", "norm": norm_of(values)}))
    return found


def draw(run, receiver):
    panels = panels_of(receiver, run.beam_power)
    if not panels:
        return None
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(4.4 * columns, 3.6 * rows + 0.5), dpi=100, squeeze=False,
                                layout="constrained")
    for axes, panel in zip(grid.flat, panels):
        draw_panel(figure, axes, *panel[:5], **panel[5])
    for axes in grid.flat[len(panels):]:
        axes.set_visible(False)
    figure.suptitle(f"Receiver {receiver.name}, seen from the front", x=0.01, ha="left", fontweight="bold")
    figure.supxlabel(footer(run), fontsize=7, color=GREY)
    return figure
