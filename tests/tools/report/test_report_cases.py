#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pages of runs that are unlike others: faint, nameless, narrow, of rings. Usage: test_report_cases.py PROGRAM"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from browser import USUAL, WIDE, Browser  # noqa: E402
from page_layout import faults  # noqa: E402
from test_report import DATA, PROGRAM, check, make_run, straytrace  # noqa: E402


def check_faint(browser, page, folder):
    """A total 1e-12 of the design stays visible, a receiver states why it has no number, and long names do not make the page
    wide: the window is narrow."""
    data = json.loads(DATA.search(page.read_text()).group(2))
    total = data["budget"]["total"]
    for key in ("asd", "sigma"):
        total[key] = [v and v * 1e-12 for v in total[key]]
    data["receivers"]["list"].append({"name": "PD", "light": "unresolved: only 3 scores", "unit": "W", "table": {"columns": [], "rows": []}})
    data["maps"][0]["name"] = "a name without end " * 30
    faint = folder / "faint.html"
    faint.write_text(DATA.sub(lambda m: m.group(1) + json.dumps(data).replace("<", "\\u003c") + m.group(3), page.read_text()))
    browser.resize(600)
    browser.open(faint)
    low, tall = browser.run("const p = [...document.querySelectorAll('#budget .marks path')].pop().getBBox();"
                            "return [p.y, document.querySelector('#budget svg').viewBox.baseVal.height]")
    check(low < 0.9 * tall, f"the total begins at {low} of {tall}: out of sight")
    check("unresolved: only 3 scores" in browser.run("return document.querySelector('#receivers h3').textContent"),
          "a receiver without a number does not say why")
    said = faults(browser, 600)
    check(not said, f"{said[:3]}, {len(said)} in all")
    browser.run("document.querySelector('[data-key=coupling]').click()")
    check(browser.run("return document.querySelector('[data-key=coupling]').textContent").endswith("▼[1]"), "numbers do not fall first")


RING = """straytrace: 1
materials: {grey: {scatter: {model: lambertian, tis: 10 %}}}
bodies: {ring: {motion: {z: {peterson: high}, others: still}}, mirrors: {motion: still}}
scene:
  - {name: ITM, use: mirror, radius_of_curvature: 1420 m, facing: [0, 0, 1], body: mirrors, material: grey}
  - {name: ETM, use: mirror, radius_of_curvature: 1683 m, at: [0 m, 0 m, 3 km], facing: [0, 0, -1], body: mirrors, material: grey}
  - {name: ring, shape: {cylinder: {radius: 50 cm, from: 0 m, to: 40 cm}}, side: inner, at: [0 m, 0 m, 1 m], body: ring, material: grey,
     repeat: {count: 2, along: z, from: 0 m, to: 1 m}}
beams: {arm: {cavity: [ITM, ETM], power: 1 kW}}
ports: {ITM: {beam: arm, at: ITM}}
interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %}
report: {pictures: [maps]}
"""


def total_of(part, chart):
    """Sum over the cells of a map with its error; u, v as in src/world/model/receiver.hpp."""
    total = error2 = 0
    for i, (value, error) in enumerate(zip(part["values"], part["errors"])):
        u0, u1, v0, v1 = part["cells"][4 * i:4 * i + 4]
        area = (u1 - u0) * (v1 - v0) * ((u0 + u1) / 2 if chart == "polar" else 1)
        total += (value or 0) * area
        error2 += ((error or 0) * area)**2
    return total, error2**0.5


def spot_agrees(sensor, w):
    """Light of 1/e^2 radius w (0.6) scatters by its irradiance and rejoins the mode by it (1.8): the noise made within r of
    the centre is 1 - exp(-4 r^2/w^2) of the whole. Rings of cells end at R/2^(k/2)."""
    noise, (whole, _) = sensor["noise"], total_of(sensor["noise"], "polar")
    for k in (10, 11, 12):
        r = sensor["whole"][1] / 2**(k / 2)
        within = [i for i in range(len(noise["values"])) if noise["cells"][4 * i + 1] < 1.001 * r]
        part = {key: [noise[key][i] for i in within] for key in ("values", "errors")}
        part["cells"] = [x for i in within for x in noise["cells"][4 * i:4 * i + 4]]
        found, error = total_of(part, "polar")
        check(len(within) > 5, f"{len(within)} cells within {r} m: the spot is not seen")
        check(error < 0.08 * found, f"{found} ± {error} proves nothing")
        if abs(found / whole - (1 - math.exp(-4 * r * r / (w * w)))) > 5 * error / whole:
            return False
    return True


def check_spot(page):
    """A spot of 2 mm on a sensor of 10 cm. The main ghost beam lands there, and its row states its width."""
    data = json.loads(DATA.search(page.read_text()).group(2))
    sensor = next(m for m in data["maps"] if m["name"] == "sensor")
    main = next(g for r in data["ghosts"] for g in r["ghosts"] if g["order"] == 0 and g["where"] == "sensor")
    check(sensor["chart"] == "polar", "a disk has no polar map")
    check(abs(1e4 * total_of(sensor["noise"], "polar")[0] / sensor["noise_sum"] - 1) < 1e-4, "cells do not sum to the noise made here")
    check(spot_agrees(sensor, main["spot_major_m"]), "the map of the sensor is not the spot of the beam")
    check(not spot_agrees(sensor, 1.5 * main["spot_major_m"]), "a spot of another width would not be noticed")    # negative control


def check_instances(browser, page, folder):
    """The share of each of many surfaces has an error bar: sqrt(sum of squares) of the parts of its paths."""
    data = json.loads(DATA.search(page.read_text()).group(2))
    ring = data["maps"][0]
    check(ring["surfaces"] == 2 and len(ring["noise_by_place_error"]) == 2, f"{ring['surfaces']} surfaces of one name")
    for share, error in zip(ring["noise_by_place"], ring["noise_by_place_error"]):
        check(0 < error < share, f"a share of {share} % has the error {error}")
    check(abs(sum(ring["noise_by_place"]) / ring["noise_sum"] - 1) < 1e-4, "the shares of all are not the whole")
    browser.resize(1300)
    browser.open(page)
    bars = "return [...document.querySelectorAll('#maps line.error')].map(l => l.y1.baseVal.value - l.y2.baseVal.value)"
    check(len(browser.run(bars)) == 2 and min(browser.run(bars)) > 1, "the plot of the surfaces has no error bars")
    del ring["noise_by_place_error"]
    bare = folder / "bare.html"
    bare.write_text(DATA.sub(lambda m: m.group(1) + json.dumps(data).replace("<", "\\u003c") + m.group(3), page.read_text()))
    browser.open(bare, ready=False)
    check(len(browser.run(bars)) == 0, "missing error bars would not be noticed")                                    # negative control


def check_ring(folder):
    """A short ring is unrolled: seen along its axis it has no area. Its light sums to what arrives there in the energy balance; the
    scene chooses the pictures of its page."""
    (folder / "ring.yaml").write_text(RING)
    straytrace("run", "ring.yaml", "-o", "ring", "--histories", 2**17, "--quiet", folder=folder)
    data = json.loads(DATA.search((folder / "ring/report.html").read_text()).group(2))
    check("maps" in data and not {"budget", "scene", "ghosts", "materials", "convergence"} & set(data), "report.pictures is not obeyed")
    ring = next(m for m in data["maps"] if m["name"] == "ring")
    check(ring["chart"] == "unrolled", "a ring is shown along its axis")
    area = (ring["whole"][1] - ring["whole"][0]) * (ring["whole"][3] - ring["whole"][2])
    check(abs(area / (0.4 * 2 * 3.14159265 * 0.5) - 1) < 1e-4, f"the map has {area} m^2")
    light, error = total_of(ring["light"], "unrolled")
    light, error = ring["surfaces"] * light, ring["surfaces"] * error
    arriving = next(o["arriving"] for o in data["energy_balance"]["objects"] if o["name"] == "ring")
    check(0 < error < 0.1 * light, f"{light} ± {error} W proves nothing")
    check(abs(light - 1e3 * arriving["value"]) < 4 * error, f"the map holds {light} ± {error} W, {1e3 * arriving['value']} arrive")
    (folder / "wrong.yaml").write_text(RING.replace("[maps]", "[mapps]"))
    done = subprocess.run([PROGRAM, "check", "wrong.yaml"], cwd=folder, capture_output=True, text=True)
    check(done.returncode == 2 and "did you mean 'maps'?" in done.stderr, f"an unknown picture: {done.stderr}")


def check_photodiodes(browser, folder):
    """Each photodiode has its row and its mark, on the page of a scene with a single baffle, whose plots by place have one point."""
    example = pathlib.Path(__file__).resolve().parents[3] / "examples/instrumented_baffle.yaml"
    straytrace("wave", example, "-o", "field.h5", "--order", 0, "--quiet", folder=folder)
    straytrace("report", "field.h5", "-o", "diodes.html", "--quiet", folder=folder)
    page = folder / "diodes.html"
    data = json.loads(DATA.search(page.read_text()).group(2))
    diodes = data["wave"]["photodiodes"]
    check(len(diodes) == 56 and len(data["wave"]["edges"]["z"]) == 1, f"{len(diodes)} photodiodes, {len(data['wave']['edges']['z'])} edges")
    # Speckle: one draw is some spreads from the mean (eq. W.41, W.43).
    off = [(d["power"] - d["mean"]) / d["spread"] for d in diodes]
    check(0.3 < math.sqrt(sum(x * x for x in off) / len(off)) < 2, f"one draw is off by {off[:3]} spreads")
    rows = """const title = [...document.querySelectorAll('#wave h3')].find(h => h.textContent === 'Light on photodiodes');
              return title ? [...document.querySelectorAll('#wave table')].filter(t => t.textContent.startsWith('photodiode'))[0].tBodies[0].rows.length : 0"""
    browser.resize(1300)
    browser.open(page)
    check(browser.run(rows) == 56, f"{browser.run(rows)} rows of photodiodes")
    said = faults(browser, 1300)
    check(not said, f"{said[:3]}, {len(said)} in all")
    data["wave"]["photodiodes"] = []
    none = folder / "no_diodes.html"
    none.write_text(DATA.sub(lambda m: m.group(1) + json.dumps(data).replace("<", "\\u003c") + m.group(3), page.read_text()))
    browser.open(none)
    check(browser.run(rows) == 0, "missing photodiodes would not be noticed")                                         # negative control


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_ring(folder)
        page = make_run(folder)
        check_spot(page)
        for font in (USUAL, WIDE):
            with Browser(font=font) as browser:
                check_faint(browser, page, folder)
                check_instances(browser, folder / "ring/report.html", folder)
                if font == USUAL:
                    check_photodiodes(browser, folder)
    print("pages are in order")


if __name__ == "__main__":
    main()
