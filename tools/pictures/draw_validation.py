#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draw the pictures of docs/theory/validation.md and docs/theory/published.md from what the tests of this build recorded.

All numbers are those of build/validation (written by the tests) and of bench/results/peers.jsonl (written by
scripts/bench peers). Each picture holds the numbers that it shows; --check compares them with those of the build.

Examples:
  tools/pictures/draw_validation.py build           draws docs/theory/validation_*.png
  tools/pictures/draw_validation.py build --check   are they drawn from what the tests obtain?
"""
import argparse
import json
import pathlib
import struct
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PAGES = SOURCE / "docs" / "theory"
KEY = b"Drawn"
# Okabe and Ito, distinguishable with every common kind of colour vision.
BLUE, RED, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#555555"

VIEW_FACTORS = ("ViewFactors.CoaxialDiscsA18", "ViewFactors.SmallToLargeDiscA18", "ViewFactors.RareOnesByConnection",
                "ViewFactors.CylinderWallToItself", "Furnace.IntegratingSphereA18")
RECOUPLING = ("Recoupling.OneVertexIntoTem00A6", "Recoupling.OneVertexAtAnAngleAndAfterASplitter",
              "Recoupling.TracedBaffleSumEtHfA11", "Recoupling.TracedBaffleSumInverseSquareA11", "Lit.EllipticSpotRejoins",
              "Lit.GlassTakesItsOwnEtendue", "LitScenes.BenchBehindTheEndMirrorEq9_3", "WallForward.TracedA12",
              "ArmTube.FirstOrderTracedE1", "ArmTube.OneLambertScatterEq8_9", "ArmTube.FarRingOfSiliconCarbideE1")
WRAPPED = "TimeDomainAgreement.WrappedFringes"
# Values published by observers (physics reference, B1 to B3), and the first words of the comparison in the test.
PUBLISHED = (("KAGRA: reach of arches\n(klog 25704)", "PublishedArches.KagraSine", "fringe_of(14e-6, 0.42)"),
             ("LHO reaction mass: arches\napart (log 54298)", "PublishedArches.HanfordReactionMass", "deviation(one, 10)"),
             ("Virgo swinging baffle: bump\n(log 30059)", "PublishedArches.VirgoSwingingBaffle", "deviation(fringe_of(5e-6, 1.14), 70)"))
# Rows of the picture of docs/theory/published.md, by the first words of a comparison of tools.published: label, whether it was measured.
PAPERS = {"LHO 2020: spacing": ("LHO 2020: arches apart", True), "Virgo 2011: edge at first": ("Virgo 2011: bump", True),
          "Virgo 2011: edge after": ("Virgo 2011: bump after 30 s", True), "PTFE: light back": ("PTFE: light back", True),
          "PTFE: share": ("PTFE: hemisphere", True), "LLO 2009: knee for 33": ("LLO 2009: knee", False), "ET-LF: h/X": ("ET-LF: h per motion", False),
          "ET-LF at Sos Enattos: h": ("ET-LF at a site", False),
          "40 m, 2012: loss,": ("40 m: clipping", False)}
RESOLVED = 0.2                                           # relative error from which on another tracer's value is not drawn


class Build:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder) / "validation"

    def record(self, test):
        file = self.folder / f"{test}.json"
        if not file.exists():
            raise SystemExit(f"draw_validation: no numbers of {test}: run scripts/validation {test}")
        return json.loads(file.read_text(encoding="utf-8"))

    def points(self, tests, kinds=("mean",)):
        """(words, expected, obtained, standard error) of what the tests compared; controls are in none of these kinds."""
        for test in tests:
            for c in self.record(test)["comparisons"]:
                if c["kind"] in kinds:
                    yield from ((c["what"], expected, obtained, error if c["kind"] == "mean" else 0)
                                for obtained, expected, error in c["samples"])


def view_factors(build):
    connected = [p for p in build.points(VIEW_FACTORS[:3], ("mean", "near")) if "walked" not in p[0]]
    walked = [p for p in build.points(VIEW_FACTORS) if "walked" in p[0]] + list(build.points(VIEW_FACTORS[3:]))
    return {"by walks": walked, "by connection": connected}


def recoupling(build):
    return {"traced": [p for p in build.points(RECOUPLING) if 1e-40 < p[1] < 1e-6 and "share" not in p[0]]}


def wrapped(build):
    return {"h(t), Welch": list(build.points([WRAPPED]))}


def finesse(build):
    curves = build.record("tools.finesse")["curves"]
    return {c["what"].partition(":")[0]: [("", x, y, 0) for x, y in zip(c["x"], c["obtained"])] +
            [("FINESSE", x, y, 0) for x, y in zip(c["x"], c["expected"])] for c in curves[:2]}


def tracers(_):
    found = {}
    for line in (SOURCE / "bench/results/peers.jsonl").read_text(encoding="utf-8").splitlines():
        d = json.loads(line)
        if all(e and e < RESOLVED * v for v, e in ((d["value"], d["error"]), (d["theirs_value"], d["theirs_error"]))):
            error = d["theirs_value"] * ((d["error"] / d["value"]) ** 2 + (d["theirs_error"] / d["theirs_value"]) ** 2) ** 0.5
            found.setdefault(d["program"].split()[0], []).append((d["problem"], d["value"], d["theirs_value"], error))
    return found


def published(build):
    found = {}
    for name, test, what in PUBLISHED:
        kept = [c for c in build.record(test)["comparisons"] if c["what"] == what]
        found[name] = [("", c["worst"][1], c["worst"][0], 0) for c in kept]     # of a range both ends
    return found


def papers(build):
    record = build.record("tools.published")
    compared = [(c["what"], s[1], s[0], s[2]) for c in record["comparisons"] if c["kind"] == "near" for s in c["samples"]]
    compared = [c for c in compared if not c[0].startswith(("ET-LF at", "40 m"))]
    for curve, unit, scale in (("ET-LF at Sos Enattos: h", "Hz", 1), ("40 m, 2012: loss", "mm", 1000)):
        c = next(c for c in record["curves"] if c["what"] == curve)
        compared += [(f"{curve}, {scale * x:g} {unit}", theirs, ours, 0) for x, ours, theirs in zip(c["x"], c["obtained"], c["expected"])]
    return {label: [c for c in compared if c[0].startswith(words)] for words, (label, _) in PAPERS.items()}


def off_by(axes, data, what):
    """Points with one standard error as shares of what is expected."""
    for (name, points), colour, marker in zip(data.items(), (RED, BLUE), "os"):
        axes.errorbar([p[1] for p in points], [100 * (p[2] / p[1] - 1) for p in points], [100 * p[3] / p[1] for p in points], fmt=marker,
                      color=colour, ms=4, lw=1.2, capsize=2, label=name)
    axes.axhline(0, color=GREY, lw=0.8)
    axes.set(xscale="log", xlabel=f"closed form of {what}", ylabel="deviation from it [%], ± 1 σ")


def draw_view_factors(axes, data):
    off_by(axes, data, "the view factor")
    axes.legend(loc="lower left", frameon=False)


def draw_recoupling(axes, data):
    off_by(axes, data, "the recoupled fraction $f_r$")


def draw_wrapped(axes, data):
    (name, points), = data.items()
    hz = [float(p[0].split()[0]) for p in points]
    axes.plot(hz, [p[1] for p in points], color=BLUE, lw=1.4, label="exact spectrum (7.7)")
    axes.errorbar(hz, [p[2] for p in points], [p[3] for p in points], fmt="o", ms=3.5, lw=1.2, capsize=2, color=RED, label=f"{name}, ± 1 σ")
    axes.set(yscale="log", xlabel="frequency [Hz]", ylabel="one-sided PSD of $\\sin\\varphi$,\nmean over $\\varphi_0$ [1/Hz]")
    axes.legend(frameon=False)


def draw_finesse(axes, data):
    for (name, points), colour in zip(data.items(), (BLUE, RED)):
        for who, style in (("FINESSE", {"lw": 1.4}), ("", {"ls": "", "marker": "o", "ms": 3.5})):
            of = [p for p in points if p[0] == who]
            axes.loglog([p[1] for p in of], [p[2] for p in of], color=colour, label=f"{name}: {'FINESSE 3' if who else 'straytrace'}", **style)
    axes.set(xlabel="frequency [Hz]", ylabel="dark port power per DARM [W/m]")
    axes.legend(frameon=False, fontsize=8.5)


def draw_tracers(axes, data):
    problems = list(dict.fromkeys(p[0] for points in data.values() for p in points))
    for i, ((name, points), colour, marker) in enumerate(zip(data.items(), (BLUE, GREEN, RED, PURPLE), "osD^")):
        at = [problems.index(p[0]) + 0.16 * (i - 1.5) + 0.05 * sum(q[0] == p[0] for q in points[:k]) for k, p in enumerate(points)]
        axes.errorbar(at, [100 * (p[2] / p[1] - 1) for p in points], [100 * p[3] / p[1] for p in points], fmt=marker, color=colour, ms=4,
                      lw=1.2, capsize=2, label=name)
    axes.axhline(0, color=GREY, lw=0.8)
    axes.set_xticks(range(len(problems)), [p.replace("_", "\n") for p in problems])
    axes.set(xlabel="problem", ylabel="deviation from straytrace [%], ± 1 σ")
    axes.legend(frameon=False, ncol=2, fontsize=8.5)


def draw_published(axes, data):
    for y, points in enumerate(data.values()):
        said = [p[1] for p in points]
        axes.plot(said, [y] * len(said), "-" if len(said) > 1 else "D", lw=9, ms=7, color="#bbbbbb", solid_capstyle="butt", label="published" if y == 1 else None)
        axes.plot(points[0][2], y, "o", color=BLUE, ms=5, label="computed" if y == 1 else None)
    axes.set_yticks(range(len(data)), list(data), fontsize=8.5)
    axes.set(xscale="log", xlim=(5, 200), ylim=(-0.6, len(data) + 0.1), xlabel="fringe frequency [Hz]")
    axes.set_xticks((5, 10, 20, 50, 100, 200), ("5", "10", "20", "50", "100", "200"))
    axes.minorticks_off()
    axes.legend(frameon=False, loc="upper left", ncol=2, fontsize=8.5)


def draw_papers(axes, data):
    measured = dict(PAPERS.values())
    for y, (label, points) in enumerate(reversed(data.items())):
        for what, theirs, ours, allowed in points:
            if allowed:
                axes.plot([1 - allowed / theirs, 1 + allowed / theirs], [y, y], lw=7, color="#cccccc", solid_capstyle="butt")
            axes.plot(ours / theirs, y, "o" if measured[label] else "D", ms=5, color=BLUE if measured[label] else GREEN)
            if not 0.5 < ours / theirs < 2:
                axes.annotate(what.rpartition(", ")[2], (ours / theirs, y), (0, 6), textcoords="offset points", ha="right" if ours < 0.2 * theirs else "center",
                              fontsize=7.5)
    axes.axvline(1, color=GREY, lw=0.8)
    axes.set_yticks(range(len(data)), list(reversed(data)), fontsize=8.5)
    axes.set(xscale="log", xlim=(0.07, 30), ylim=(-0.6, len(data) - 0.4), xlabel="computed/published (grey: bands)")
    axes.set_xticks((0.1, 0.2, 0.5, 1, 2, 5, 10), ("0.1", "0.2", "0.5", "1", "2", "5", "10"))
    axes.minorticks_off()
    for marker, colour, label in (("o", BLUE, "measured"), ("D", GREEN, "calculated")):
        axes.plot([], [], marker, color=colour, ms=5, label=label)
    axes.legend(frameon=False, fontsize=8.5, loc="upper right")


PICTURES = {"view_factors": ("View factors", view_factors, draw_view_factors),
            "recoupling": ("Recoupled light", recoupling, draw_recoupling),
            "wrapped": ("Wrapped fringes: spectrum, time domain", wrapped, draw_wrapped),
            "finesse": ("Network solver and FINESSE 3", finesse, draw_finesse),
            "tracers": ("Four other tracers, whole problems", tracers, draw_tracers),
            "published": ("Published fringes: frequency, not level", published, draw_published),
            "papers": ("Measurements, calculations of others", papers, draw_papers)}


def picture(name):
    return PAGES / f"validation_{name}.png"


def drawn(png):
    """The numbers that a picture was drawn from, None if it has none."""
    data, at = png.read_bytes() if png.exists() else b"", 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + size]
        if kind == b"tEXt" and chunk.startswith(KEY + b"\0"):
            return json.loads(chunk[len(KEY) + 1:])
        at += 12 + size
    return None


def same(was, now):
    """Whether two sets of points are one but for what another machine may be off: half a standard error."""
    if was is None or list(was) != list(now):
        return False
    for name in now:
        if [p[0] for p in was[name]] != [p[0] for p in now[name]]:
            return False
        for (_, x, y, error), (_, x1, y1, error1) in zip(was[name], now[name]):
            near = all(abs(a - b) <= 1e-3 * abs(b) + 0.5 * error1 * (i == 1) for i, (a, b) in enumerate(((x, x1), (y, y1))))
            if not near or abs(error - error1) > 0.5 * error1:
                return False
    return True


def draw(name, build):
    import matplotlib                                    # only here: the check needs no libraries
    matplotlib.use("Agg")
    from matplotlib.figure import Figure
    matplotlib.rcParams.update({"font.size": 9.5, "axes.grid": True, "grid.alpha": 0.25})
    title, gather, paint = PICTURES[name]
    data = gather(build)
    figure = Figure(figsize=(4.3, 3.2), layout="constrained")
    axes = figure.subplots()
    paint(axes, data)
    figure.suptitle(title, fontsize="medium")
    figure.savefig(picture(name), dpi=100, metadata={KEY.decode(): json.dumps(data)})
    print(f"{picture(name).name}: {picture(name).stat().st_size} bytes")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="build folder")
    parser.add_argument("--check", action="store_true", help="draw nothing, compare")
    asked = parser.parse_args()
    build = Build(asked.build)
    if not asked.check:
        for name in PICTURES:
            draw(name, build)
        return 0
    old = [name for name in PICTURES if not same(drawn(picture(name)), json.loads(json.dumps(PICTURES[name][1](build))))]
    for name in old:
        print(f"docs/theory/{picture(name).name} shows other numbers than the tests obtain: tools/pictures/draw_validation.py {asked.build}")
    if not old:
        print(f"{len(PICTURES)} pictures show what the tests obtain")
    return 1 if old else 0


if __name__ == "__main__":
    sys.exit(main())
