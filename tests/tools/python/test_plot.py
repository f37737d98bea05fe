#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Reads a run file and an exported curve as users do. Usage: test_plot.py [RUN_FILE [H_ASD_TXT]]

Without arguments a small run file is made here, from the paths of schema/run-2.txt.
"""
import pathlib
import sys
import tempfile
import types

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "python"))
sys.dont_write_bytecode = True

import h5py  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import straytrace  # noqa: E402
from straytrace.plots import __main__ as command  # noqa: E402
from straytrace.plots import maps, overview, style, words  # noqa: E402


def made_run(path, routes=9, bins=60, noise=True):
    """A run file with made-up numbers."""
    edges = np.geomspace(5, 1000, bins + 1)
    centre = np.sqrt(edges[:-1] * edges[1:])
    names = [f"ITM·S > baffles[{i}]·S > vacuum_tube_section_{i}·R > ITM·S" for i in range(routes)]
    mean = 1e-21 * (centre / 5) ** -2.5 * 0.6 ** np.arange(routes)[:, None]
    with h5py.File(path, "w") as f:
        f.attrs.update(file_type=np.bytes_("straytrace-run"), schema=[2, 0], program="straytrace", version="0.1.0",
                       commit="abc", created="2024-05-01T12:00:00Z", title="Made up", model_hash="0" * 64, seed=1,
                       histories=1000000, complete=1)
        text = lambda values: np.array([v.encode() for v in values], dtype="S80")  # noqa: E731
        for name, values in {"groups": ["ITM"], "bodies": ["tube"], "ports": ["arm"]}.items():
            f[f"names/{name}"] = text(values)
        for name, value in {"hash": np.arange(routes), "port": np.zeros(routes, int), "mean": mean[:, 0],
                            "std_error": 0.01 * mean[:, 0], "reverse": np.ones(routes),
                            "trusted": np.ones(routes, int)}.items():
            f[f"classes/{name}"] = value
        f["classes/name"] = text(names)
        f["classes/why_not"] = text([""] * routes)
        f["energy_balance/name"] = text(["emitted", "absorbed", "escaped", "truncated", "roulette", "sampling"])
        f["energy_balance/mean"] = [1, 0.7, 0.3, 0, 0, 0]
        f["energy_balance/std_error"] = [0, 0.001, 0.001, 0, 0.0002, 0]
        f["arrived/mean"], f["arrived/std_error"] = [0.3], [0.01]
        f["warnings/scene"] = f["warnings/trace"] = text([])
        f["input/files/0"] = np.bytes_("a: 1\n")
        f["input/files/0"].attrs["name"] = np.bytes_("arm.yaml")
        if not noise:
            return
        total = np.sqrt(np.sum(mean**2, axis=0))
        for group, value in (("total", total), ("routes", mean)):
            for column, factor in (("mean", 1), ("sigma", 0.05), ("phase", 0.9), ("amplitude", 0.4)):
                f[f"noise/{group}/{column}"] = factor * value
        f["noise/routes/name"], f["noise/routes/why_not"] = text(names), text([""] * routes)
        f["noise/routes/resolved"], f["noise/routes/mean_square_phase"] = np.ones(routes, int), np.ones(routes)
        f["noise/frequency"], f["noise/frequency_edges"] = centre, edges
        f["noise/unresolved"] = text([])
        f["noise/faint"] = text([])
        f["noise/design/name"], f["noise/design/asd"] = text(["adv-lal"]), [1e-20 * (centre / 5) ** -2]
        f["noise"].attrs["margin"] = 0.1


def check_run(path):
    run = straytrace.open(path)
    assert run.attributes["file_type"] == "straytrace-run"
    assert len(run.routes.name) == len(run.routes.coupling) == len(run.noise.routes)
    assert run.noise.total.mean.shape == run.noise.frequency.shape
    assert np.all(np.diff(run.noise.edges) > 0)
    routes = run.noise.routes                     # of those that are not resolved, what was seen of them
    total = np.sqrt(sum(r.mean**2 for r in routes))
    np.testing.assert_allclose(total, run.noise.total.mean, rtol=1e-9)   # powers of routes add (eq. 10.1)
    share, error = run.noise.shares()
    assert abs(np.nansum(share) - 1) < 1e-9 and np.all(error[np.isfinite(error)] >= 0)
    control = [straytrace.Curve(r.name, 2 * r.mean, r.sigma, r.phase, r.amplitude) for r in routes[:1]] + routes[1:]
    assert not np.allclose(np.sqrt(sum(r.mean**2 for r in control)), run.noise.total.mean, rtol=1e-3, atol=0)
    return run


def check_picture(run, out):
    assert command.main([str(run), "-o", str(out)]) == 0
    image = plt.imread(out)
    assert image.shape[:2] == (1000, 1600), image.shape
    assert image[..., :3].std() > 0.05, "the picture is empty"
    assert not list(out.parent.glob("*.part-*"))


def check_labels_fit(path):
    """No text of the picture leaves the canvas, and no label of a bar meets another."""
    with plt.rc_context(style.STYLE):
        figure = overview.draw(straytrace.open(path))
        figure.canvas.draw()
        renderer = figure.canvas.get_renderer()
        for axes in figure.axes:
            boxes = [t.get_window_extent(renderer) for t in axes.texts if t.get_text()]
            for i, a in enumerate(boxes):
                assert 0 <= a.x0 and a.x1 <= 1600, a
                assert not any(a.overlaps(b) for b in boxes[i + 1:]), axes.get_title(loc="left")
        for t in figure.texts:
            box = t.get_window_extent(renderer)
            assert 0 <= box.x0 and box.x1 <= 1600 and 0 <= box.y0 and box.y1 <= 1000, t.get_text()
        plt.close(figure)


def check_curves(path):
    """Loads with numpy as gwpy does: two columns of seventeen and those of the positions of a body."""
    table = np.loadtxt(path)
    frequency, h = np.loadtxt(path, usecols=(0, 1), unpack=True)
    assert table.shape[1] == 21 and np.all(np.diff(frequency) > 0) and np.all(h >= 0)
    np.testing.assert_allclose(table[:, 2], np.maximum(h - table[:, 10], 0), rtol=1e-3, atol=0)
    np.testing.assert_allclose(table[:, 15], h / table[:, 14], rtol=1e-5)


def check_refusals(folder):
    other = folder / "other.h5"
    with h5py.File(other, "w") as f:
        f.attrs["file_type"] = "something else"
    newer = folder / "newer.h5"
    made_run(newer)
    with h5py.File(newer, "r+") as f:
        f.attrs["schema"] = [3, 0]
    (folder / "text.h5").write_text("hello")
    for path, reason in ((other, "not a straytrace run"), (newer, "format 3.0"), (folder / "text.h5", "cannot read"),
                        (folder / "none.h5", "cannot read")):
        try:
            straytrace.open(path)
        except straytrace.RunError as error:
            assert reason in str(error), error
        else:
            raise AssertionError(f"{path} was accepted")
        assert command.main([str(path), "-o", str(folder / "no.png")]) == 2
        assert not (folder / "no.png").exists()


def check_numbers():
    assert words.power_of_ten(1.2345e-24, 0.04e-24) == r"(1.23 ± 0.04)$\times 10^{-24}$"
    assert words.plain(61.0001, 0.3, " %") == "61.0 ± 0.3 %"
    assert words.plain(100, 3e-13, " %") == "100 ± 3e-13 %"              # control: 100.000000 ± 0.000000 %
    assert words.plain(2.344e-11, 4e-14, " %") == "2.34e-11 ± 4e-14 %"   # control: 0.000000 ± 0.000000 %
    assert words.power_of_ten(4.99e-6, 0) == r"4.99$\times 10^{-6}$ (computed)"
    assert words.hertz(999.9) == "1000" and words.hertz(5.0) == "5"
    assert words.power_of_ten(6.1234, 0.012) == "6.123 ± 0.012"
    assert words.power_of_ten(np.nan, 1) == "unresolved"
    assert words.power_of_ten(2.617193e-26, 4e-32, bound=True) == r"at most 2.7$\times 10^{-26}$"
    assert words.shortened("abcdefghij", 5) == "ab…ij"
    ghosts = [f"ETM/front·T > ETM/back·T > viewport·T > {face}·R > viewport·T > ETM/back·T > ETM/front·T" for face in ("lens", "fold")]
    assert words.told_apart([*ghosts, "fold·S"], 54)[2] == "fold·S"
    short = words.told_apart(ghosts, 54)
    assert max(map(len, short)) <= 54 and "lens·R" in short[0] and "fold·R" in short[1], short
    assert len({words.shortened(name, 54) for name in ghosts}) == 1, "control: both ends alone are the same"


def check_footer():
    """Another motion than that of the scene is named."""
    about = {"program": "straytrace", "version": "0", "commit": "abc", "model_hash": "0" * 64, "seed": 1, "histories": 1e4, "created": "now"}
    run = type("Run", (), {"attributes": about})
    assert "motion" not in overview.footer(run)
    run.attributes = about | {"motion_file": "a, storm.yaml"}
    assert overview.footer(run).endswith("motion a, storm.yaml") and "10 000 histories" in overview.footer(run)


def check_bounds():
    """Which bound a total is, from what makes it one."""
    def total(bound_share, unresolved):
        mean = np.ones(3)
        curve = straytrace.Curve("total", mean, 0.4 * mean, mean, mean, resolved=not unresolved,
                                 bound_share=np.array(bound_share))
        noise = straytrace.Noise(mean, np.ones(4), curve, [], unresolved, [], {}, 0.1)
        return noise.bound, list(noise.bounds)

    assert total([0, 0, 0], []) == ("", ["", "", ""])
    assert total([0, 0, 0], ["a"]) == (" (lower bound)", ["lower"] * 3)
    assert total([0, 0.5, 1], []) == (" (at most)", ["", "", "upper"])      # half is within the error
    assert total([0, 0.5, 0], ["a", "b"]) == (" (contains upper bounds; 2 routes unresolved)", ["lower", "neither", "lower"])


def check_limits():
    design = np.array([1e-20, 1e-23])
    low, high = overview.limits([np.array([1e-30, 1e-32]), design])   # far below the design curve, and still seen
    assert low < 1e-32 and high > 1e-20, (low, high)
    low, _ = overview.limits([np.array([1e-21, 1e-60]), design])      # a curve that ends is not followed down
    assert low > 1e-29, low
    total, route = np.array([1e-20, 1e-31]), np.array([1e-21, 1e-60])
    low, _ = overview.limits([total, route, design])                  # the total stays inside, other curves need not
    assert 1e-60 < low < 1e-31, low
    low, _ = overview.limits([design, total])                         # control: not the total
    assert low > 1e-31, low


def check_listed():
    """A route far below the total everywhere is not listed; one that is seen at one frequency is."""
    def curve(*mean):
        return types.SimpleNamespace(mean=np.array(mean))
    noise = types.SimpleNamespace(total=curve(1.0, 1.0), routes=[curve(1.0, 1.0), curve(0.0, 2e-4), curve(1e-5, 9e-5)])
    assert overview.listed_routes(noise, [0, 1, 2]) == [0, 1]
    assert overview.listed_routes(noise, [2]) == [2]                  # the loudest always is
    assert overview.listed_routes(noise, []) == []


def check_map_errors():
    """An error of 0 or NaN means no error: not drawn as 0 %."""
    error = maps.relative_error(np.array([2.0, 7.9e-212, 1e-9, np.nan]), np.array([0.1, 0, np.nan, np.nan]))
    np.testing.assert_allclose(error, [5, np.nan, np.nan, np.nan])


def add_receivers(path, trusted):
    """Makes it a run of receivers alone, of which the first is not resolved."""
    with h5py.File(path, "r+") as f:
        del f["names/ports"], f["classes"]
        f["names/ports"] = np.array([], dtype="S80")
        for name in ("hash", "port", "mean", "std_error", "reverse", "trusted"):
            f[f"classes/{name}"] = np.array([], dtype=int)
        for name in ("name", "why_not"):
            f[f"classes/{name}"] = np.array([], dtype="S80")
        f["names/receivers"] = np.array([b"PD", b"QPD"])
        for name, value in {"mean": [1e-9, 1e-8], "std_error": [1e-9, 1e-10], "trusted": [0, trusted],
                            "size": np.zeros((2, 2)), "angle_sine": [1, 1], "pixels": np.zeros((2, 2), int),
                            "angle_bins": [0, 0]}.items():
            f[f"receivers/{name}"] = value
        f["receivers/why_not"] = np.array([b"one history carries 31 % of the sum", b"" if trusted else b"variance"])
        f["receivers"].attrs["beam_power"] = 0.0
        for name in ("image", "angles", "quadrants"):
            f[f"maps/{name}_offset"], f[f"maps/{name}"] = [0, 0, 0], np.array([])
        f["energy_balance/mean"][5], f["energy_balance/std_error"][5] = 3e-17, 2e-19


def check_receivers(folder):
    """The picture agrees with report.txt about receivers and energy balance."""
    for trusted in (True, False):
        path = folder / f"receivers{trusted}.h5"
        made_run(path, noise=False)
        add_receivers(path, trusted)
        check_labels_fit(path)
        with plt.rc_context(style.STYLE):
            figure = overview.draw(straytrace.open(path))
            said = [t.get_text() for t in figure.texts + [t for a in figure.axes for t in a.texts]]
            assert any("unresolved receivers" in t and "PD: one history carries 31 %" in t for t in said), said
            assert not any("unresolved: none" in t for t in said), said
            assert any("No receiver is resolved" in t for t in said) != trusted, said
            assert len(figure.axes) == 1 + trusted      # no empty axes
            assert "rounding only" in said and "0.00 ± 0.02 %" not in said and not any("e-1" in t for t in said), said
            plt.close(figure)


with tempfile.TemporaryDirectory() as name:
    here = pathlib.Path(name)
    made_run(here / "run.h5")
    given = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "run.h5"
    check_numbers()
    check_footer()
    check_limits()
    check_listed()
    check_bounds()
    check_map_errors()
    check_receivers(here)
    check_refusals(here)
    for file in {given, here / "run.h5"}:
        check_run(file)
        check_labels_fit(file)
    check_picture(given, here / "report.png")
    made_run(here / "bare.h5", noise=False)
    check_labels_fit(here / "bare.h5")
    check_picture(here / "bare.h5", here / "bare.png")
    if len(sys.argv) > 2:
        check_curves(sys.argv[2])
print("ok")
