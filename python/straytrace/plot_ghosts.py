# SPDX-License-Identifier: BSD-3-Clause
"""Draws ghost beams: python3 -m straytrace.plot_ghosts GHOSTS.json -o ghosts.png, the JSON of `straytrace ghosts -o`."""

import argparse
import json
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from .labels import place_labels
from .words import hertz, shortened

COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")  # by order; Okabe and Ito
STYLE = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False}
WALLS = 0.35     # of the size of the tree: larger objects, rooms and tables, are drawn as lines
MARGIN = 0.06    # around beams and objects
SLIM = 0.05      # below this ratio of height to width the axes cannot have one scale
MOST = 60        # beams drawn
WIDTH = 8.6      # inches at 100 dpi


def way_of(ghost, tail):
    points = np.array(ghost["points_m"])
    if ghost["end"] in ("escaped", "rejoined"):
        points[-1] = points[-2] if len(points) > 1 else points[-1]
        points = np.vstack([points, points[-1] + tail * np.array(ghost["travel"])])
    return points


def plane_of(points):
    """The two axes along which the beams run farthest, the longer one first."""
    spread = np.ptp(points, axis=0)
    first, second = np.argsort(-spread)[:2]
    return int(first), int(second)


def hull(points):
    """Convex hull of points in a plane, closed (monotone chain)."""
    points = sorted(set(map(tuple, points)))
    if len(points) < 3:
        return np.array(points)

    def half(way):
        chain = []
        for p in way:
            while len(chain) > 1 and ((chain[-1][0] - chain[-2][0]) * (p[1] - chain[-2][1])
                                      - (chain[-1][1] - chain[-2][1]) * (p[0] - chain[-2][0])) <= 0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    ring = half(points) + half(reversed(points))
    return np.array(ring + ring[:1])


def area(ring):
    x, y = ring.T
    return 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


def squared(ring):
    """The rectangle around it when it nearly fills it: points on a room miss its corners."""
    low, high = ring.min(axis=0), ring.max(axis=0)
    if area(ring) < 0.85 * np.prod(high - low):
        return ring
    return np.array([low, (high[0], low[1]), high, (low[0], high[1]), low])


def outlines(beams, plane):
    """(object, hull) of every surface that a beam has met, in the plane of the picture."""
    for surface in {s["object"] + str(i): s for b in beams for i, s in enumerate(b["surfaces"])}.values():
        yield surface["object"].split("/")[0], squared(hull(np.array(surface["points_m"])[:, plane]))


def draw_objects(axes, shapes, size):
    """Small objects filled, walls as lines; returns name and outline of what can carry a label."""
    named = {}
    for name, ring in shapes:
        wall = np.ptp(ring, axis=0).max() > WALLS * size
        if wall:
            axes.plot(*ring.T, color="#a8a8a8", lw=1.6, zorder=1)
        else:
            axes.fill(*ring.T, facecolor="#d8d8d8", edgecolor="#909090", lw=1.0, zorder=1)
        if name not in named or np.ptp(ring, axis=0).max() < np.ptp(named[name], axis=0).max():
            named[name] = ring
    return named


def draw_beams(axes, ghosts, plane, size):
    ways = []
    strongest = max(g["power"] for g in ghosts)
    for ghost in sorted(ghosts, key=lambda g: -g["order"]):
        way = way_of(ghost, 0.05 * size)[:, plane]
        decades = np.log10(strongest / max(ghost["power"], 1e-300))
        colour = COLOURS[min(ghost["order"], len(COLOURS) - 1)]
        main = ghost["order"] == 0
        axes.plot(*way.T, color=colour, lw=2.2 if main else 1.0, alpha=float(np.clip(1 - decades / 20, 0.25, 1)),
                  zorder=2 + main)
        axes.plot(*way[-1], "o", color=colour, markersize=2.5, zorder=4)
        ways.append(way)
    return ways


def window(ways, shapes, size):
    """Corners of what is shown: all beams, and objects that do not reach far beyond them."""
    corners = np.vstack(ways)
    low, high = corners.min(axis=0), corners.max(axis=0)
    for _, ring in shapes:
        if (ring.min(axis=0) > low - WALLS * size).all() and (ring.max(axis=0) < high + WALLS * size).all():
            low, high = np.minimum(low, ring.min(axis=0)), np.maximum(high, ring.max(axis=0))
    pad = MARGIN * np.maximum(high - low, 1e-4 * size)
    return low - pad, high + pad


def set_scale(axes, low, high):
    """One scale on both axes where the tree allows it; otherwise the picture says how much one is stretched."""
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    wide, tall = high - low
    if tall > SLIM * wide:
        axes.set_aspect("equal")
        return ""
    axes.figure.canvas.draw()
    box = axes.get_window_extent()
    return f"; the vertical axis is stretched {hertz(box.height / tall / box.width * wide)} times"


def draw(beams):
    ghosts = [g for beam in beams for g in beam["ghosts"]][:MOST]
    if not ghosts:
        raise ValueError("no ghost to draw")
    corners = np.vstack([np.array(g["points_m"]) for g in ghosts])
    size = max(np.ptp(corners, axis=0).max(), 1e-3)
    plane = list(plane_of(corners))
    shapes = list(outlines(beams, plane))
    low, high = window([way_of(g, 0.05 * size)[:, plane] for g in ghosts], shapes, size)
    ratio = (high[1] - low[1]) / (high[0] - low[0])
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(WIDTH, float(np.clip(0.92 * WIDTH * ratio, 2.4, 7.0)) + 1.2), dpi=100)
        axes = figure.add_subplot()
        named = draw_objects(axes, shapes, size)
        ways = draw_beams(axes, ghosts, plane, size)
        orders = sorted({g["order"] for g in ghosts})
        handles = [Line2D([], [], color=COLOURS[min(o, len(COLOURS) - 1)], lw=2 if o == 0 else 1.2,
                          label="main beam" if o == 0 else f"order {o}") for o in orders]
        figure.legend(handles=handles, loc="lower center", ncol=min(len(orders), 7))
        axes.set_xlabel(f"{'xyz'[plane[0]]} [m]")
        axes.set_ylabel(f"{'xyz'[plane[1]]} [m]")
        shown, total = sum(g["order"] > 0 for g in ghosts), sum(beam["count"] for beam in beams)
        title = f"Main beam and {shown} of {total} ghosts"
        axes.set_title(title, loc="left", fontweight="bold")
        figure.tight_layout(rect=(0, 0.3 / figure.get_figheight(), 1, 1))
        axes.set_title(title + set_scale(axes, low, high), loc="left", fontweight="bold")
        place_labels(axes, {shortened(name, 16): ring for name, ring in named.items()}, ways)
        return figure


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("ghosts")
    parser.add_argument("-o", "--out", required=True)
    options = parser.parse_args(arguments)
    try:
        with open(options.ghosts, encoding="utf-8") as file:
            beams = json.load(file)
        figure = draw(beams)
        figure.savefig(options.out, pil_kwargs={"optimize": True})
    except (OSError, ValueError, KeyError) as error:
        print(f"error: {options.ghosts}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
