#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pages fit their window and cut no number, in two fonts and four widths. Usage: test_report_fonts.py PROGRAM"""
import json
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True
from browser import USUAL, WIDE, Browser  # noqa: E402
from page_layout import WIDTHS, faults, text_width  # noqa: E402
from test_report import DATA, SOURCE, check, make_run, straytrace  # noqa: E402

WORD = "a-word_without/end" * 20
LONGEST = 4321  # the row with the longest number
# The test must report the harm of each style: (style, width of the window, its message).
HARM = (("body::after { content: ''; display: block; width: 2000px; height: 1px }", 1300, "wider than its window"),
        (".routes .grid span { max-width: 60px; overflow: hidden }", 1300, ")e-"),
        (".routes .grid span { max-width: 20px; overflow: hidden }", 1300, "cut: 'rank"),
        (".routes span.text { max-width: 5em; overflow: hidden; text-overflow: ellipsis }", 360, "·S > "),
        ("th, td { max-width: 1rem }", 600, "cut: "),
        ("td { max-width: 2rem; min-width: 0 }", 600, "cut: "),
        (".keep, td { white-space: normal } td { overflow-wrap: anywhere; max-width: 2rem; min-width: 0 }", 600, "broken: "),
        (".keep { white-space: normal } p { width: 1px }", 600, "broken: "),
        ("svg.plot { max-width: 200px }", 600, "has letters of"),
        ("svg.plot text { font-size: 40px }", 600, "overlap"),
        ("svg.plot text { font-size: 40px }", 390, "leaves its plot"),
        (".stage { flex-direction: row } .stage .view { flex: 1 1 auto }", 390, "the scene is "),
        (".stage .label { padding: 0 5rem }", 390, "leaves the scene"),
        ("svg.plot .tick ~ .tick text { display: none }", 1300, "nobody can read a value"))
TEXT_HARM = ((".keep { white-space: normal } td.text { max-width: 3rem; min-width: 0 }", 600, "broken: -1.23456789e-12"),)


def with_long_texts(page, folder):
    """The page with names that have no end and numbers as long as they get. Of so many rows a part says how wide
    columns are: the row with the long names does, the row with the longest number does not."""
    data = json.loads(DATA.search(page.read_text()).group(2))
    columns = {c["key"]: c["values"] for c in data["table"]["columns"]}
    rows = 10000
    for key, values in columns.items():
        values[:] = (values * (rows // len(values) + 1))[:rows]
    columns["rank"][:] = range(1, rows + 1)
    columns["id"][:] = [f"{i:016x}" for i in range(rows)]
    columns["sequence"][0] = columns["body"][0] = WORD
    columns["coupling"][LONGEST], columns["coupling_sigma"][LONGEST] = 1.23456789012345e-123, 1.2345e-136
    data["table"]["rows"] = rows
    light = {"value": 1.23456e-12, "sigma": 1.2e-17}
    titles = {"rank": False, "route": True, "power [W]": False, "share [%]": False}
    table = {"columns": [{"title": title, "text": is_text, "digits": 3} for title, is_text in titles.items()],
             "rows": [[1, WORD, light, 100]]}
    data["receivers"]["list"].append({"name": WORD, "light": light, "unit": "W", "table": table})
    data["warnings"].append(WORD)
    data["provenance"]["stop_rule"] = "a rule of many words until -1.23456789e-12 " * 4
    long = folder / "long.html"
    text = json.dumps(data).replace("<", "\\u003c")
    long.write_text(DATA.sub(lambda m: m.group(1) + text + m.group(3), page.read_text()))
    return long


def check_font(browser, font):
    """The font was chosen for the browser; nothing else may draw the page."""
    for selector in ("h1", "#routes .note", "#routes .row", "#budget .axis text"):
        used = browser.fonts_of(selector)
        check(used == {font}, f"'{selector}' is drawn with {sorted(used)}, not with {font}")


def check_widths(browser, page, what, widths=(*WIDTHS, *WIDTHS[-2::-1])):
    """Loads the page in the first window, then makes the window wider and narrower."""
    browser.resize(widths[0])
    browser.open(page)
    browser.run("document.querySelectorAll('.choices input:not(:checked)').forEach(box => box.click())")
    for width in widths:
        said = faults(browser, width)
        check(not said, f"{what} at {width} px: {said[:3]}, {len(said)} in all")


def check_harm(browser, harm):
    """Negative controls: every fault that a style causes in the open page is reported."""
    for style, width, wanted in harm:
        browser.run("document.head.append(Object.assign(document.createElement('style'),"
                    "{id: 'harm', textContent: arguments[0]}))", style)
        said = faults(browser, width)
        check(any(wanted in s for s in said), f"at {width} px '{style}' would not be noticed: {said[:3]}")
        browser.run("document.getElementById('harm').remove()")
        if "svg" in style:
            browser.resize(800)  # plots are drawn anew, with their own letters
    check(not faults(browser, WIDTHS[0]), "harm was left behind")


def scroll(browser, row):
    browser.run("document.querySelector('.routes').scrollTop = 24 * arguments[0];"
                "window.dispatchEvent(new Event('resize'))", row)


def check_rows(browser, font):
    """Columns stay where they are, a row without given widths is complete, rows are as high as the script
    counts."""
    def places():
        return browser.run("return [...document.querySelectorAll('.routes .head span')]"
                           ".map(s => Math.round(s.getBoundingClientRect().left))")
    before = places()
    scroll(browser, 9000)
    after = places()
    check(after == before, f"{font}: columns move while rows come and go: {before}, {after}")
    scroll(browser, LONGEST - 1)
    texts = browser.run("return document.querySelector('.routes').textContent")
    check("e-123" in texts, f"{font}: the longest number is not in sight")
    said = faults(browser, WIDTHS[0])
    check(not said, f"{font}, rows in the middle: {said[:3]}")
    heights = set(browser.run("return [...document.querySelectorAll('.routes .row')].map(r => r.offsetHeight)"))
    check(heights == {24}, f"{font}: rows are {sorted(heights)} px high")


def check_fixed(page, font):
    with Browser(scripts=False, font=font) as browser:
        for width in WIDTHS:
            browser.resize(width)
            browser.open(page, ready=False)
            said = faults(browser, width)
            check(not said, f"{font}, without scripts, at {width} px: {said[:3]}")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        page = make_run(folder)
        long = with_long_texts(page, folder)
        straytrace("view", SOURCE / "examples/end_bench.yaml", "-o", "view.html", "--quiet", folder=folder)
        widths = {}
        for font in (USUAL, WIDE):
            with Browser(font=font) as browser:
                check_widths(browser, folder / "view.html", f"{font}, a view")
                check_widths(browser, page, f"{font}, a report")
                check_font(browser, font)
                widths[font] = text_width(browser)
                if font == USUAL:
                    check_harm(browser, HARM)
                check_widths(browser, long, f"{font}, long texts", WIDTHS)
                if font == USUAL:
                    check_harm(browser, TEXT_HARM)
                check_rows(browser, font)
            check_fixed(page, font)
        check(widths[WIDE] > 1.05 * widths[USUAL], f"the second font is not wider: {widths}")
    wide = ", ".join(f"{width:.1f} px wide in {font}" for font, width in widths.items())
    print(f"pages fit in both fonts; the same text is {wide}")


if __name__ == "__main__":
    main()
