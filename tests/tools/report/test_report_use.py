#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pages in use: jumping to a heading, zooming, switching rows off, printing. Usage: test_report_use.py PROGRAM"""
import json
import math
import pathlib
import re
import sys
import tempfile

import h5py
import numpy as np

sys.dont_write_bytecode = True
from browser import WIDE, Browser  # noqa: E402
from page_layout import paper_faults  # noqa: E402
from test_report import DATA, check, make_run  # noqa: E402

HARM = "document.head.append(Object.assign(document.createElement('style'), {id: 'harm', textContent: arguments[0]}))"
HEAL = "document.getElementById('harm').remove()"


def hidden_headings(browser):
    """Headings hidden under the bar after a click on their name in it."""
    return browser.run("""
        const hidden = [];
        for (const link of document.querySelectorAll("nav a")) {
          link.click();
          const bar = document.querySelector("nav").getBoundingClientRect();
          const heading = document.querySelector(link.getAttribute("href") + " h2").getBoundingClientRect();
          if (heading.top < bar.bottom || heading.bottom > innerHeight) hidden.push(link.textContent);
        }
        return hidden;""")


def check_jumps(browser):
    lines = set()
    for width in (390, 760, 1300):
        browser.resize(width)
        hidden = hidden_headings(browser)
        check(not hidden, f"at {width} px headings hide under the bar: {hidden}")
        lines.add(browser.run("return Math.round(document.querySelector('nav').offsetHeight / 30)"))
        browser.run(HARM, "html { scroll-padding-top: 0 !important }")
        check(hidden_headings(browser), f"at {width} px a heading under the bar would not be noticed")  # negative control
        browser.run(HEAL)
    check(len(lines) > 1, f"the bar has {lines} lines in all windows: this proves little")
    browser.resize(1300)


# A separate plot, zoomed to windows of many sizes; `ticks`: others than those of the page.
ZOOMS = """
    const [ticks] = arguments, said = [], place = document.createElement("div");
    document.querySelector("#budget").append(place);
    const series = [{name: "a", colour: "#000", x: [1, 1e5], y: [1e-26, 1e-20]}];
    const plot = new Plot(place, {x: {label: "f", log: true}, y: {label: "h", log: true}, series});
    if (ticks) plot.ticks = Function("axis", ticks);
    const value = label => Number(label.replace("·10", "e").replace(/^10(?=[−-]|\\d\\d?$)/, "1e").replace("−", "-"));
    for (const [low, high] of [[1, 1e5], [3, 4], [2.1, 2.2], [1.7, 1.70001], [12, 80], [1.1, 8.9], [21, 49]])
      for (const [y0, y1] of [[1e-26, 1e-20], [2.1e-24, 4.9e-24], [1.1e-23, 1.2e-23], [1.7e-24, 1.7002e-24]]) {
        plot.show([low, high], [y0, y1]);
        place.querySelectorAll(".axis > g").forEach((axis, k) => {
          const labels = [...axis.querySelectorAll(".tick text")].map(t => t.textContent).filter(t => t);
          const where = "xy"[k] + " from " + [low, y0][k] + " to " + [high, y1][k];
          if (labels.length < 2 || new Set(labels).size < labels.length) said.push(where + ": " + labels.join(", "));
        });
        const box = place.querySelector("svg").getBoundingClientRect();
        for (const t of place.querySelectorAll("svg text")) {
          const r = t.getBoundingClientRect();
          if (t.textContent && (r.left < box.left - 1 || r.right > box.right + 1)) said.push(t.textContent + " leaves the plot");
        }
      }
    place.remove();
    return said;"""
OLD_TICKS = """
    const [low, high] = this.scale[axis].domain(), values = [];
    for (let p = Math.floor(Math.log10(low)); p <= Math.ceil(Math.log10(high)); ++p)
      for (const m of [1, 2, 5]) if (m * 10 ** p >= low && m * 10 ** p <= high) values.push(m * 10 ** p);
    return {values, label: v => tickText(v, 1)};"""


def check_zoom(browser):
    """An axis shows the position: at least two labels that differ, however far it is zoomed."""
    for width in (390, 1300):
        browser.resize(width)
        said = browser.run(ZOOMS, None)
        check(not said, f"at {width} px zoomed axes: {said[:3]}")
        said = browser.run(ZOOMS, OLD_TICKS)
        check(len(said) > 5, f"axes with one label would not be noticed: {said}")  # negative control


def curve_at(browser, hertz):
    """Value below the pointer of the curve without the rows that are off, and its name."""
    return browser.run("""
        const plot = document.querySelector("#budget svg.plot"), overlay = plot.querySelector(".overlay");
        const axis = plot.querySelector(".axis > g"), ticks = [...axis.querySelectorAll(".tick")].filter(t => t.textContent);
        const at = ticks.map(t => [Math.log10(Number(t.textContent)), Number(/translate\\(([\\d.]+)/.exec(t.getAttribute("transform"))[1])]);
        const [[f0, x0], [f1, x1]] = [at[0], at[at.length - 1]];
        const box = plot.getBoundingClientRect(), scale = box.width / plot.viewBox.baseVal.width;
        const x = x0 + (Math.log10(arguments[0]) - f0) / (f1 - f0) * (x1 - x0);
        overlay.dispatchEvent(new MouseEvent("mousemove", {clientX: box.left + x * scale, clientY: box.top + 100, bubbles: true}));
        const entry = [...document.querySelectorAll("#budget .legend span")].find(s => /switched off$/.test(s.title));
        return entry ? [entry.title, entry.querySelector("b").textContent] : null;""", hertz)


def left_over(run_file, rank_id):
    """ASD and the total without one route in every bin, from the run file: routes add in power (10.1)."""
    with h5py.File(run_file) as file:
        noise = file["noise"]
        off = np.nonzero(noise["routes/hash"][:] == int(rank_id, 16))[0][0]
        total, mean = noise["total/mean"][:], noise["routes/mean"][:]
        return noise["frequency"][:], np.sqrt(np.maximum(total**2 - mean[off]**2, 0)), total


def agrees(browser, frequency, left, bins):
    for k in bins:
        found = curve_at(browser, frequency[k] * (1 - 1e-6))
        if not found or not found[1] or abs(float(found[1]) / left[k] - 1) > 6e-3:
            return f"{found} at {frequency[k]:.4g} Hz, not {left[k]:.4g}"
    return ""


def check_switch(browser, page, data):
    """The curve is drawn anew without the rows that are off, and is gone when all are on."""
    press = "[...document.querySelectorAll('#routes button')].find(b => b.textContent === arguments[0]).click()"
    type_in = "const i = document.querySelector('.filter'); i.value = arguments[0]; i.dispatchEvent(new Event('input'))"
    columns = {c["key"]: c["values"] for c in data["table"]["columns"]}
    frequency, left, total = left_over(page.parent / "run.h5", columns["id"][columns["rank"].index(1)])
    bins = [k for k in (20, 60, 100) if total[k] > 0]
    check(all(left[k] < 0.6 * total[k] for k in bins), "the first route is next to nothing: this proves nothing")
    check(curve_at(browser, 30) is None, "a curve without rows that are off, and none is off")
    browser.run(type_in, "rank == 1")
    browser.run("window.usualBring = Plot.prototype.bring; Plot.prototype.bring = () => {}")
    browser.run(press, "Switch these off")
    check(agrees(browser, frequency, left, bins), "a curve that stays as it is would not be noticed")  # negative control
    browser.run("Plot.prototype.bring = window.usualBring")
    browser.run(press, "All on")
    browser.run(press, "Switch these off")
    said = agrees(browser, frequency, left, bins)
    check(not said, f"the curve without the first route says {said}")
    drawn = "return document.querySelectorAll('#budget .marks path').length"
    with_off = browser.run(drawn)
    browser.run(press, "All on")
    check(curve_at(browser, 30) is None, "all rows are on again, and the curve stays")
    check(browser.run(drawn) != with_off, "no curve has come or gone")
    browser.run(type_in, "")


WHOLE_CURVES = """
    const b = JSON.parse(JSON.stringify(data.budget)), shares = {};
    for (const key of ["share", "error", "rest", "restError"]) shares[key] = typedArray(Float32Array, b.shares[key]);
    const all = budgetWithout(b, shares, new Set()), h = all.series[1].y;
    return Math.max(...h.map((v, i) => v === null ? 0 : Math.abs(v / b.total.asd[i] - 1)))"""


# Shares of a picture that are drawn, and that are white lines, of an annulus with one value and this relative error.
ANNULUS = """
    const [chart, error, done] = arguments, image = new Image();
    const place = chartCells({chart, whole: [0.5, 1, -Math.PI, Math.PI], cells: [0.5, 1, -Math.PI, Math.PI]});
    place.box = [-1, 1, -1, 1];
    image.onload = () => {
      const canvas = document.createElement("canvas"), g = canvas.getContext("2d");
      canvas.width = canvas.height = 400;
      g.drawImage(image, 0, 0);
      const d = g.getImageData(0, 0, 400, 400).data;
      let drawn = 0, white = 0;
      for (let i = 0; i < d.length; i += 4) { drawn += d[i + 3] > 127; white += d[i + 3] > 127 && d[i] > 200; }
      done([drawn / 160000, white / 160000]);
    };
    image.src = cellPicture({place, values: [1], errors: [error]}, place.box, 400, 400, () => "#000");"""


def check_cells(browser):
    """A ring of cells has the area of a ring, and lines where its error is above 30 %."""
    drawn, white = browser.driver.execute_async_script(ANNULUS, "polar", 0.2)
    check(abs(drawn / (math.pi * (1 - 0.25) / 4) - 1) < 0.01 and white == 0, f"an annulus covers {drawn}, {white} of it in white")
    drawn, white = browser.driver.execute_async_script(ANNULUS, "polar", 0.4)
    check(white > 0.05, f"an error of 40 % is shown by {white} of the picture")
    drawn, _ = browser.driver.execute_async_script(ANNULUS, "plane", 0.2)
    check(abs(drawn / (math.pi * (1 - 0.25) / 4) - 1) > 0.1, "a square for an annulus would not be noticed")         # negative control


def check_paper(browser, page):
    """A printed sheet shows all columns of the table without cuts."""
    browser.resize(1300)
    browser.open(page)
    browser.run("document.querySelectorAll('.choices input:not(:checked)').forEach(box => box.click())")
    browser.run("const s = document.querySelectorAll('#maps select, #materials select');"
                "s.forEach(x => { x.selectedIndex = x.length - 1; x.dispatchEvent(new Event('change')); })")
    said = paper_faults(browser)
    check(not said, f"on paper: {said[:3]}, {len(said)} in all")
    for style, wanted in (("body.paper th, body.paper td { font-size: 30px }", "cut"),
                          (".routes { font-size: 20px !important; overflow: hidden !important }", "cut"),
                          ("body.paper .routes span.text { white-space: nowrap; overflow: hidden; max-width: 4em }", "cut"),
                          ("pre { white-space: pre !important; font-size: 30px !important }", "cut"),
                          ("body.paper .stage .view { width: 1200px }", "wider than")):
        browser.run(HARM, style)
        said = paper_faults(browser)
        check(any(wanted in s for s in said), f"on paper '{style}' would not be noticed: {said[:3]}")  # negative controls
        browser.run(HEAL)
    check(browser.run("return !document.body.classList.contains('paper') && !document.querySelector('table').style.fontSize"),
          "the page stays as it was on paper")
    browser.run("window.addEventListener('beforeprint', () => {"
                "  window.printed = document.body.classList.contains('paper') && document.querySelectorAll('.routes .row').length; })")
    browser.driver.execute_cdp_cmd("Page.printToPDF", {})
    rows = json.loads(DATA.search(page.read_text()).group(2))["table"]["rows"]
    check(browser.run("return window.printed") == min(rows, 40), "printing does not fit the page to the sheet first")
    check(re.fullmatch("Printed: the first 40 of these rows.|", browser.run("return document.querySelector('.printed').textContent")),
          "the note on printed rows stays on the screen")


def main():
    with tempfile.TemporaryDirectory() as name:
        page = make_run(pathlib.Path(name))
        data = json.loads(DATA.search(page.read_text()).group(2))
        with Browser(font=WIDE) as browser:
            browser.open(page)
            check_jumps(browser)
            check_zoom(browser)
            check(browser.run(WHOLE_CURVES) < 1e-5, "the shares of all routes do not sum to the total")
            check_switch(browser, page, data)
            check_cells(browser)
            check_paper(browser, page)
    print("pages can be used")


if __name__ == "__main__":
    main()
