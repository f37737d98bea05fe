# SPDX-License-Identifier: BSD-3-Clause
"""The field of a cavity on its mirrors and on baffles, with its mean over the azimuth."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patches import Circle

from .maps import STYLE, scaled
from .overview import footer
from .style import GREY, ROUTE_COLOURS

__all__ = ["STYLE", "draw"]

DEPTH = 1e-12         # part of the brightest that still has a colour


def planes_of(wave):
    """Both mirrors, and from both sides the edge in the middle of those whose light the grid holds, or of all."""
    one, two = wave.mirrors["name"]
    chosen = [*wave.light(two, towards=two), *wave.light(one, towards=one)]
    counts = np.diff(wave.draw_offset.astype(int))
    held = np.flatnonzero(counts > 0) if np.any(counts > 0) else np.arange(len(counts))
    if len(held):
        middle = held[len(held) // 2]
        place = wave.edges["centre"][middle, 2]
        chosen += [light for light in wave.light(wave.edges["name"][middle]) if light.place == place]
    return chosen


def edge_of(wave, light):
    """Radius of the opening of a plane [m]."""
    if light.plane in wave.mirrors["name"] and light.place in (0, wave.length):
        return float(wave.mirrors["radius"][wave.mirrors["name"].index(light.plane)])
    return float(wave.edges["radius"][np.argmin(np.abs(wave.edges["centre"][:, 2] - light.place))])


def draw_plane(figure, axes, wave, light, power, unit):
    rings, sectors = light.mean.shape
    factor, length = scaled(rings * light.step)
    edges = np.arange(rings + 1) * light.step * factor
    angles = np.arange(sectors + 1) * 2 * np.pi / sectors
    values = power * light.mean.astype(float)
    top = values.max()
    image = axes.pcolormesh(edges[:, None] * np.cos(angles), edges[:, None] * np.sin(angles), values, cmap="viridis",
                            norm=LogNorm(max(values[values > 0].min(), DEPTH * top), top) if top > 0 else None, rasterized=True)
    axes.add_patch(Circle((0, 0), factor * edge_of(wave, light), fill=False, color="white", linestyle="--", linewidth=1))
    axes.set_aspect("equal")
    axes.set_xlabel(f"x [{length}]")
    axes.set_ylabel(f"y [{length}]")
    axes.set_title(f"{light.plane} at {light.place:g} m, light towards {light.towards}")
    figure.colorbar(image, ax=axes, label=unit, shrink=0.85)


def draw_profiles(axes, wave, lights, power, unit):
    for light, colour in zip(lights, ROUTE_COLOURS):
        axes.plot(light.radius, power * light.profile, color=colour, label=f"{light.plane}, towards {light.towards}")
        axes.axvline(edge_of(wave, light), color=colour, linestyle=":", linewidth=1)
    top = power * max(light.profile.max() for light in lights)
    axes.set_yscale("log")
    axes.set_ylim(DEPTH * top, 3 * top)
    axes.set_xlim(0, None)
    axes.set_xlabel("distance from the axis [m]")
    axes.set_ylabel(f"irradiance, mean over the azimuth [{unit}]")
    axes.set_title("Dotted: edges of the openings")
    axes.legend(frameon=False)


def draw(run):
    """None for a run without the field of a cavity."""
    wave = run.wave
    lights = planes_of(wave) if wave is not None else []
    if not lights:
        return None
    power, unit = (wave.power, "W/m²") if wave.power > 0 else (1.0, "1/m², over the power of the mode")
    rows = -(-len(lights) // 2)
    figure = plt.figure(figsize=(9.6, 3.9 * rows + 3.6), dpi=100, layout="constrained")
    grid = figure.add_gridspec(rows + 1, 2)
    for i, light in enumerate(lights):
        draw_plane(figure, figure.add_subplot(grid[i // 2, i % 2]), wave, light, power, unit)
    draw_profiles(figure.add_subplot(grid[rows, :]), wave, lights, power, unit)
    figure.suptitle(f"Field of the cavity of beam {wave.beam}, crossover angle {1e6 * wave.crossover:.4g} µrad, loss per round trip "
                    f"{1e6 * wave.loss:.4g} ppm", x=0.01, ha="left", fontweight="bold")
    figure.supxlabel(footer(run), fontsize=7, color=GREY)
    return figure
