# SPDX-License-Identifier: BSD-3-Clause
"""Draws a scan, a response, a noise, loops or error signals of a network: python3 -m straytrace.plots.ifo ifo.json -o ifo.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from .style import LIGHT, ROUTE_COLOURS, draw_file


LEGEND_HEIGHT = 0.4  # inches, below the panels


def draw_scan(rows, units):
    """One panel per read-out over the scanned parameter; what is rounding, null, is drawn as 0."""
    x, *readouts = rows[0]
    turns = units.get(x) == "rad"
    at = np.array([row[x] for row in rows]) * (180 / np.pi if turns else 1)
    figure, panels = plt.subplots(len(readouts), 1, sharex=True, squeeze=False, dpi=100, figsize=(9, 1.5 + 2.2 * len(readouts)))
    for i, (readout, axes) in enumerate(zip(readouts, panels[:, 0])):
        axes.plot(at, [row[readout] or 0 for row in rows], color=ROUTE_COLOURS[i % len(ROUTE_COLOURS)], lw=1.5)
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


def draw_stray(rows, units, words):
    """Both quadratures of the stray field."""
    figure, panels = plt.subplots(2, 1, sharex=True, figsize=(9, 6), dpi=100, height_ratios=(2, 1))
    hz = [row["frequency"] for row in rows]
    for i, (part, name) in enumerate((("phase", "Im s"), ("amplitude", "Re s"))):
        seen = [row for row in rows if row[part] is not None]
        panels[0].loglog([row["frequency"] for row in seen], [row[part] for row in seen], color=ROUTE_COLOURS[i], label=f"per {name}")
        panels[1].semilogx([row["frequency"] for row in seen], np.degrees(np.unwrap([row[f"arg_{part}"] for row in seen])),
                           color=ROUTE_COLOURS[i])
    unit = units.get("phase")
    panels[0].set_ylabel(f"{words[2]} per field of {words[1]}" + (f" [{unit}]" if unit else ""))
    panels[0].legend(frameon=False)
    panels[0].set_xlim(min(hz), max(hz))
    panels[1].set_ylabel("phase [deg]")
    panels[1].set_xlabel("frequency [Hz]")
    return figure, panels


def panels_in_rows(count, most=3, width=4.5, height=4.2, **keys):
    """Axes for `count` panels, at most `most` side by side; unused ones are removed."""
    columns = min(count, most)
    rows = -(-count // columns)
    figure, panels = plt.subplots(rows, columns, squeeze=False, dpi=100, figsize=(0.5 + width * columns, height * rows), **keys)
    for unused in panels.flat[count:]:
        unused.remove()
    return figure, list(panels.flat[:count])


def draw_map(rows, units):
    """One panel per read-out over two scanned parameters."""
    a, b, *readouts = rows[0]
    axes_values = [sorted({row[key] for row in rows}) for key in (a, b)]
    shape = len(axes_values[1]), len(axes_values[0])
    scales = [180 / np.pi if units.get(key) == "rad" else 1 for key in (a, b)]
    named = [f"{key} [{'deg' if units.get(key) == 'rad' else units[key]}]" if units.get(key) else key for key in (a, b)]
    figure, panels = panels_in_rows(len(readouts))
    place = {key: {value: i for i, value in enumerate(values)} for key, values in zip((a, b), axes_values)}
    for readout, axes in zip(readouts, panels):
        grid = np.full(shape, np.nan)
        for row in rows:
            grid[place[b][row[b]], place[a][row[a]]] = row[readout] or 0
        signed = np.nanmin(grid) < 0
        most = np.nanmax(np.abs(grid))
        drawn = axes.pcolormesh(np.array(axes_values[0]) * scales[0], np.array(axes_values[1]) * scales[1], grid, shading="nearest",
                                cmap="RdBu_r" if signed else "viridis", vmin=-most if signed else None, vmax=most if signed else None)
        figure.colorbar(drawn, ax=axes, label=f"{readout} [{units[readout]}]")
        axes.set_xlabel(named[0])
        axes.set_ylabel(named[1])
    return figure, []


def draw_noise(rows, units, of):
    figure, axes = plt.subplots(figsize=(9, 6), dpi=100)
    hz = [row["frequency"] for row in rows]
    if "as_read" in rows[0]:
        axes.loglog(hz, [row["as_read"] if row["as_read"] is not None else np.nan for row in rows], label="without subtraction",
                    color="black", lw=1, ls="--")
    for i, name in enumerate(key for key in rows[0] if key not in ("frequency", "total", "as_read")):
        axes.loglog(hz, [row[name] if row[name] is not None else np.nan for row in rows], label=name,
                    color=ROUTE_COLOURS[i % len(ROUTE_COLOURS)])
    axes.loglog(hz, [row["total"] if row["total"] is not None else np.nan for row in rows], label="total", color="black", lw=2)
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel(f"noise of {of} [{units['total']}]")
    axes.legend()
    return figure, [axes]


def draw_suppression(rows):
    """Suppression of each loop, and its gain, over frequency."""
    figure, panels = plt.subplots(2, 1, sharex=True, figsize=(9, 7), dpi=100)
    hz = [row["frequency"] for row in rows]
    lengths = [key.removeprefix("gain_") for key in rows[0] if key.startswith("gain_")]
    for i, length in enumerate(lengths):
        for axes, key in zip(panels, (length, f"gain_{length}")):
            axes.loglog(hz, [row[key] if row[key] is not None else np.nan for row in rows], label=length,
                        color=ROUTE_COLOURS[i % len(ROUTE_COLOURS)])
    panels[0].set_ylabel("suppression |1/(1 + G)|")
    panels[1].set_ylabel("open-loop gain |G|")
    panels[1].set_xlabel("frequency [Hz]")
    panels[0].legend(frameon=False)
    return figure, panels


def draw_radar(rows):
    """One panel per demodulated read-out: each degree of freedom at its best phase, with its slope on a logarithmic radius."""
    signals = [row for row in rows if row["best_phase"] is not None]
    if not signals:
        raise ValueError("no demodulated read-out responds to a degree of freedom")
    names = list(dict.fromkeys(row["readout"] for row in signals))
    freedoms = list(dict.fromkeys(row["freedom"] for row in signals))
    figure, panels = panels_in_rows(len(names), subplot_kw={"projection": "polar"})
    for name, axes in zip(names, panels):
        shown = [row for row in signals if row["readout"] == name]
        floor = np.floor(np.log10(min(row["best_slope"] for row in shown))) - 1
        top = np.ceil(np.log10(max(row["best_slope"] for row in shown)))
        for row in shown:
            colour = ROUTE_COLOURS[freedoms.index(row["freedom"]) % len(ROUTE_COLOURS)]
            axes.plot([row["best_phase"]] * 2, [0, np.log10(row["best_slope"]) - floor], color=colour, lw=2.5, label=row["freedom"])
        ticks = np.arange(1, top - floor + 1, max(1, (top - floor) // 4))
        axes.set_rlim(0, top - floor)
        axes.set_rticks(ticks, [f"1e{int(floor + tick)}" for tick in ticks], fontsize=8, color="grey")
        axes.set_title(f"{name}: slope [W/m]", loc="center", fontsize=11, pad=14)
    handles = [Line2D([], [], color=ROUTE_COLOURS[i % len(ROUTE_COLOURS)], lw=2.5, label=freedom) for i, freedom in enumerate(freedoms)]
    figure.legend(handles=handles, loc="lower center", ncols=len(freedoms))
    return figure, panels


def draw(answer):
    words = answer["show"]
    sheet = {"noise": "strain_noise"}.get(words[1], words[1]) if words[0] == "loops" else words[0]
    rows, units = answer[sheet], answer["units"][sheet] or {}
    if words[0] == "errors":
        figure, panels = draw_radar(rows)
    elif words[0] == "noise":
        figure, panels = draw_noise(rows, units, words[1])
    elif sheet == "strain_noise":
        figure, panels = draw_noise(rows, units, "the strain")
    elif sheet == "suppression":
        figure, panels = draw_suppression(rows)
    elif words[0] in ("transfer", "stray"):
        stray = words[0] == "stray" or words[1].startswith("stray:")
        figure, panels = (draw_stray if stray else draw_transfer)(rows, units, [words[0], words[1].removeprefix("stray:"), words[2]])
    else:
        figure, panels = draw_map(rows, units) if len(words) == 7 else draw_scan(rows, units)
    for axes in panels:
        axes.grid(True, which="major", color=LIGHT, lw=0.7)
    figure.tight_layout(rect=(0, LEGEND_HEIGHT / figure.get_figheight() if words[0] == "errors" else 0, 1, 1))
    return figure


def main(arguments=None):
    return draw_file(arguments, "ifo", "Draws a scan, a response, a noise, loops or error signals of a network.",
                     "answer of straytrace ifo --format json with the key 'show'", draw)


if __name__ == "__main__":
    sys.exit(main())
