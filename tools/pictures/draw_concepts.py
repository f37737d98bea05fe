#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draw the pictures of docs/guide/concepts.md. Usage: draw_concepts.py PROGRAM [NAME...]

NAME: path, sensitivity, reverse, ports, frames, shadow, wrapping, flow. The curves of `wrapping` are those of the program.
"""
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Polygon, Rectangle

from pictures import ROOT, ROUTE_COLOURS, small

PAGES = ROOT / "docs" / "guide"
BEAM, STRAY, MOVES, REVERSE = ROUTE_COLOURS[0], ROUTE_COLOURS[1], ROUTE_COLOURS[2], ROUTE_COLOURS[3]
MATTER, INK, PALE = "#8a8f98", "#222222", "#dce9f3"
BENCH = """straytrace: 1
bodies:
  ITM: {{motion: still}}
  ETM: {{motion: still}}
  bench:
    motion:
      z:
        - {{line: {{at: 0.35 Hz, width: 0.05 Hz, rms: {rms} rms}}}}
        - {{power-law: {{asd: 1e-8 m/sqrt(Hz), at: 1 Hz, exponent: -2, from: 0.7 Hz, to: 200 Hz}}}}
      others: still
noise: {{band: [3 Hz, 200 Hz], points_per_decade: 60}}
"""


def blank(width, height, xlim, ylim):
    figure, axes = plt.subplots(figsize=(width, height), dpi=110)
    axes.set(xlim=xlim, ylim=ylim, aspect="equal")
    axes.set_axis_off()
    figure.subplots_adjust(0.005, 0.005, 0.995, 0.995)
    return figure, axes


def arrow(axes, start, end, colour, lw=1.8, style="-|>", **more):
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle=style, color=colour, lw=lw, mutation_scale=13, shrinkA=0, shrinkB=0, **more))


def word(axes, x, y, text, colour=INK, size=10, **more):
    axes.text(x, y, text, color=colour, fontsize=size, **{"ha": "center", "va": "center", **more})


def mirror(axes, x, half, facing, name="", y=0.0, sag=0.12, thick=0.35):
    """Section of a concave mirror at x whose face looks along +x (facing 1) or -x (-1)."""
    up = np.linspace(-half, half, 41)
    face = x + facing * sag * (up / half) ** 2
    back = x - facing * thick
    axes.add_patch(Polygon([*zip(face, y + up), (back, y + half), (back, y - half)], closed=True, fc="#e6e8eb", ec=MATTER, lw=1.2))
    word(axes, x - facing * thick / 2, y - half - 0.28, name)


def beam(axes, x1, x2, w1, w2, waist, y=0.0):
    x = np.linspace(0, 1, 101)
    side, away = np.where(x < 0.55, w1 - waist, w2 - waist), np.where(x < 0.55, (0.55 - x) / 0.55, (x - 0.55) / 0.45)
    w = waist + side * abs(away) ** 1.5
    axes.fill_between(x1 + x * (x2 - x1), y - w, y + w, color=PALE, lw=0)
    axes.plot([x1, x2], [y, y], color=BEAM, lw=1.0, ls=(0, (6, 3)))


def baffle(axes, x, inner, outer, lean):
    for sign in (1, -1):
        axes.plot([x, x + lean], [sign * inner, sign * outer], color=MATTER, lw=3, solid_capstyle="round")


def tube(axes, x1, x2, radius):
    for sign in (1, -1):
        axes.plot([x1, x2], [sign * radius, sign * radius], color=MATTER, lw=1.6)


def number(axes, x, y, value, colour=STRAY):
    axes.text(x, y, value, color="white", fontsize=9, ha="center", va="center", fontweight="bold",
              bbox={"boxstyle": "circle,pad=0.25", "fc": colour, "ec": "none"})


def draw_path():
    figure, axes = blank(9.4, 3.5, (-1.3, 14.2), (-2.9, 2.9))
    tube(axes, 0.7, 12.3, 2.0)
    beam(axes, 0, 13, 0.42, 0.55, 0.16)
    mirror(axes, 0, 1.0, 1, "ITM")
    mirror(axes, 13, 1.0, -1, "ETM")
    baffle(axes, 8, 1.45, 2.0, 0.35)
    arrow(axes, (0.05, 0.25), (8.1, 1.62), STRAY)
    arrow(axes, (8.1, 1.72), (0.06, 0.42), STRAY, ls="--")
    number(axes, 0.35, 0.02, "1")
    number(axes, 8.75, 1.5, "2")
    number(axes, 0.55, 0.83, "3")
    word(axes, 6.5, -1.05, "beam in the cavity: the main mode", BEAM)
    word(axes, 8.9, 2.35, "baffle", MATTER)
    word(axes, 11.3, 2.35, "tube", MATTER)
    word(axes, 6.4, -2.55, "route  ITM·S > baffle·S > ITM·S      port  ITM", STRAY, 11, family="monospace")
    return figure


def draw_sensitivity():
    figure, panels = plt.subplots(1, 3, figsize=(9.4, 3.3), dpi=110)
    cases = ((180, r"straight back: $J_z = 2k$"), (0, r"forward: $J_z = 0$"), (115, r"by 115°: $J_z = k(1-\cos 115°)$"))
    for axes, (turn, title) in zip(panels, cases):
        axes.set(xlim=(-2.3, 2.3), ylim=(-1.9, 2.1), aspect="equal")
        axes.set_axis_off()
        away = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
        lift = 0.18 if turn == 180 else 0
        arrow(axes, (-2.1, -lift), (0, -lift), BEAM)
        arrow(axes, (0, lift), tuple(2.0 * away + (0, lift)), STRAY)
        kick = np.array([1, 0]) - away
        if np.hypot(*kick) > 0.1:
            arrow(axes, (0, 0), tuple(kick), MOVES, 2.4)
            word(axes, *(kick + (0.1, -0.32)), r"$\kappa$", MOVES, 12)
        axes.plot(0, 0, "o", color=INK, ms=6, zorder=5)
        word(axes, -1.7, -lift - 0.32, r"$k\,u_{in}$", BEAM)
        word(axes, *(1.45 * away + ((0, 0.5) if turn != 115 else (0.75, 0.0))), r"$k\,u_{out}$", STRAY)
        word(axes, 0, -1.6, title, INK, 10.5)
    figure.subplots_adjust(0.0, 0.0, 1, 1, wspace=0.02)
    return figure


def draw_reverse():
    figure, panels = plt.subplots(1, 2, figsize=(9.4, 3.0), dpi=110)
    for axes in panels:
        axes.set(xlim=(-1.2, 6.6), ylim=(-2.2, 2.2), aspect="equal")
        axes.set_axis_off()
    left, right = panels
    mirror(left, 0, 1.0, 1, "mirror")
    points = ((0.05, 0.45), (4.2, 1.5), (5.2, -1.0), (0.05, -0.45))
    for a, b in zip(points, points[1:]):
        arrow(left, a, b, STRAY)
        arrow(left, (b[0], b[1] - 0.22), (a[0], a[1] - 0.22), REVERSE, ls="--")
    left.plot([4.0, 4.6], [1.75, 1.45], color=MATTER, lw=4)
    left.plot([5.25, 5.45], [-0.75, -1.45], color=MATTER, lw=4)
    word(left, 2.6, -1.95, "two or more vertices: both ways interfere,  $C_{rev} = 2$", INK, 10.5)
    word(left, 2.1, 1.45, "a path", STRAY)
    word(left, 2.55, 0.0, "its reverse: same length,\nsame phase sensitivity", REVERSE)
    mirror(right, 0, 1.0, 1, "mirror")
    right.plot([5.2, 5.2], [-0.6, 0.6], color=MATTER, lw=4)
    right.fill_between([0.05, 5.2], [-0.4, -0.12], [0.4, 0.12], color=PALE, lw=0)
    arrow(right, (0.1, 0.06), (5.15, 0.06), BEAM)
    arrow(right, (5.15, -0.06), (0.1, -0.06), STRAY)
    word(right, 4.9, 0.95, "sensor in the beam")
    word(right, 2.6, -1.95, "one vertex: its own reverse,  $C_{rev} = 1$", INK, 10.5)
    figure.subplots_adjust(0.0, 0.0, 1, 1, wspace=0.02)
    return figure


PLACES = (("input-bench", -5.2, 0.55), ("symmetric-port", -4.5, -1.1), ("recycling-cavity", -1.5, 0.55),
          ("short-arm", 1.5, 0.55), ("arm", 4.35, 0.62), ("end-mirror", 6.5, -1.28), ("end-bench", 8.95, 0.55),
          ("through-end", 8.3, -0.62), ("signal-cavity", 1.25, -1.55), ("as-port", 0.95, -3.9))
SPOTS = ((-5.2, 0), (-4.0, 0), (-1.5, 0), (1.5, 0), (3.05, 0), (6.7, 0), (8.95, 0), (7.45, 0), (0, -1.55), (0, -3.75))


def draw_ports():
    figure, axes = blank(9.4, 5.6, (-6.6, 10.4), (-4.9, 5.3))
    for x1, y1, x2, y2 in ((-6.3, 0, 9.6, 0), (0, 4.6, 0, -4.7)):
        axes.plot([x1, x2], [y1, y2], color=BEAM, lw=2.2, solid_capstyle="butt", zorder=1)
    axes.plot([2.75, 7.05], [0, 0], color=BEAM, lw=6, alpha=0.35, zorder=1)
    axes.plot([0, 0], [2.45, 4.2], color=BEAM, lw=6, alpha=0.35, zorder=1)
    plates = (("PRM", -3.0, 0, "v"), ("ITMx", 2.6, 0, "v"), ("ETMx", 7.05, 0, "v"), ("ITMy", 0, 2.3, "h"), ("ETMy", 0, 4.25, "h"), ("SRM", 0, -2.7, "h"))
    for name, x, y, way in plates:
        w, h = (0.28, 1.5) if way == "v" else (1.5, 0.28)
        axes.add_patch(Rectangle((x - w / 2, y - h / 2), w, h, fc="#e6e8eb", ec=MATTER, lw=1.2, zorder=3))
        word(axes, *((x, y + 1.0) if way == "v" else (x - 1.25, y)), name)
    axes.plot([-0.55, 0.55], [-0.55, 0.55], color=MATTER, lw=4, zorder=3)
    word(axes, -0.75, 0.95, "BS")
    for (name, x, y), (sx, sy) in zip(PLACES, SPOTS):
        axes.plot(sx, sy, "o", color=STRAY, ms=8, zorder=5)
        vertical = sx == 0
        word(axes, x if not vertical else x - 0.55, y, name, STRAY, 10, family="monospace", ha="left" if vertical else "center")
    word(axes, 8.95, -1.15, "bench behind\nthe end mirror", MATTER, 9)
    word(axes, -6.1, -0.45, "laser", BEAM)
    word(axes, 0.35, -4.6, "output", BEAM, ha="left")
    return figure


def draw_frames():
    figure, panels = plt.subplots(1, 3, figsize=(9.4, 3.3), dpi=110)
    for axes in panels:
        axes.set(xlim=(-1.5, 3.2), ylim=(-1.6, 2.5), aspect="equal")
        axes.set_axis_off()
    world, part, body = panels
    for end, name in (((2.6, 0), "z  along the arm"), ((0, 2.0), "y  up"), ((0.95, 0.8), "x  away from you")):
        arrow(world, (0, 0), end, INK, ls="--" if name[0] == "x" else "-")
        word(world, end[0] + (0.85 if name[0] == "x" else -0.5 if name[0] == "z" else 0), end[1] + 0.25, name)
    word(world, 0.9, -1.4, "the scene")
    turn = np.radians(35)
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    at = np.array([0.2, 0.0])
    part.plot(*zip(at - 1.1 * across, at + 1.1 * across), color=BEAM, lw=5, solid_capstyle="butt")
    arrow(part, tuple(at), tuple(at + 2.1 * along), MOVES)
    part.plot(*at, "o", color=STRAY, ms=7, zorder=5)
    word(part, *(at + 1.9 * along + (-0.25, 0.42)), "facing", MOVES)
    word(part, at[0] - 0.1, at[1] - 0.5, "at", STRAY)
    word(part, *(at - 0.55 * along + (-0.05, 0.1)), "back", MATTER)
    word(part, *(at + 0.75 * along - 0.5 * across), "front", MATTER)
    word(part, 0.9, -1.4, "a part: its front looks along 'facing'")
    body.add_patch(FancyBboxPatch((-0.9, -0.2), 3.0, 1.3, boxstyle="round,pad=0.1", fc="#e8f3ee", ec=MOVES, lw=1.2))
    body.plot([-0.4, -0.4], [0.1, 0.9], color=BEAM, lw=4)
    body.plot([1.6, 1.3], [0.1, 0.9], color=BEAM, lw=4)
    body.plot(0.4, 0.35, "o", color=STRAY, ms=7)
    word(body, 0.5, 0.72, "pivot", STRAY)
    arrow(body, (2.35, 0.45), (3.1, 0.45), MOVES)
    word(body, 2.75, 0.75, "z", MOVES)
    arrow(body, (0.1, 1.55), (1.1, 1.55), MOVES, connectionstyle="arc3,rad=-0.5")
    word(body, 0.6, 2.15, "rx", MOVES)
    word(body, 0.9, -1.4, "a body: all its parts move as one")
    figure.subplots_adjust(0, 0, 1, 1, wspace=0.02)
    return figure


def draw_shadow():
    """The construction of docs/theory/arm.md, eq. 8.16, with a tube of radius 2 and a ratio for the eye."""
    figure, axes = blank(9.4, 3.4, (-1.5, 14.3), (-2.75, 2.75))
    wall, inner, half, first = 2.0, 1.35, 0.8, 1.55
    ratio = (wall + half) / (inner + half)
    places = [first * ratio ** i for i in range(9) if first * ratio ** i < 14]
    tube(axes, 0.5, 14.2, wall)
    mirror(axes, 0, half, 1, "mirror", sag=0.06)
    for x in places:
        baffle(axes, x, inner, wall, 0.0)
    for i in (1, 3):
        x1, x2 = places[i], places[i + 1]
        axes.plot([0, x2], [-half, wall], color=STRAY, lw=1.6)
        axes.fill([x1, x1, x2], [inner, wall, wall], color=STRAY, alpha=0.22, lw=0)
    axes.plot(0, -half, "o", color=STRAY, ms=6)
    word(axes, 11.0, -0.4, "from the far edge of the mirror past an inner edge:", STRAY)
    word(axes, 11.0, -0.85, "the next baffle stands where this line meets the wall", STRAY)
    axes.annotate("", (places[5], -2.35), (places[4], -2.35), arrowprops={"arrowstyle": "<->", "color": INK})
    word(axes, (places[5] + places[4]) / 2, -2.58, r"distances grow by $(R_t+R_m)/(R_{clear}+R_m)$", INK, 9.5)
    for radius, x, name in ((inner, 12.6, "$R_{clear}$"), (wall, 13.8, "$R_t$"), (half, -0.7, "$R_m$")):
        arrow(axes, (x, 0), (x, radius), INK, 1.0)
        word(axes, x - 0.42, radius * 0.55, name, INK, 10)
    axes.plot([-0.9, 14.2], [0, 0], color=BEAM, lw=1.0, ls=(0, (6, 3)))
    return figure


def wrapped_curve(program, rms, run, folder):
    motion, out = folder / "motion.yaml", folder / f"out_{rms.replace(' ', '')}"
    motion.write_text(BENCH.format(rms=rms), encoding="utf-8")
    subprocess.run([program, "noise", run, "--motion", motion, "-o", out, "--quiet"], check=True, stdout=subprocess.DEVNULL)
    return np.loadtxt(out / "h_asd.txt", usecols=(0, 1)).T


def draw_wrapping(program):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.4, 3.7), dpi=110)
    t = np.linspace(0, 1, 1500)
    for i, (turns, name, colour) in enumerate(((0.05, "0.3 rad", BEAM), (0.5, "3 rad", MOVES), (4, "25 rad", STRAY))):
        left.plot(t, np.sin(2 * np.pi * turns * np.sin(2 * np.pi * t)) - 2.6 * i, color=colour, lw=1.3)
        word(left, 1.02, -2.6 * i, name, colour, ha="left")
    left.set(xlim=(0, 1.25), yticks=(), xticks=(), title="one period of motion: stray field")
    left.spines[:].set_visible(False)
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        run = folder / "bench.h5"
        subprocess.run([program, "trace", ROOT / "examples/end_bench.yaml", "-o", run, "--histories", "16384", "--quiet"], check=True,
                       stdout=subprocess.DEVNULL)
        for rms, colour in (("20 nm", BEAM), ("200 nm", MOVES), ("2 um", STRAY)):
            f, h = wrapped_curve(program, rms, run, folder)
            right.loglog(f, h, color=colour, lw=1.6, label=f"{rms.replace('um', 'µm')} rms at 0.35 Hz")
    right.set(xlim=(3, 200), xlabel="frequency [Hz]", ylabel=r"strain [1/$\sqrt{\mathrm{Hz}}$]", title="the same bench, three seas",
              xticks=(3, 10, 30, 100), xticklabels=("3", "10", "30", "100"))
    right.legend(frameon=False, fontsize=9)
    right.grid(which="major", alpha=0.3)
    for axes in (left, right):
        axes.title.set_size(10.5)
    figure.tight_layout()
    return figure


def box(axes, x, y, text, colour, width=2.5, height=0.95):
    axes.add_patch(FancyBboxPatch((x - width / 2, y - height / 2), width, height, boxstyle="round,pad=0.04", fc="white", ec=colour, lw=1.6))
    word(axes, x, y, text, INK, 9.5)


def draw_flow():
    figure, axes = blank(9.4, 3.6, (-0.4, 14.4), (-0.7, 5.0))
    steps = ((1.2, 3.0, "scene.yaml\nmirrors, baffles, beam", BEAM), (4.6, 3.0, "trace\nseconds to hours", STRAY), (8.0, 3.0, "run.h5\ncoupling table", BEAM),
             (11.4, 3.0, "noise\na second", STRAY))
    for x, y, text, colour in steps:
        box(axes, x, y, text, colour, 2.7)
    for (x, *_), (to, *_) in zip(steps, steps[1:]):
        arrow(axes, (x + 1.42, 3.0), (to - 1.42, 3.0), INK)
    for x, text in ((9.4, "motion"), (11.4, "interferometer"), (13.4, "design curve")):
        box(axes, x, 4.5, text, MOVES, 1.85, 0.7)
        arrow(axes, (x, 4.1), (11.4 + (x - 11.4) * 0.35, 3.52), INK)
    results = ((4.6, "view, ghosts\nbefore a run"), (8.0, "paths, scan --invert\nwhich surface, how black"), (11.4, "h_asd.txt, report.html\nnoise with its errors"))
    for x, text in results:
        box(axes, x, 0.9, text, MATTER, 3.0)
    arrow(axes, (2.2, 2.45), (4.0, 1.45), INK)
    arrow(axes, (8.0, 2.48), (8.0, 1.45), INK)
    arrow(axes, (11.4, 2.48), (11.4, 1.45), INK)
    word(axes, 6.3, -0.35, "Motion comes last: new motion, another sea or another interferometer needs no new trace.", STRAY, 10)
    return figure


DRAWN = {"path": draw_path, "sensitivity": draw_sensitivity, "reverse": draw_reverse, "ports": draw_ports, "frames": draw_frames,
         "shadow": draw_shadow, "wrapping": draw_wrapping, "flow": draw_flow}


def main(program, names):
    for name in names:
        figure = DRAWN[name](program) if name == "wrapping" else DRAWN[name]()
        with tempfile.TemporaryDirectory() as folder:
            whole = pathlib.Path(folder) / f"{name}.png"
            figure.savefig(whole)
            small(whole, PAGES / f"concept_{name}.png", colours=64)
        plt.close(figure)


if __name__ == "__main__":
    if len(sys.argv) < 2 or set(sys.argv[2:]) - set(DRAWN):
        sys.exit(__doc__)
    main(str(pathlib.Path(sys.argv[1]).resolve()), sys.argv[2:] or list(DRAWN))
