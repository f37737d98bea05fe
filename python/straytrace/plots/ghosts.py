# SPDX-License-Identifier: BSD-3-Clause
"""Draws ghost beams: python3 -m straytrace.plots.ghosts GHOSTS.json -o ghosts.png, the JSON of `straytrace ghosts -o`."""

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
DOT = 0.005      # of the tree: where objects and groups of them are smaller, each group has a separate panel
MOST_PANELS = 3
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


def objects_are_dots(beams, size):
    extents = [np.ptp(np.array(s["points_m"]), axis=0).max() for b in beams for s in b["surfaces"]]
    return max((e for e in extents if e < WALLS * size), default=size) < DOT * size


def groups_of(points, size):
    """The points where beams meet surfaces; of a tree whose groups are dots in it, each group, the busiest first.
    A group of one place has nothing to show."""
    left, groups = list(range(len(points))), []
    while left:
        group, border = [], [left.pop()]
        while border:
            here = border.pop()
            group.append(here)
            near = [i for i in left if np.linalg.norm(points[i] - points[here]) < DOT * size]
            left = [i for i in left if i not in near]
            border += near
        groups.append(points[sorted(group)])
    if max(np.ptp(group, axis=0).max() for group in groups) > DOT * size:
        return [points]
    wide = [group for group in groups if np.ptp(group, axis=0).max() > 1e-6 * size]
    return sorted(wide, key=len, reverse=True)[:MOST_PANELS] or [points]


def is_near(points, low, high, room):
    return ((points >= low - room) & (points <= high + room)).all(axis=-1)


def window(ways, shapes, size):
    """Corners of what is shown: all beams, and objects that do not reach far beyond them."""
    corners = np.vstack(ways)
    low, high = corners.min(axis=0), corners.max(axis=0)
    for _, ring in shapes:
        if is_near(ring, low, high, WALLS * size).all():
            low, high = np.minimum(low, ring.min(axis=0)), np.maximum(high, ring.max(axis=0))
    pad = MARGIN * np.maximum(high - low, 1e-4 * size)
    return low - pad, high + pad


def set_scale(axes, low, high):
    """One scale on both axes where the tree allows it; otherwise the picture states by how much one is stretched."""
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.ticklabel_format(useOffset=False)
    wide, tall = high - low
    if tall > SLIM * wide:
        axes.set_aspect("equal")
        return ""
    axes.figure.canvas.draw()
    box = axes.get_window_extent()
    return f"; the vertical axis is stretched {hertz(box.height / tall / box.width * wide)} times"


class Panel:
    """What is shown around some points: its plane, its objects, its corners."""

    def __init__(self, ghosts, beams, points):
        self.size = max(np.ptp(points, axis=0).max(), 1e-3)
        self.plane = list(plane_of(points))
        self.shapes = list(outlines(beams, self.plane))
        low, high = points[:, self.plane].min(axis=0), points[:, self.plane].max(axis=0)
        ways = [way_of(g, 0.05 * self.size)[:, self.plane] for g in ghosts]
        inside = [way[is_near(way, low, high, 0.1 * self.size)] for way in ways]
        self.low, self.high = window([way for way in inside if len(way)], self.shapes, self.size)

    def ratio(self):
        wide, tall = self.high - self.low
        return tall / wide

    def height(self):
        """Inches; what cannot have one scale on both axes is stretched to the least."""
        return float(np.clip(0.92 * WIDTH * self.ratio(), 1.5 if self.ratio() > SLIM else 2.4, 7.0))

    def here(self):
        return [(name, ring) for name, ring in self.shapes
                if (ring.max(axis=0) > self.low).all() and (ring.min(axis=0) < self.high).all()]

    def draw(self, axes, ghosts):
        """Objects and beams; returns what set_labels() needs."""
        named = draw_objects(axes, self.here(), self.size)
        for place, label in zip(self.plane, (axes.set_xlabel, axes.set_ylabel)):
            label(f"{'xyz'[place]} [m]")
        return named, draw_beams(axes, ghosts, self.plane, self.size)

    def set_labels(self, axes, named, ways):
        """Returns the note about the scale."""
        said = set_scale(axes, self.low, self.high)
        place_labels(axes, {shortened(name, 16): ring for name, ring in named.items()}, ways)
        return said


def draw(beams):
    ghosts = [g for beam in beams for g in beam["ghosts"]][:MOST]
    if not ghosts:
        raise ValueError("no ghost to draw")
    corners = np.vstack([np.array(g["points_m"]) for g in ghosts])
    size = max(np.ptp(corners, axis=0).max(), 1e-3)
    groups = groups_of(corners, size) if objects_are_dots(beams, size) else [corners]
    panels = [Panel(ghosts, beams, points) for points in groups]
    with plt.rc_context(STYLE):
        heights = [p.height() for p in panels]
        figure = plt.figure(figsize=(WIDTH, sum(heights) + 0.6 * len(panels) + 0.6), dpi=100)
        all_axes = figure.subplots(len(panels), 1, squeeze=False, height_ratios=heights)[:, 0]
        orders = sorted({g["order"] for g in ghosts})
        handles = [Line2D([], [], color=COLOURS[min(o, len(COLOURS) - 1)], lw=2 if o == 0 else 1.2,
                          label="main beam" if o == 0 else f"order {o}") for o in orders]
        figure.legend(handles=handles, loc="lower center", ncol=min(len(orders), 7))
        shown, total = sum(g["order"] > 0 for g in ghosts), sum(beam["count"] for beam in beams)
        title = f"Main beam and {shown} of {total} ghosts"
        far = sorted({name for name, _ in panels[0].shapes} - {name for p in panels for name, _ in p.here()})
        if far:
            title += f"; far away: {shortened(', '.join(far), 40)}"
        drawn = [panel.draw(axes, ghosts) for axes, panel in zip(all_axes, panels)]
        all_axes[0].set_title(title, loc="left", fontweight="bold")
        figure.tight_layout(rect=(0, 0.3 / figure.get_figheight(), 1, 1))
        for axes, panel, parts in zip(all_axes, panels, drawn):
            said = panel.set_labels(axes, *parts)
            first = axes is all_axes[0]
            axes.set_title(title + said if first else said.lstrip("; "), loc="left",
                           fontweight="bold" if first else "normal")
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
