#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of budgets, ghosts and curves from made-up numbers: their curves and texts, and that no name hides another."""
import itertools
import pathlib
import re
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(SOURCE / "python"), str(SOURCE / "tools/pictures")]
sys.dont_write_bytecode = True

import numpy as np  # noqa: E402

from PIL import Image  # noqa: E402

import draw_shapes  # noqa: E402
import pictures  # noqa: E402
from straytrace.plots import budget as plot_budget  # noqa: E402
from straytrace.plots import curves as plot_curves  # noqa: E402
from straytrace.plots import ghosts as plot_ghosts  # noqa: E402
from straytrace.plots import optimise as plot_optimise  # noqa: E402
from straytrace.plots import style  # noqa: E402

plt = plot_budget.plt


def budget(runs=1, sigma=0.1):
    f = np.geomspace(5, 500, 40)
    stray = [{"name": f"StrayLight-{i}", "kind": "stray light", "strain": list(1e-23 / f), "sigma": list(sigma * 1e-23 / f),
              "note": "a lower bound, 1 route is not resolved" if i == 0 else ""} for i in range(runs)]
    noises = [{"name": "Quantum", "kind": "fundamental", "strain": [None] + [1e-23] * 39},
              {"name": "dark", "kind": "technical", "strain": [1e-24] * 40}]
    for one in stray[:1]:                         # the others state nothing but their Monte-Carlo error
        one |= {f"speckle_{p}": list(x * 1e-23 / f) for p, x in (("05", 0.3), ("50", 0.9), ("95", 1.7))}
        one |= {"input_low": list(0.5e-23 / f), "input_high": list(2e-23 / f), "inputs_stated": True}
    curves = {"frequency_Hz": list(f), "noises": noises + stray, "total": [2e-23] * 40,
              "curves": [{"name": "adv-lal", "strain": [5e-23] * 40}], "lines": [{"name": "quantum limit", "strain": list(1e-22 / f)}]}
    about = [{"name": s["name"], "file": "a/run.h5", "title": "", "model_hash": "0123456789abcdef", "seed": 7,
              "histories": 4096, "created": "2024-05-01T12:00:00Z"} for s in stray]
    return {"title": "made up", "version": "0.1.0", "commit": "abc", "created": "2024-05-01T12:00:00Z", "margin": 0.1,
            "runs": about, "curves": curves}


def check_budget(folder):
    figure = plot_budget.picture(budget())
    axes = figure.axes[0]
    labels = [t.get_text() for t in axes.get_legend().get_texts()]
    assert labels[:5] == ["total", "StrayLight-0 (lower bound)", "stated input uncertainty", "one realisation: 5 to 95 %",
                          "± one standard error (≤ 10 %)"], labels
    lines = {line.get_label(): line for line in axes.lines}
    widest = max(axes.lines, key=lambda line: line.get_linewidth())
    assert widest is lines["total"] and widest.get_linestyle() == "-"
    for drawn, (low, high) in zip(axes.collections, ((0.3, 1.7), (0.5, 2), (0.9, 1.1)), strict=True):
        band = drawn.get_paths()[0].vertices[:, 1]
        np.testing.assert_allclose([band.min(), band.max()], [low * 1e-23 / 500, high * 1e-23 / 5], rtol=1e-6)
    assert np.isnan(lines["Quantum"].get_ydata()[0])          # not known is not drawn
    said = figure.texts[0].get_text()
    for words in ("straytrace 0.1.0 (abc)", "2024-05-01", "a/run.h5", "model 0123456789ab", "seed 7", "4 096 histories"):
        assert words in said, said
    figure.canvas.draw()
    assert figure.texts[0].get_window_extent().y1 < axes.get_tightbbox().y0     # the footer is below
    assert "and 2 more runs" in plot_budget.footer(budget(runs=5))
    colours = {line.get_color() for line in plot_budget.picture(budget(runs=3)).axes[0].lines if "Stray" in line.get_label()}
    assert len(colours) == 3
    plt.close("all")
    (folder / "bad.json").write_text("{}")
    assert plot_budget.main([str(folder / "bad.json"), "-o", str(folder / "bad.png")]) == 2
    assert not (folder / "bad.png").exists()


def disk(name, centre, normal_is_z=True, radius=0.02):
    r, t = np.meshgrid(np.linspace(0, radius, 8), np.linspace(0, 2 * np.pi, 20))
    u, v, zero = (r * np.cos(t)).ravel(), (r * np.sin(t)).ravel(), np.zeros(r.size)
    points = np.stack([u, v, zero] if normal_is_z else [zero, u, v], axis=1) + centre
    return {"object": name, "points_m": points.tolist()}


def room(low, high):
    random = np.random.default_rng(1).random((400, 3))
    points = np.array(low) + random * (np.array(high) - low)
    side = np.random.default_rng(2).integers(0, 3, 400)
    points[np.arange(400), side] = np.where(random[:, 0] < 0.5, np.array(low)[side], np.array(high)[side])
    return {"object": "box/wall", "points_m": points.tolist()}


def ghost(order, points, power=1e-3):
    return {"order": order, "points_m": points, "power": power, "end": "land", "travel": [0, 0, 1]}


def tree():
    ghosts = [ghost(0, [[0, 0, 0], [0, 0, 0.8], [0.3, 0, 0.8]], 1),
              ghost(1, [[0, 0, 0.3], [0.01, 0, 0.05]]), ghost(2, [[0, 0, 0.5], [-0.1, 0, 1.05]])]
    surfaces = [disk("lens_1/front", [0, 0, 0.30]), disk("mount/front", [0, 0, 0.31]), disk("lens_2/front", [0, 0, 0.32]),
                disk("end/front", [0.3, 0, 0.8], False), room([-0.2, -0.1, 0.05], [0.4, 0.1, 1.05])]
    return [{"count": 2, "ghosts": ghosts, "surfaces": surfaces}]


def boxes(figure):
    figure.canvas.draw()
    return {t.get_text(): t.get_window_extent() for t in figure.axes[0].texts}


def check_ghosts():
    figure = plot_ghosts.draw(tree())
    axes, names = figure.axes[0], boxes(figure)
    assert axes.get_aspect() == 1 and "stretched" not in axes.get_title(loc="left")
    assert set(names) == {"lens_1", "mount", "lens_2", "end", "box"}, names
    for (a, one), (b, two) in itertools.combinations(names.items(), 2):
        assert not one.overlaps(two), (a, b)
    walls = [line.get_xydata() for line in axes.lines if line.get_color() == "#a8a8a8"]
    assert len(walls) == 1
    np.testing.assert_allclose([walls[0].min(axis=0), walls[0].max(axis=0)], [[0.05, -0.2], [1.05, 0.4]], atol=1e-6)
    long_arm = [{"count": 0, "ghosts": [ghost(0, [[0, 0, 0], [0, 0, 3000], [0.3, 0, 3000]], 1)], "surfaces": []}]
    assert "the vertical axis is stretched" in plot_ghosts.draw(long_arm).axes[0].get_title(loc="left")
    plt.close("all")


def far_bench():
    """A bench of 3 m at the end of 3 km."""
    ghosts = [ghost(0, [[0, 0, 0], [0, 0, 3000], [0, 0, 3002], [0.4, 0, 3003]], 1), ghost(1, [[0, 0, 3002], [0, 0, 3000]])]
    surfaces = [disk("ITM/front", [0, 0, 0], radius=0.2), disk("ETM/front", [0, 0, 3000], radius=0.2),
                disk("lens/front", [0, 0, 3002], radius=0.1), disk("sensor/front", [0.4, 0, 3003])]
    return [{"count": 1, "ghosts": ghosts, "surfaces": surfaces}]


def check_far_bench():
    """The view is where the ghosts are."""
    axes = plot_ghosts.draw(far_bench()).axes[0]
    low, high = axes.get_xlim()
    assert 2999 < low < 3000 and 3003 < high < 3004, (low, high)
    assert "stretched" not in axes.get_title(loc="left") and "far away: ITM" in axes.get_title(loc="left")
    dot, plot_ghosts.DOT = plot_ghosts.DOT, 0
    low, high = plot_ghosts.draw(far_bench()).axes[0].get_xlim()
    assert high - low > 3000, "control: one view of all, where the bench is a dot"
    plot_ghosts.DOT = dot
    plt.close("all")


def column(name, unit, level, style="line"):
    return {"name": name, "unit": unit, "values": [level, 2 * level, 3 * level], "style": style}


def check_errors(sheet, points):
    """Errors of the hidden column are drawn, points at the ends are complete, absent parts have no legend."""
    nothing = column("upper_limit", points["unit"], 1, "upper-limit") | {"values": [None] * 3}
    error = column("h_driven_sigma", points["unit"], 1e-24, "hidden")
    axes = plot_curves.picture(sheet | {"y": [points, error, nothing]}).axes[0]
    assert len(axes.collections) == 1, "error bars"
    assert axes.get_xlim()[0] < 10 and axes.get_xlim()[1] > 30
    assert [t.get_text() for t in axes.get_legend().get_texts()] == ["h_driven [1/sqrt(Hz)]"]
    bare = plot_curves.picture(sheet | {"y": [points, error | {"name": "count_sigma"}]}).axes[0]
    assert not bare.collections, "control: the error of another column"
    narrow = points | {"values": [4e-23, 5e-23, 6e-23]}
    assert plot_curves.picture(sheet | {"y": [narrow]}).axes[0].get_yscale() == "linear"
    assert axes.get_yscale() == "log"


def check_curves():
    coupling = [column("predicted", "1/m", 1e-17), column("predicted_low", "1/m", 9e-18, "band-low"),
                column("predicted_high", "1/m", 1.1e-17, "band-high")]
    noise = [column("h_driven", "1/sqrt(Hz)", 1e-23, "points"), column("count", "s", 1, "hidden")]
    sheet = {"title": "made up", "notes": ["one", "two"], "x": {"name": "frequency", "unit": "Hz", "values": [10, 20, 30]},
             "log_x": True, "log_y": True, "y": coupling + noise}
    panels = plot_curves.picture(sheet).axes
    assert [a.get_ylabel() for a in panels] == ["predicted [1/m]", "h_driven [1/sqrt(Hz)]"], "each unit has axes of its own"
    assert panels[0].get_ylim()[1] < 1e-16 and panels[1].get_ylim()[1] < 1e-22
    assert panels[1].get_xlabel() == "frequency [Hz]"
    check_errors(sheet, noise[0])
    many = [column(f"coupling of the {place} to h", "1/m", 1e-17) for place in ("link", "bench")]
    assert plot_curves.picture(sheet | {"y": many}).axes[0].get_ylabel() == "[1/m]", "many names are in the legend alone"
    alone = plot_curves.picture(sheet | {"y": coupling})
    assert len(alone.axes) == 1 and tuple(alone.get_size_inches()) == plot_curves.SIZE
    plt.close("all")


def check_documents(folder):
    """A picture made smaller for the documents keeps its curves distinguishable, and states its origin."""
    figure = plt.figure(figsize=(6, 4), dpi=100)
    axes = figure.add_axes((0.1, 0.15, 0.85, 0.8))
    axes.imshow(np.random.default_rng(1).random((40, 60, 3)), aspect="auto", extent=(0, 6, 0, 3))     # takes all of a palette
    for k, colour in enumerate(style.ROUTE_COLOURS):
        axes.plot([0, 6], [3.5 + 0.5 * k] * 2, color=colour, lw=1)
    axes.set_ylim(0, 7)
    figure.text(0.1, 0.01, "straytrace 0.1.0 (abc)    model 01")
    style.save(figure, folder / "whole.png")
    plt.close("all")
    pictures.small(folder / "whole.png", folder / "small.png")
    with Image.open(folder / "small.png") as image:
        assert image.mode == "P" and image.text["Software"].startswith("straytrace 0.1.0 (abc)"), image.text
    routes = [tuple(bytes.fromhex(c[1:])) for c in style.ROUTE_COLOURS]

    def seen(image):
        return {colour for _, colour in image.convert("RGB").getcolors(1 << 24)} & set(routes)

    whole = Image.open(folder / "whole.png")
    assert seen(whole) == seen(Image.open(folder / "small.png")) == set(routes)
    assert len(seen(whole.convert("RGB").quantize(48))) < len(routes), "control: few colours, shared by curves"


def bare_sheet(columns, log_y=False):
    return {"title": "made up", "notes": [], "x": {"name": "f", "unit": "Hz", "values": [10, 20, 30, 40]}, "log_x": True,
            "log_y": log_y, "y": columns}


def four(name, unit, values, style="line"):
    return {"name": name, "unit": unit, "values": values, "style": style}


def check_significance():
    """A transfer function: bars where the coherence is significant, faint points elsewhere, a panel of the phase."""
    known = [four("modulus", "m", [1, 2, 3, 4], "points"), four("modulus_low", "m", [0.9, 1.8, None, None], "band-low"),
             four("modulus_high", "m", [1.1, 2.2, None, None], "band-high"),
             four("phase", "deg", [10, 20, 170, -170], "points"), four("phase_low", "deg", [5, 15, None, None], "band-low"),
             four("phase_high", "deg", [15, 25, None, None], "band-high")]
    modulus, phase = plot_curves.picture(bare_sheet(known, True)).axes
    assert [t.get_text() for t in modulus.get_legend().get_texts()] == ["modulus [m]", "modulus [m], not significant"]
    sure, faint = modulus.lines
    assert list(sure.get_xdata()) == [10, 20] and list(faint.get_xdata()) == [30, 40] and faint.get_alpha() < 0.5
    bars = [line for c in modulus.collections for line in c.get_segments()]
    assert np.allclose(sorted(line[:, 1].tolist() for line in bars), [[0.9, 1.1], [1.8, 2.2]])
    assert phase.get_yscale() == "linear" and phase.get_ylim() == (-190, 190)
    bare = plot_curves.picture(bare_sheet(known[:1], True)).axes[0]
    assert len(bare.lines) == 1, "control: without a band nothing is faint"
    plt.close("all")


def check_limits():
    """A limit has the colour of its place, another place another."""
    places = [four("a", "1/N", [1, 2, None, None], "points"), four("a_limit", "1/N", [None, None, 3, 3], "upper-limit"),
              four("b", "1/N", [5, 6, 7, 8], "points")]
    a, limit, b = plot_curves.picture(bare_sheet(places)).axes[0].lines
    assert limit.get_marker() == "v" and a.get_color() == limit.get_color() != b.get_color()
    plt.close("all")


def check_same_lines():
    """Lines on one another are one, with all names; those a percent apart are two."""
    for off, lines in ((1.001, 1), (1.02, 2)):
        columns = [four("a", "Hz", [1, 2, 3, 2]), four("b", "Hz", [off * v for v in (1, 2, 3, 2)])]
        axes = plot_curves.picture(bare_sheet(columns)).axes[0]
        labels = "\n".join(t.get_text() for t in axes.get_legend().get_texts())
        assert len(axes.lines) == lines and labels == "a [Hz]\nb [Hz]", (lines, labels)
    plt.close("all")


def candidate(cost, ratio, met, front):
    limit = {"ratio": {"value": ratio, "sigma": 0.01}, "upper": ratio + 0.02, "standard_errors": 2, "frequency_Hz": 10}
    return {"settings": {}, "objective": cost, "met": met, "front": front, "traced": True, "limits": [limit]}


def check_search():
    """Filled points meet the limits; the front is a line of steps; a candidate that was not traced has no point."""
    found = [candidate(1, 1.5, False, True), candidate(2, 0.9, True, True), candidate(3, 0.95, True, False),
             candidate(4, 0.1, True, False) | {"traced": False}]
    axes = plot_optimise.draw({"model": "made up", "minimise": "cost", "complete": True, "limits": ["h_total < line"],
                               "candidates": found, "finalists": [candidate(2, 0.92, True, False)], "best": 0}).axes[0]
    lines = {line.get_label(): line for line in axes.lines}
    np.testing.assert_allclose(lines["front"].get_xydata(), [[1, 1.5], [2, 0.9]])
    points = {box.get_label(): box.lines[0] for box in axes.containers}
    assert list(points["meets the limits"].get_xdata()) == [2, 3] and list(points["does not"].get_xdata()) == [1]
    assert points["does not"].get_markerfacecolor() == "white" and "best, fresh seed" in points
    plt.close("all")


def check_dimensions():
    """Every parameter of a shape and of a part is drawn, and no other."""
    def keys_of(page):
        rows = [line.split("|") for line in (SOURCE / "docs/reference" / page).read_text().splitlines() if line.startswith("| `")]
        return [(re.findall(r"`(\w+)`", row[1]), re.findall(r"`(\w+)`", row[2])) for row in rows]
    def drawn(*lists, words=""):
        return set(re.findall(r"\w+", words)) | {word for entries in lists for entry in entries for word in re.findall(r"\w+", entry)}
    for name in draw_shapes.SHAPES:
        wanted = {key for keys, _ in keys_of(f"shapes/{name}.md") for key in keys}
        names = [[d[2] for d in table.get(name, ())] for table in (draw_shapes.IN_SECTION, draw_shapes.IN_FRONT)]
        angles = [a[3] for a in [draw_shapes.ANGLES[n] for n in [name] if n in draw_shapes.ANGLES] + draw_shapes.FRONT_ANGLES.get(name, [])]
        found = drawn(*names, angles, words=draw_shapes.NOTES.get(name, ""))
        assert wanted <= found, (name, wanted - found)
        assert "outer_diameter" not in found                                          # negative control
    parts = dict((keys[0], set(given)) for keys, given in keys_of("parts.md") if keys and keys[0] in draw_shapes.PARTS)
    assert len(parts) == len(draw_shapes.PARTS) == 14, parts.keys()
    for name, wanted in parts.items():
        _, lines, leaders, angles = draw_shapes.PARTS[name]
        _, front, words = draw_shapes.PART_FRONTS.get(name, ((), (), ""))
        found = drawn([d[2] for d in (*lines, *leaders, *front)], [a[3] for a in angles], words=words)
        assert wanted - {"mount"} <= found, (name, wanted - found)


with tempfile.TemporaryDirectory() as name:
    check_budget(pathlib.Path(name))
    check_documents(pathlib.Path(name))
check_ghosts()
check_far_bench()
check_curves()
check_significance()
check_limits()
check_same_lines()
check_search()
check_dimensions()
print("ok")
