# SPDX-License-Identifier: BSD-3-Clause
"""Draws a scan or a response of a network: python3 -m straytrace.plots.ifo ifo.json -o ifo.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from .style import LIGHT, ROUTE_COLOURS, draw_file


def draw_scan(rows, units):
    """One panel per read-out over the scanned parameter."""
    x, *readouts = rows[0]
    turns = units.get(x) == "rad"
    at = np.array([row[x] for row in rows]) * (180 / np.pi if turns else 1)
    figure, panels = plt.subplots(len(readouts), 1, sharex=True, squeeze=False, dpi=100, figsize=(9, 1.5 + 2.2 * len(readouts)))
    for i, (readout, axes) in enumerate(zip(readouts, panels[:, 0])):
        axes.plot(at, [row[readout] for row in rows], color=ROUTE_COLOURS[i % len(ROUTE_COLOURS)], lw=1.5)
        axes.set_ylabel(f"{readout} [{units[readout]}]")
    unit = "deg" if turns else units.get(x, "")
    panels[-1, 0].set_xlabel(f"{x} [{unit}]" if unit else x)
    return figure, panels[:, 0]


def draw_transfer(rows, units, words):
    figure, panels = plt.subplots(2, 1, sharex=True, figsize=(9, 6), dpi=100, height_ratios=(2, 1))
    hz = [row["frequency"] for row in rows]
    panels[0].loglog(hz, [row["magnitude"] for row in rows], color=ROUTE_COLOURS[0])
    panels[0].set_ylabel(f"{words[2]} per {words[1]} [{units['magnitude']}]")
    panels[1].semilogx(hz, np.degrees(np.unwrap([row["phase"] for row in rows])), color=ROUTE_COLOURS[0])
    panels[1].set_ylabel("phase [deg]")
    panels[1].set_xlabel("frequency [Hz]")
    return figure, panels


def draw(answer):
    what = answer["show"][0]
    rows, units = answer[what], answer["units"][what] or {}
    figure, panels = draw_scan(rows, units) if what == "scan" else draw_transfer(rows, units, answer["show"])
    for axes in panels:
        axes.grid(True, which="major", color=LIGHT, lw=0.7)
    figure.tight_layout()
    return figure


def main(arguments=None):
    return draw_file(arguments, "ifo", "Draws a scan or a response of a network.",
                     "answer of straytrace ifo --format json with the key 'show'", draw)


if __name__ == "__main__":
    sys.exit(main())
