#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the demo: its size, the time until it can be used, its colours, and its sliders. Usage: test_report_schemes.py PROGRAM"""
import pathlib
import sys
import tempfile

from selenium.webdriver.common.keys import Keys

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


SLIDERS = """
const part = document.querySelector('#what-if'), visible = node => node.getClientRects().length > 0;
const ranges = [...part.querySelectorAll('.sliders input[type=range]')];
return {shown: part.querySelector('output').textContent, said: part.querySelector('[aria-live]').textContent,
        told: visible(part.querySelector('[aria-live]')), command: part.querySelector('code').textContent,
        curves: document.querySelectorAll('#budget .marks path').length, off: ranges[0].disabled,
        focus: [...part.querySelectorAll('.sliders input, .bar button')].indexOf(document.activeElement),
        widths: ranges.filter(visible).map(r => r.getBoundingClientRect().width),
        right: Math.max(...ranges.map(r => r.getBoundingClientRect().right)), window: document.documentElement.clientWidth}"""


def check_keys(browser):
    """The sliders without a mouse: arrows, ends, the box `black` by Tab and the space bar, the button by Enter."""
    def press(*keys):
        for key in keys:
            browser.driver.switch_to.active_element.send_keys(key)
        return browser.run(SLIDERS)

    before = browser.run("document.querySelector('#what-if .sliders input').focus();" + SLIDERS)
    check(before["said"] == "All as traced." and before["command"] == "", f"sliders at the start: {before}")
    once = press(Keys.ARROW_RIGHT)
    check(once["shown"] == "× 1.02" and "h is × " in once["said"], f"an arrow key sets {once['shown']}: {once['said']}")
    check("=x1.02'" in once["command"] and once["curves"] > before["curves"], f"an arrow key draws nothing: {once}")
    check(press(Keys.HOME)["shown"] == "× 0.01", "the key Home does not go to the end of a slider")
    dark = press(Keys.TAB, " ")
    check(dark["shown"] == "black" and dark["off"] and dark["focus"] == 1, f"'black' is not reached by keys: {dark}")
    browser.run("document.querySelector('#what-if .bar button').focus()")
    after = press(Keys.ENTER)
    check(after == {**before, "focus": after["focus"]}, f"a key does not reset the sliders: {after}")


def check_sliders(browser):
    """With one moved: narrow and dark, and on paper, which has the answer and no sliders."""
    browser.set_scheme("light")
    browser.resize(1300)
    check_keys(browser)
    browser.run("document.querySelector('#what-if .sliders input').focus()")
    browser.driver.switch_to.active_element.send_keys(Keys.END)
    browser.set_scheme("dark")
    said = faults(browser, 390) + faint(browser)
    check(not said, f"a slider moved, dark at 390 px: {said[:3]}")
    narrow = browser.run(SLIDERS)
    check(min(narrow["widths"]) >= 150 and narrow["right"] <= narrow["window"], f"sliders at 390 px: {narrow}")
    browser.run(HARM, ".sliders { grid-template-columns: 1fr 30rem max-content !important }")                # negative control
    check(faults(browser, 390), "sliders that leave a narrow window would not be noticed")
    browser.run(HEAL)
    browser.set_scheme("dark", "print")
    paper = browser.run(SLIDERS)
    check(not paper["widths"] and paper["told"] and "--set" in paper["command"], f"the sliders on paper: {paper}")
    said = paper_faults(browser)
    check(not said, f"a slider moved, on paper: {said[:3]}")
    browser.set_scheme("light")


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
            check_sliders(browser)
            quiet(browser, page)
    print(f"the page of the demo has {size / 1e6:.2f} MB, can be used after {usable:.0f} ms, and its scene after {ready:.0f} ms")


if __name__ == "__main__":
    main()
