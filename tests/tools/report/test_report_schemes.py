#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the demo: its size, the time until it can be used, and its colours. Usage: test_report_schemes.py PROGRAM"""
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True
from browser import Browser  # noqa: E402
from page_colours import faint  # noqa: E402
from page_layout import faults, paper_faults  # noqa: E402
from test_report import SOURCE, check, quiet, straytrace  # noqa: E402

MOST_BYTES = 1.5e6
HARM = "document.head.append(Object.assign(document.createElement('style'), {id: 'harm', textContent: arguments[0]}))"
HEAL = "document.getElementById('harm').remove()"
PAPER = "return getComputedStyle(document.body).backgroundColor"


def check_size(page):
    size = page.stat().st_size
    check(size < MOST_BYTES, f"the page of the demo has {size} bytes")
    unpacked = pathlib.Path("/usr/share/javascript/three/three.min.js").stat().st_size
    check(size + 0.7 * unpacked > MOST_BYTES, "three.js that is not packed would not be noticed")           # negative control
    return size


def times(browser, page):
    """ms from the start of loading until curves and tables can be used, and until the scene is drawn."""
    browser.open(page)
    return browser.run("return [performance.getEntriesByName('usable')[0].startTime, performance.now()]")


def check_scheme(browser, scheme):
    browser.set_scheme(scheme)
    for width in (1300, 360):
        said = faults(browser, width)
        check(not said, f"{scheme} at {width} px: {said[:3]}, {len(said)} in all")
        said = faint(browser)
        check(not said, f"{scheme} at {width} px: {said[:3]}, {len(said)} in all")
    browser.resize(1300)


def check_harm(browser, dark):
    """Negative controls: colours that cannot be seen are reported."""
    body = "body:not(.paper)" if dark else "body"
    for style, wanted in ((body + " { --grey: #777 !important }", "has a contrast of"),
                          (body + " { --blue: #333a40 !important; --red: #ddd !important; --ink: #888 !important }", "of a plot"),
                          (".plot text { fill: #7c7c7c }", "'"), (".stage .view { background: #808 }", "the scene is drawn on")):
        browser.run(HARM, style)
        said = faint(browser)
        check(any(wanted in s for s in said), f"'{style}' would not be noticed: {said[:3]}")
        browser.run(HEAL)


def check_switching(browser):
    """The plots and the scene follow the system while the page is open; a sheet is white."""
    seen = {}
    for scheme in ("light", "dark"):
        browser.set_scheme(scheme)
        browser.resize(1300)
        line = "return getComputedStyle([...document.querySelectorAll('#budget .marks path')].pop()).stroke"
        seen[scheme] = (browser.run(PAPER), browser.run(line), browser.run("return stage.renderer.getClearColor().getHexString()"))
    check(all(a != b for a, b in zip(seen["light"], seen["dark"])), f"the schemes do not differ: {seen}")
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    browser.resize(1300)
    printed = (browser.run(PAPER), browser.run("return stage.renderer.getClearColor().getHexString()"))
    browser.run("window.dispatchEvent(new Event('afterprint'))")
    check(printed == (seen["light"][0], seen["light"][2]), f"a dark page is printed on {printed}")
    browser.set_scheme("dark", "print")
    check(browser.run(PAPER) == seen["light"][0], "a page without scripts is printed dark")
    browser.set_scheme("dark")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        straytrace("run", SOURCE / "examples/virgo_arm.yaml", "-o", "demo", "--quiet", folder=folder)
        page = folder / "demo/report.html"
        size = check_size(page)
        with Browser() as browser:
            usable, ready = times(browser, page)
            for scheme in ("light", "dark"):
                check_scheme(browser, scheme)
                check_harm(browser, scheme == "dark")
            check_switching(browser)
            said = paper_faults(browser)
            check(not said, f"dark, on paper: {said[:3]}")
            quiet(browser, page)
    print(f"the page of the demo has {size / 1e6:.2f} MB, can be used after {usable:.0f} ms, and its scene after {ready:.0f} ms")


if __name__ == "__main__":
    main()
