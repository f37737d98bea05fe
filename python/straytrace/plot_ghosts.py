# SPDX-License-Identifier: BSD-3-Clause
"""Draws ghost beams: python3 -m straytrace.plot_ghosts GHOSTS.json -o ghosts.png, the JSON of `straytrace ghosts -o`."""

import argparse
import json
import sys

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402

from .words import shortened  # noqa: E402

COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")  # by order; Okabe and Ito
STYLE = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False}
WALLS = 0.35  # of the size of the tree: larger objects, rooms and tables, are left out
MOST = 60  # beams drawn


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


def draw(beams):
    ghosts = [g for beam in beams for g in beam["ghosts"]][:MOST]
    if not ghosts:
        raise ValueError("no ghost to draw")
    corners = np.vstack([np.array(g["points_m"]) for g in ghosts])
    size = max(np.ptp(corners, axis=0).max(), 1e-3)
    x, y = plane_of(corners)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(8.4, 5.4), dpi=100)
        middle = {}
        for surface in {s["object"] + str(i): s for b in beams for i, s in enumerate(b["surfaces"])}.values():
            points = np.array(surface["points_m"])
            name = surface["object"].split("/")[0]
            if np.ptp(points[:, [x, y]], axis=0).max() > WALLS * size:
                continue
            axes.plot(points[:, x], points[:, y], ".", color="#b0b0b0", markersize=1.2, zorder=1)
            middle.setdefault(name, []).append(points[:, [x, y]])
        strongest = max(g["power"] for g in ghosts)
        orders = sorted({g["order"] for g in ghosts})
        for ghost in sorted(ghosts, key=lambda g: -g["order"]):
            way = way_of(ghost, 0.05 * size)
            decades = np.log10(strongest / max(ghost["power"], 1e-300))
            colour = COLOURS[min(ghost["order"], len(COLOURS) - 1)]
            axes.plot(way[:, x], way[:, y], color=colour, linewidth=2.2 if ghost["order"] == 0 else 1.0,
                      alpha=float(np.clip(1 - decades / 20, 0.25, 1)), zorder=2 + (ghost["order"] == 0))
            axes.plot(way[-1, x], way[-1, y], "o", color=colour, markersize=2.5, zorder=4)
        for name, parts in middle.items():
            place = np.vstack(parts)
            axes.annotate(shortened(name, 16), (place[:, 0].mean(), place[:, 1].max()), xytext=(0, 3),
                          textcoords="offset points", ha="center", color="#606060", fontsize=7, zorder=5)
        names = {0: "main beam"}
        axes.legend(handles=[Line2D([], [], color=COLOURS[min(o, len(COLOURS) - 1)], lw=2 if o == 0 else 1.2,
                                    label=names.get(o, f"order {o}")) for o in orders],
                    loc="upper center", bbox_to_anchor=(0.5, -0.12), ncol=min(len(orders), 7))
        axes.set_xlabel(f"{'xyz'[x]} [m]")
        axes.set_ylabel(f"{'xyz'[y]} [m]")
        axes.set_aspect("equal" if np.ptp(corners[:, y]) > 0.05 * np.ptp(corners[:, x]) else "auto")
        total = sum(beam["count"] for beam in beams)
        shown = sum(g["order"] > 0 for g in ghosts)
        axes.set_title(f"Main beam and {shown} of {total} ghosts", loc="left", fontweight="bold")
        figure.tight_layout()
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
