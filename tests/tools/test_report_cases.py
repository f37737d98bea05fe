#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pages of runs that are unlike others: faint, nameless, narrow, of rings. Usage: test_report_cases.py PROGRAM"""
import json
import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from browser import USUAL, WIDE, Browser  # noqa: E402
from page_layout import faults  # noqa: E402
from test_report import DATA, PROGRAM, check, make_run, straytrace  # noqa: E402


def check_faint(browser, page, folder):
    """A total 1e-12 of the design stays in sight, a receiver says why it has no number, and long names do not make the page
    wide: the window is narrow."""
    data = json.loads(DATA.search(page.read_text()).group(2))
    total = data["budget"]["total"]
    for key in ("asd", "sigma"):
        total[key] = [v and v * 1e-12 for v in total[key]]
    data["receivers"]["list"].append({"name": "PD", "power": None, "sigma": None, "unit": "W", "why": "only 3 scores", "routes": []})
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
  - {name: ring, shape: {cylinder: {radius: 50 cm, from: 0 m, to: 40 cm}}, side: inner, at: [0 m, 0 m, 1 m], body: ring, material: grey}
beams: {arm: {cavity: [ITM, ETM], power: 1 kW}}
ports: {ITM: {beam: arm, at: ITM}}
interferometer: {preset: fabry-perot-michelson, arm_length: 3 km, mirror_mass: 42 kg, input_transmission: 1.4 %}
report: {pictures: [maps]}
"""


def check_ring(folder):
    """A short ring is unrolled: seen along its axis it has no area. Its light sums to what arrives there in the books; the
    scene chooses the pictures of its page."""
    (folder / "ring.yaml").write_text(RING)
    straytrace("run", "ring.yaml", "-o", "ring", "--histories", 2**17, "--quiet", folder=folder)
    data = json.loads(DATA.search((folder / "ring/report.html").read_text()).group(2))
    check("maps" in data and not {"budget", "scene", "ghosts", "materials", "convergence"} & set(data), "report.pictures is not obeyed")
    ring = next(m for m in data["maps"] if m["name"] == "ring")
    check(ring["unrolled"], "a ring is shown along its axis")
    area = (ring["x"][1] - ring["x"][0]) * (ring["y"][1] - ring["y"][0])
    check(abs(area / (0.4 * 2 * 3.14159265 * 0.5) - 1) < 1e-4, f"the map has {area} m^2")
    cell = area / ring["columns"] / ring["rows"]
    light, error = sum(ring["light"]) * cell, sum(e * e for e in ring["light_error"])**0.5 * cell
    arriving = next(o["arriving"] for o in data["ledger"]["objects"] if o["name"] == "ring")
    check(0 < error < 0.1 * light, f"{light} ± {error} W proves nothing")
    check(abs(light - 1e3 * arriving["value"]) < 4 * error, f"the map holds {light} ± {error} W, {1e3 * arriving['value']} arrive")
    (folder / "wrong.yaml").write_text(RING.replace("[maps]", "[mapps]"))
    done = subprocess.run([PROGRAM, "check", "wrong.yaml"], cwd=folder, capture_output=True, text=True)
    check(done.returncode == 2 and "did you mean 'maps'?" in done.stderr, f"a picture that is none: {done.stderr}")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_ring(folder)
        page = make_run(folder)
        for font in (USUAL, WIDE):
            with Browser(font=font) as browser:
                check_faint(browser, page, folder)
    print("pages are in order")


if __name__ == "__main__":
    main()
