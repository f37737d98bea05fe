# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the page of benchmarks. The sha256 of the lines of each picture is in its text chunk."""
import hashlib
import json
import struct

from record import newest

BLUE, RED, GREY = "#1f77b4", "#d62728", "#666666"


def growth(lines, figure):
    """One panel per thing that grows: seconds to the left, memory to the right, both logarithmic."""
    groups = list(dict.fromkeys(line["group"] for line in lines))
    figure.set_size_inches(11, 3.4 * ((len(groups) + 2) // 3))
    for axes, group in zip(figure.subplots((len(groups) + 2) // 3, 3, squeeze=False).flat, groups):
        points = [line for line in lines if line["kind"] == "point" and line["group"] == group]
        n = [line["n"] for line in points]
        for quantity, name, style in (("setup", "setup", "o-"), ("per_history", "1e6 histories", "s-"), ("noise", "noise", "^-"),
                                      ("merge", "merge", "v-")):
            if quantity in points[0]:
                seconds = [line[quantity] * (1e6 if quantity == "per_history" else 1) for line in points]
                half = [y * (line.get(f"{quantity}_spread") or 0) / 2 for y, line in zip(seconds, points)]
                axes.errorbar(n, seconds, half, fmt=style, color=BLUE, alpha=0.55 if quantity == "setup" else 1, label=name, capsize=2,
                              markersize=4)
        memory = axes.twinx()
        memory.plot(n, [line["memory"] / 1e6 for line in points], "x--", color=RED, markersize=4)
        for one, colour, label in ((axes, BLUE, "s"), (memory, RED, "peak memory [MB]")):
            one.set_xscale("log")
            one.set_yscale("log")
            low, high = one.get_ylim()
            one.set_ylim(low / 2, max(high * 2, 10 * low))
            one.set_ylabel(label, color=colour)
            one.tick_params(axis="y", colors=colour, which="both")
        axes.set_title(f"against the number of {group}")
        axes.grid(True, alpha=0.3)
        axes.legend(loc="upper left", fontsize="small", frameon=False)
    for axes in figure.axes[len(groups):]:
        if not axes.has_data():
            axes.set_visible(False)


def engine(lines, figure):
    """Ratios with their spread, and goals where they are of ratios."""
    lines = [line for line in lines if line.get("ratio")][::-1]
    figure.set_size_inches(10, 0.3 * len(lines) + 1)
    axes = figure.subplots()
    for k, line in enumerate(lines):
        half = line["ratio"] * line["spread"] / 2
        axes.errorbar(line["ratio"], k, xerr=min(half, 0.9 * line["ratio"]), fmt="o", color=BLUE, markersize=4, capsize=2)
        if line.get("goal", {}).get("of") == "ratio":
            axes.plot(line["goal"]["at_least"], k, "|", color=RED, markersize=11, markeredgewidth=2)
    axes.set_yticks(range(len(lines)), [line["case"] for line in lines], fontsize="small")
    axes.set_xscale("log")
    axes.axvline(1, color=GREY, linewidth=0.8)
    axes.set_xlabel("ratio, straytrace over the other; red: goal")
    axes.grid(True, axis="x", which="both", alpha=0.3)


DRAWN = {"engine": engine, "growth": growth}             # bench: function (lines, figure)


def mark(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def picture_of(pages, bench):
    return pages / f"benchmarks_{bench}.png"


def mark_in(png):
    """The text chunk "Source" of a PNG, None if there is none."""
    data, at = png.read_bytes(), 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"tEXt" and data[at + 8:].startswith(b"Source\0"):
            return data[at + 15:at + 8 + size].decode()
        at += 12 + size
    return None


def outdated(pages, folder):
    for bench in DRAWN:
        lines, png = folder / f"{bench}.jsonl", picture_of(pages, bench)
        if lines.exists() and (not png.exists() or mark_in(png) != mark(lines)):
            yield f"{png.name} is not drawn from {lines.name} as it is"


def draw(pages, folder):
    from matplotlib.figure import Figure                 # only here: the check needs no libraries
    for bench, function in DRAWN.items():
        file = folder / f"{bench}.jsonl"
        if file.exists():
            figure = Figure(layout="constrained")
            function(newest([json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]), figure)
            figure.savefig(picture_of(pages, bench), dpi=110, metadata={"Source": mark(file)})
