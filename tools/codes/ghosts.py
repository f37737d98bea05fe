"""Whole lists of ghost beams against gtrace: where each leaves to, its direction, its radius and its power.

gtrace follows beams in the plane, with stated powers of both faces. Both codes end the beams on a distant sphere.
"""
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from gtrace.beam import GaussianBeam
from gtrace.nonsequential import non_seq_trace
from gtrace.optcomp import Mirror
from scipy.optimize import linear_sum_assignment

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
from straytrace.layouts import read_gtrace, scene_text  # noqa: E402

WEDGE = 1.001                                            # of a wrong layout
WIDE = 1.5
KEYS = ("power", "position", "direction", "radius")


def widened(line, factor):
    """An optic with its edge further out and the same faces: gtrace does not clip beams at edges."""
    return re.sub(r"(use: thick_mirror, radius: |use: lens, diameter: )([0-9.e-]+)", lambda m: f"{m[1]}{factor * float(m[2])!r}", line)


def ours(program, layout, d, edges):
    """[(power, x, y, direction x, y, radius in the plane, radius across)] of beams that reach the sphere."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "layout.yaml"
        lines = []
        for line in scene_text(read_gtrace(layout["name"], layout), "gtrace").splitlines():
            if line == "beams:":
                lines.append(f"  - {{name: dome, shape: {{sphere: {{radius: {d['dome']} m}}}}, side: inner, body: bench, material: black}}")
            lines.append(widened(line.replace(" lit: yes,", ""), edges))
        file.write_text("\n".join([*lines, "receivers: {dome: {on: dome}}", ""]), encoding="utf-8")
        done = subprocess.run([program, "ghosts", file, "--floor", str(d["follow"]), "--format", "json", "--show", "100000", "--quiet"],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            raise SystemExit(done.stderr)
    found = []
    for g in json.loads(done.stdout)[0]["ghosts"]:
        if g["where"] != "dome" or g["power"] < d["threshold"]:
            continue
        across = abs(g["spot_axis"][2]) > 0.5             # the major axis
        inside, outside = (g["spot_minor_m"], g["spot_major_m"]) if across else (g["spot_major_m"], g["spot_minor_m"])
        found.append([g["power"], *g["point_m"][:2], *g["travel"][:2], inside, outside])
    return np.array(found)


def uncut(a, wide):
    """The beams with the power that they have where edges are further out, if they still go the same way there."""
    whole = a.copy()
    for beam in whole:
        gaps = np.linalg.norm(wide[:, 1:5] - beam[1:5], axis=1)
        if gaps.min() < 1e-9:
            beam[0] = wide[gaps.argmin(), 0]
    return whole


def theirs(layout, d):
    def optic(o):
        return Mirror(**{key: value for key, value in o.items() if key != "type"}, HRtransmissive=True)
    s = layout["sources"][0]
    beam = GaussianBeam(q0x=complex(*s["qx"]), q0y=complex(*s["qy"]), pos=s["pos"], dirAngle=s["dirAngle"], wl=s["wl"], P=s["P"])
    beams = non_seq_trace([optic(o) for o in layout["optics"]], beam, order=d["order"], power_threshold=d["follow"])
    found = []
    for b in beams:
        if not getattr(b, "open_end", False) or b.P < d["threshold"]:
            continue
        along = float(np.dot(b.pos, b.dirVect))
        far = -along + math.sqrt(along ** 2 + d["dome"] ** 2 - float(np.dot(b.pos, b.pos)))
        found.append([b.P, *(b.pos + far * b.dirVect), *b.dirVect, *b.width(far)])
    return np.array(found)


def matched(a, b):
    """Pairs of beams, each once: those that land closest with most nearly the same power; and how many are left over."""
    cost = np.minimum(np.linalg.norm(a[:, None, 1:3] - b[None, :, 1:3], axis=2) / 0.1, 10) + np.minimum(abs(np.log(a[:, None, 0] / b[None, :, 0])) / 0.5, 10)
    rows, columns = linear_sum_assignment(cost)
    near = cost[rows, columns] < 1
    return a[rows[near]], b[columns[near]], len(a) + len(b) - 2 * int(near.sum())


def differences(a, b):
    return {"power": abs(a[:, 0] / b[:, 0] - 1), "position": np.linalg.norm(a[:, 1:3] - b[:, 1:3], axis=1),
            "direction": np.linalg.norm(a[:, 3:5] - b[:, 3:5], axis=1), "radius": np.max(abs(a[:, 5:7] / b[:, 5:7] - 1), axis=1)}


def agree(a, b, allowed):
    one, other, left = matched(a, b)
    found = differences(one, other)
    return left == 0 and all(np.all(found[key] < allowed[key]) for key in KEYS), found, left


def changed(layout, what, factor):
    copy = json.loads(json.dumps(layout))
    copy["optics"][0][what] *= factor
    return copy


def draw(axis, lists):
    for i, (name, (a, b)) in enumerate(lists.items()):
        for beams, style in ((b, {"marker": "x", "s": 60}), (a, {"marker": "o", "s": 28, "facecolors": "none"})):
            angles = np.degrees(np.arctan2(beams[:, 4], beams[:, 3]))
            axis.scatter(angles, beams[:, 0], color=f"C{i}", linewidth=0.9, label=f"{name}, {'gtrace' if style['marker'] == 'x' else 'straytrace'}", **style)
    axis.set_yscale("log")
    axis.set_xlabel("direction / deg")
    axis.set_ylabel("power / W")
    axis.legend(fontsize=7)


def run(program, d):
    """(lines of the page, function that draws, whether all agree, controls)."""
    text = ["| layout | beams, straytrace and gtrace | unmatched | power, relative | position at 100 m | direction | radius, relative | verdict | cut at the true edges |",
            "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    fine, controls, lists = True, {}, {}
    for name, layout in d["layouts"].items():
        layout = {"name": name, **layout}
        a, b = ours(program, layout, d, 1), theirs(layout, d)
        whole = uncut(a, ours(program, layout, d, WIDE))
        lost, a = 1 - a[:, 0] / whole[:, 0], whole
        lists[name] = a, b
        good, found, left = agree(a, b, d["allowed"])
        fine = fine and good
        worst = {key: float(found[key].max(initial=0)) for key in KEYS}
        text.append(f"| {name} | {len(a)}, {len(b)} | {left} | {worst['power']:.1e} | {worst['position']:.1e} m | {worst['direction']:.1e} rad | "
                    f"{worst['radius']:.1e} | {'agrees' if good else '**disagrees**'} | "
                    f"{int((lost > 1e-9).sum())} of them, up to {lost.max():.2%} |".replace("%", " %"))
        controls[f"{name}: first wedge 1.001 times as large"] = not agree(a, theirs(changed(layout, "wedgeAngle", WEDGE), d), d["allowed"])[0]
        controls[f"{name}: back of the first optic reflects 1 % more"] = not agree(a, theirs(changed(layout, "Refl_AR", 1.01), d), d["allowed"])[0]
    return text, lambda axis: draw(axis, lists), fine, controls
