#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page of several runs in a browser. Usage: test_comparison.py PROGRAM"""
import json
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True
from browser import WIDE, Browser  # noqa: E402
from page_colours import faint  # noqa: E402
from page_layout import faults, paper_faults  # noqa: E402
from test_report import DATA, SOURCE, check, check_addresses, quiet, straytrace  # noqa: E402

WIDTHS = (1300, 800, 390, 360)
HISTORIES = 2**16


def make_runs(folder):
    """A bench, the same with another material, and that with other histories."""
    scene = SOURCE / "examples/end_bench.yaml"
    for name, more in (("before", ()), ("after", ("-p", "sensor_brdf=2e-4 /sr")), ("again", ("--seed", "7"))):
        (folder / name).mkdir()
        straytrace("run", scene, "-o", f"{name}/run.h5", "--histories", HISTORIES, "--quiet", *more, folder=folder)
    return [f"{name}/run.h5" for name in ("before", "after", "again")]


def cells(browser, id, table=0):
    """Texts of the rows of a table of a section."""
    return browser.run("return [...document.querySelectorAll('#' + arguments[0] + ' table')[arguments[1]].tBodies[0].rows]"
                       ".map(r => [...r.cells].map(c => c.textContent))", id, table)


def check_content(browser, folder, runs):
    """The page shows what diff says, of both pairs."""
    heads = browser.run("return [...document.querySelectorAll('.verdict')].map(p => p.textContent)")
    check(len(heads) == 2 and heads[0] != heads[1], f"the sentences are {heads}")
    for k in (0, 1):
        results = json.loads(straytrace("diff", runs[0], runs[k + 1], "--format", "json", folder=folder))["results"]
        shown = cells(browser, "routes", k)
        moving = [c["what"] for c in results["routes"] if c["before"]["value"] or c["after"]["value"]]
        check([row[0] for row in shown] == moving[:100], f"routes of pair {k} are others")
        check(len({row[2] for row in shown}) > 1, f"all routes of pair {k} have the outcome {shown[0][2]}")
        bands = cells(browser, "bands", k)
        check([row[0] for row in bands] == [c["what"] for c in results["bands"]], f"bands of pair {k} are {bands}")
        loud = [(row, c) for row, c in zip(bands, results["bands"]) if c["ratio"] and c["ratio"]["sigma"] > 0]
        for row, c in loud:
            check(abs(float(row[1].split("(")[0]) - c["ratio"]["value"]) < 1.01 * c["ratio"]["sigma"], f"{row[1]} for {c['ratio']}")
            check(abs(float(row[1].split("(")[0]) - 1.5 * c["ratio"]["value"]) > c["ratio"]["sigma"], "another ratio would not be noticed")
    curves = browser.run("return document.querySelectorAll('#noise .marks path').length")
    check(curves >= 6, f"{curves} curves and bands of three runs")
    check(browser.run("return document.querySelectorAll('#ratio .marks path').length") == 5, "two ratios, their bands and a line at 1")


def check_layout(browser):
    for scheme in ("light", "dark"):
        browser.set_scheme(scheme)
        for width in WIDTHS:
            said = faults(browser, width)
            check(not said, f"{scheme} at {width} px: {said[:3]}, {len(said)} in all")
        said = faint(browser)
        check(not said, f"{scheme}: {said[:3]}, {len(said)} in all")
    browser.resize(1300)
    said = paper_faults(browser)
    check(not said, f"on paper: {said[:3]}")


def check_fixed(page):
    with Browser(scripts=False) as browser:
        browser.open(page, ready=False)
        text = browser.driver.find_element("css selector", "noscript pre").text
        check("rms strain of routes" in text, "without scripts there is no text")
        said = faults(browser, 360)
        check(not said, f"without scripts at 360 px: {said[:3]}")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        runs = make_runs(folder)
        straytrace("report", *runs, "-o", "three.html", "--quiet", folder=folder)
        page = folder / "three.html"
        check_addresses(page.read_text())
        check(page.stat().st_size < 0.8e6, f"the page has {page.stat().st_size} bytes")
        check(len(json.loads(DATA.search(page.read_text()).group(2))["runs"]) == 3, "not three runs")
        for font in ("Liberation Sans", WIDE):
            with Browser(font=font) as browser:
                browser.open(page)
                check_content(browser, folder, runs)
                check_layout(browser)
                quiet(browser, page)
        check_fixed(page)
    print("runs are side by side")


if __name__ == "__main__":
    main()
