# SPDX-License-Identifier: BSD-3-Clause
"""Draws curves or a map from the JSON of the data commands: python3 -m straytrace.plots.curves CURVES_JSON -o curves.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm, Normalize

from .sheet import draw_json, frame, values
from .style import LIGHT
from .words import shortened

COLOURS = ("#0072B2", "#D00000", "#228833", "#7A00CC", "#E66101", "#00857A", "#7B5B2E", "#8C8CD9")
SIZE = (10.0, 6.0)  # inches at 100 dpi
MORE = 3.5  # for each further unit
MOST_NOTES = 6
SAME = 0.005  # of the largest value: lines closer than this cannot be distinguished


def label(column):
    return f"{column['name']} [{column['unit']}]" if column["unit"] not in ("", "1") else column["name"]


def axis_label(unit, columns):
    """Quantity and unit; many quantities have their names in the legend alone."""
    drawn = (c["name"].removesuffix("_limit") for c in columns if c["style"] in ("line", "points", "upper-limit"))
    names = ", ".join(dict.fromkeys(drawn))
    return " ".join(filter(None, (names if len(names) <= 40 else "", f"[{unit}]" if unit not in ("", "1") else "")))


def clock(x, unit):
    """Times of GPS are counted from the first, which the label names."""
    if unit != "s" or not x.size or abs(x[0]) < 1e6:
        return x, None
    origin = np.floor(x[0])
    return x - origin, f"time after GPS {origin:.0f} [s]"


def errors_of(column, hidden):
    """One standard error of a drawn column: the hidden one of its name and unit."""
    for name in (f"{column['name']}_sigma", "sigma"):
        if name in hidden and hidden[name]["unit"] == column["unit"]:
            return values(hidden[name]["values"])
    return None


def draw_errors(axes, x, y, error, style, tint):
    if style == "points":
        axes.errorbar(x, y, error, fmt="none", ecolor=tint, elinewidth=1, alpha=0.6)
    else:
        axes.fill_between(x, y - error, y + error, color=tint, alpha=0.25, lw=0)


def draw_band(axes, x, low, high, style, tint):
    """Between neighbours a surface; bars where points are drawn, or where a neighbour has none."""
    if style != "points":
        axes.fill_between(x, low, high, color=tint, alpha=0.25, lw=0)
    known = np.isfinite(low) & np.isfinite(high)
    alone = known & ~np.r_[False, known[:-1]] & ~np.r_[known[1:], False]
    bars = known if style == "points" else alone
    if np.any(bars):
        axes.vlines(x[bars], low[bars], high[bars], color=tint, lw=1, alpha=0.6)


def drawn_columns(columns):
    """Columns that are drawn, each with the ends of its band or None."""
    drawn = []
    for column in columns:
        if column["style"] in ("band-low", "band-high"):
            if drawn:
                drawn[-1][1 if column["style"] == "band-low" else 2] = values(column["values"])
        elif column["style"] != "hidden":
            drawn.append([column, None, None])
    return drawn


def same_lines(drawn):
    """Lines that cannot be distinguished: within half a percent of the largest value. Each group is drawn once."""
    largest = max((np.nanmax(np.abs(values(c["values"])), initial=0.0) for c, _, _ in drawn), default=0.0)
    groups = []
    for one in drawn:
        y = values(one[0]["values"])
        for group in groups if one[0]["style"] == "line" and one[1] is None else ():
            other = values(group[0][0]["values"])
            if group[0][0]["style"] == "line" and np.array_equal(np.isfinite(y), np.isfinite(other)) \
                    and np.nanmax(np.abs(y - other), initial=0.0) <= SAME * largest:
                group.append(one)
                break
        else:
            groups.append([one])
    return groups


def draw_points(axes, x, y, band, tint, name):
    """Points without a band, where others have one, are faint: nothing is known of them."""
    sure = np.isfinite(band) if band is not None and np.any(np.isfinite(band)) else np.isfinite(y)
    axes.plot(x[sure], y[sure], ".", color=tint, label=name)
    if np.any(~sure & np.isfinite(y)):
        axes.plot(x[~sure], y[~sure], ".", color=tint, alpha=0.2, ms=3, label=f"{name}, not significant")


def draw_columns(axes, x, columns, hidden, logarithmic):
    drawn = drawn_columns(columns)
    tints = {}
    for group in [[one] for one in drawn] if logarithmic else same_lines(drawn):
        column, low, high = group[0]
        of = column["name"].removesuffix("_limit")  # limits have the colour of what they are limits of
        tint = tints.setdefault(of, COLOURS[len(tints) % len(COLOURS)])
        y, style = values(column["values"]), column["style"]
        if not np.any(np.isfinite(y)):
            continue
        name = "\n".join(shortened(label(c), 48) for c, _, _ in group)
        error = errors_of(column, hidden)
        if low is not None and high is not None:
            draw_band(axes, x, low, high, style, tint)
        elif error is not None:
            draw_errors(axes, x, y, error, style, tint)
        if style == "points":
            draw_points(axes, x, y, low, tint, name)
        elif style == "upper-limit":
            axes.plot(x, y, "v", mfc="none", color=tint, ms=5, label=f"{name}, upper limit")
        else:
            axes.plot(x, y, color=tint, lw=1.3, label=name)


def panels_of(columns):
    """Drawn columns by their unit, in the order of their first: each unit has separate axes."""
    panels = {}
    for column in columns:
        if column["style"] != "hidden":
            panels.setdefault(column["unit"], []).append(column)
    return panels or {"": []}


def known_of(arrays):
    return np.concatenate([a[np.isfinite(a)] for a in arrays] or [np.array([])])


def can_be_logarithmic(arrays):
    return bool(np.any(known_of(arrays) > 0))


def is_narrow(arrays):
    """Within a factor of three, where a logarithmic axis has no labels to speak of."""
    known = known_of(arrays)
    return known.size > 0 and np.min(known) > 0 and np.max(known) < 3 * np.min(known)


def set_x_limits(axes, sheet, x, columns):
    """To the ends; a little further where there are points."""
    room = 0.02 if any(c["style"] in ("points", "upper-limit") for c in columns) else 0.0
    if sheet["log_x"] and can_be_logarithmic([x]):
        axes.set_xscale("log")
        low, high = np.min(x[x > 0]), np.max(x)
        axes.set_xlim(low * (low / high) ** room, high * (high / low) ** room)
    elif x.size > 1:
        axes.set_xlim(x[0] - room * (x[-1] - x[0]), x[-1] + room * (x[-1] - x[0]))


def draw_panel(axes, sheet, unit, columns):
    x, words = clock(values(sheet["x"]["values"]), sheet["x"]["unit"])
    drawn = [values(c["values"]) for c in columns]
    turns = unit == "deg"
    logarithmic = sheet["log_y"] and not turns and can_be_logarithmic(drawn) and not is_narrow(drawn)
    draw_columns(axes, x, columns, {c["name"]: c for c in sheet["y"] if c["style"] == "hidden"}, logarithmic)
    set_x_limits(axes, sheet, x, columns)
    if logarithmic:
        axes.set_yscale("log", nonpositive="mask")
    if turns:
        axes.set(ylim=(-190, 190), yticks=range(-180, 181, 90))
    axes.set_ylabel(axis_label(unit, columns))
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="best")
    axes.grid(True, which="major", color=LIGHT, lw=0.7)
    axes.set_axisbelow(True)
    return words or label(sheet["x"])


def draw_sheet(figure, sheet):
    panels = panels_of(sheet["y"])
    all_axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (unit, columns) in zip(all_axes, panels.items()):
        words = draw_panel(axes, sheet, unit, columns)
    axes.set_xlabel(words)
    return all_axes[0]


def edges(centres):
    centres = np.asarray(centres, dtype=float)
    if centres.size < 2:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    middle = (centres[1:] + centres[:-1]) / 2
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])


def draw_map(figure, axes, sheet):
    f = np.array(sheet["frequency_Hz"], dtype=float)
    z = np.array([values(row) for row in sheet["value"]])
    origin = np.floor(sheet["time_s"][0]) if abs(sheet["time_s"][0]) >= 1e6 else 0.0
    known = z[np.isfinite(z) & (z > 0)]
    low, high = (np.percentile(known, 1), known.max()) if known.size else (1, 10)
    norm = LogNorm(low, max(high, low * 1.0001)) if sheet["unit"] != "1" else Normalize(0, max(high, 1e-9))
    times = edges(np.array(sheet["time_s"]) - origin)
    mesh = axes.pcolormesh(times, edges(f), z.T, norm=norm, cmap="viridis", rasterized=True)
    axes.set_xlim(times[0], times[-1])
    if f.size > 1 and f[0] >= 0:
        positive = f[f > 0]
        axes.set_ylim(positive[0] if positive.size else 0, f[-1])
        if positive.size > 2 and positive[-1] / positive[0] > 30:
            axes.set_yscale("log")
    for column, colour in zip(sheet["lines"], ("white", "#ff6666", "#ffcc00", "#66ffff") * len(sheet["lines"])):
        axes.plot(np.array(sheet["line_time_s"]) - origin, values(column["values"]), color=colour, lw=1.0,
                  label=shortened(column["name"], 40))
    if sheet["lines"]:
        axes.legend(loc="upper right", frameon=True, facecolor="#333333", labelcolor="white")
    bar = figure.colorbar(mesh, ax=axes)
    quantity = "ASD " if sheet["unit"].endswith("/sqrt(Hz)") else ""
    bar.set_label(f"{quantity}[{sheet['unit']}]" if sheet["unit"] != "1" else "normalised")
    axes.set(xlabel=f"time after GPS {origin:.0f} [s]" if origin else "time [s]", ylabel="frequency [Hz]")


def picture(sheet):
    panels = 1 if "frequency_Hz" in sheet else len(panels_of(sheet["y"]))
    figure = plt.figure(figsize=(SIZE[0], SIZE[1] + MORE * (panels - 1)), dpi=100)
    if "frequency_Hz" in sheet:
        axes = figure.add_subplot()
        draw_map(figure, axes, sheet)
    else:
        axes = draw_sheet(figure, sheet)
    frame(figure, axes, sheet["title"], 90, "\n".join(shortened(note, 150) for note in sheet["notes"][:MOST_NOTES]))
    return figure


def main(arguments=None):
    return draw_json("straytrace.plots.curves", __doc__, picture, arguments)


if __name__ == "__main__":
    sys.exit(main())
