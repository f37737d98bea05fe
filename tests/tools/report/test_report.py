#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Pages of straytrace report and view in a browser. Usage: test_report.py PROGRAM"""
import html.parser
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from browser import Browser  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
HOSTILE = "</script><script>document.title='taken'</script><img src=x onerror=\"document.title='taken'\">"
DATA = re.compile(r'(<script type="application/json" id="data">)(.*?)(</script>)', re.DOTALL)


def check(true, what):
    if not true:
        sys.exit(f"test_report: {what}")


def straytrace(*words, folder):
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=folder, capture_output=True, text=True)
    check(done.returncode == 0, f"{' '.join(map(str, words))}: {done.stderr}")
    return done.stdout


def make_run(folder):
    """A run of the end bench whose title and source are hostile."""
    scene = (SOURCE / "examples/end_bench.yaml").read_text()
    scene = scene.replace("title: End bench fed through the end mirror of an arm", f"title: {json.dumps(HOSTILE)}")
    scene = scene.replace("glass: {specular", f"glass: {{source: {json.dumps(HOSTILE)}, specular")
    (folder / "bench.yaml").write_text(scene)
    straytrace("run", "bench.yaml", "-o", "out", "--histories", 2**18, "--quiet", folder=folder)
    return folder / "out/report.html"


class Addresses(html.parser.HTMLParser):
    """Everything that elements and styles of a page would load, other than what it holds itself; and its elements."""

    def __init__(self, text):
        super().__init__()
        self.found, self.elements, self.style = [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.elements.append(tag)
        self.style = tag == "style"
        for name, value in attributes:
            if name in ("src", "href", "data", "action", "poster", "srcset") and not re.match("data:|#", value or ""):
                self.found.append(value)
            check(not name.startswith("on"), f"<{tag}> runs a script: {name}")

    def handle_data(self, text):
        if self.style:
            self.found += re.findall(r"url\([^)]*\)|@import[^;]*", text)


def check_addresses(text):
    """The page loads nothing."""
    check("default-src 'none'" in text, "the page does not forbid itself to load anything")
    seen = Addresses(text)
    check(not seen.found, f"the page names files or addresses to load: {seen.found[:3]}")
    check(Addresses('<img src="https://example.org/x.png">').found, "the check would not see an address")  # negative control
    return seen


def check_text(page):
    text = page.read_text()
    seen = check_addresses(text)
    check(HOSTILE not in text and seen.elements.count("img") == 1, "a title became markup")
    check("state.json" not in text, "the page holds the script of a live page")
    for script in set((SOURCE / "data/page").glob("*.js")) - set((SOURCE / "data/page").glob("live*.js")):
        check(not re.search(r"fetch\(|XMLHttpRequest|WebSocket|import\(|innerHTML", script.read_text()), f"{script.name} may load")
    return json.loads(DATA.search(text).group(2))


def quiet(browser, page):
    said = browser.said()
    check(not said, f"{page.name}: the console says {said[:3]}")
    asked = [url for url in browser.asked_for() if not url.startswith(("file:", "data:", "blob:"))]
    check(not asked, f"{page.name} asks for {asked[:3]}")


def closes(events):
    """Emitted power is what the terms get, for every single history (the energy balance of trace/result.hpp)."""
    emitted = sum(e["power"] for e in events if e["what"] == "emit")
    ended = sum(e["power"] for e in events if e["event"] is None)
    return emitted > 0 and abs(ended / emitted - 1) < 1e-12


def check_history(folder):
    run = folder / "out/run.h5"
    for number in (0, 5, 77):
        events = json.loads(straytrace("trace", run, "--history", number, "--format", "json", folder=folder))
        check(closes(events), f"history {number} loses light")
        check(not closes(events[:-1]), "losing a term would not be noticed")                          # negative control
        again = straytrace("trace", "bench.yaml", "--history", number, "--format", "json", folder=folder)
        check(json.loads(again) == events, "a run and its scene tell different histories")
    for words, said in ((("report", "bench.yaml"), "straytrace run bench.yaml"), (("trace", "bench.yaml"), "--out")):
        done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True)
        check(done.returncode == 2 and said in done.stderr, f"{' '.join(words)}: {done.returncode}, {done.stderr}")


def check_network(browser, folder):
    """Negative control: a page that asks for something must be seen to do so."""
    (folder / "asking.html").write_text('<body data-ready="yes"><img src="http://127.0.0.1:9/x.png">')
    browser.open(folder / "asking.html")
    check(any("127.0.0.1" in url for url in browser.asked_for()) and browser.said(), "a page that asks would not be noticed")


def shown(browser):
    return browser.run("return [...document.querySelectorAll('#routes .row')].map(r => [...r.children].map(c => c.textContent))")


def filtered(browser, text):
    browser.run("const i = document.querySelector('.filter'); i.value = arguments[0]; i.dispatchEvent(new Event('input'))", text)
    return browser.run("return document.querySelector('#routes .note + .bar + .note').textContent")


def check_table(browser, data):
    columns = {c["key"]: c["values"] for c in data["table"]["columns"]}
    rows = shown(browser)
    check(rows[0][0] == "1" and rows[1][0] == "2", "the table does not begin with rank 1")
    browser.run("document.querySelector('[data-key=coupling]').click()")
    best = max(v for v in columns["coupling"] if v is not None)
    first = columns["coupling"].index(best)
    check(shown(browser)[0][1] == columns["sequence"][first], "sorting by coupling does not bring the largest up")
    browser.run("document.querySelector('[data-key=rank]').click()")
    wanted = sum("sensor" in re.split(r"·. > |·.$", s) and n == 3 for s, n in zip(columns["sequence"], columns["scatters"]))
    check(0 < wanted < len(columns["sequence"]), "the filter would prove nothing")
    said = filtered(browser, 'via("sensor") and scatters == 3')
    check(said.startswith(f"{wanted} of "), f"the predicate lets through '{said}', not {wanted} rows")
    loud = sum(h is not None and h > 1e-25 for h in columns["h30"])
    check(filtered(browser, "h(30 Hz) > 1e-25").startswith(f"{loud} of "), "h(30 Hz) > 1e-25 is not what it says")
    check_switch(browser, columns)
    check("is not known" in filtered(browser, "colour > 3"), "an unknown name in a filter is not reported")
    check(filtered(browser, "fold").split()[0] != filtered(browser, "").split()[0], "plain words filter nothing")


def check_switch(browser, columns):
    """Rows that are off leave the sum of squares."""
    press = "[...document.querySelectorAll('#routes button')].find(b => b.textContent === arguments[0]).click()"
    filtered(browser, "not rank == 2")
    browser.run(press, "Switch these off")
    said = browser.run("return document.querySelector('.sums').textContent")
    total = sum(h * h for h in columns["h30"] if h)**0.5
    left = columns["h30"][columns["rank"].index(2)] / total
    found = re.search(r"h\(30 Hz\) [^,]*, ([0-9.e-]+) of the whole", said)
    check(found and abs(float(found[1]) / left - 1) < 5e-3, f"all but one row off leave {left}, the page says '{said}'")
    check(left < 0.9, "the row that is left is all there is: this proves nothing")
    browser.run(press, "All on")
    check(browser.run("return document.querySelector('.sums').textContent") == "", "rows that are on again are missing")


def check_paths(browser, data):
    drawn = {p["id"] for p in data["scene"]["paths"]}
    for id in sorted(drawn)[:3]:
        row = browser.run("const r = document.querySelector('.row[data-id=\"' + arguments[0] + '\"]');"
                          "if (r && !r.classList.contains('chosen')) r.click(); return !!r", id)
        if not row:
            continue
        count = sum(p["id"] == id for p in data["scene"]["paths"])
        check(browser.run("return stage.drawnPaths") == count, f"a click on {id} does not draw its {count} paths")
        points = sum(2 * (len(p["points"]) - 1) for p in data["scene"]["paths"] if p["id"] == id)
        got = browser.run("const l = stage.lines.children.map(g => g.children).flat().filter(c => c.isLineSegments);"
                          "return l[l.length - 1].geometry.attributes.position.count")
        check(got == points, f"{got} points drawn in the scene, {points} in the paths")
        return
    check(False, "no row with paths was in sight")


def check_weights(data):
    """Drawn paths represent all paths of their route: their weights sum to its coupling, however few they are."""
    columns, weights = {c["key"]: c["values"] for c in data["table"]["columns"]}, {}
    for path in data["scene"]["paths"]:
        if path["address"] != "computed":
            weights.setdefault(path["id"], []).append(path["weight"])
    rows = [(columns["coupling"][columns["id"].index(id)], w) for id, w in weights.items() if id in columns["id"]]
    rows = [(coupling, w) for coupling, w in rows if coupling and len(w) > 1]
    check(len(rows) > 5, f"{len(rows)} routes with paths prove nothing")
    for coupling, w in rows:
        check(abs(sum(w) / coupling - 1) < 1e-4, f"paths stand for {sum(w)} of {coupling}")
        check(abs(sum(w[1:]) / coupling - 1) > 1e-4, "a path that is missing would not be noticed")           # negative control


def check_scene(browser):
    browser.run("stage.choose(stage.parts[0])")
    said = browser.run("return document.querySelector('.said').textContent")
    check("material" in said and "body" in said, f"a chosen part says '{said}'")
    lit = browser.run("""stage.draw(); const c = document.querySelector('.stage canvas'), k = document.createElement('canvas');
      k.width = c.width; k.height = c.height; const x = k.getContext('2d'); x.drawImage(c, 0, 0);
      const d = x.getImageData(0, 0, k.width, k.height).data, seen = new Set();
      for (let i = 0; i < d.length; i += 4) seen.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); return seen.size""")
    check(lit > 20, f"the scene is drawn in {lit} colours: it is empty")


def check_many_rows(browser, page, folder, rows=100000):
    """The same page with 1e5 rows: few elements, and the last row can be reached."""
    text = page.read_text()
    data = json.loads(DATA.search(text).group(2))
    table = data["table"]
    for c in table["columns"]:
        c["values"] = (c["values"] * (rows // len(c["values"]) + 1))[:rows]
        if c["key"] == "rank":
            c["values"] = list(range(1, rows + 1))
        if c["key"] == "id":
            c["values"] = [f"{i:016x}" for i in range(rows)]
    table["rows"] = rows
    many = folder / "many.html"
    many.write_text(DATA.sub(lambda m: m.group(1) + json.dumps(data).replace("<", "\\u003c") + m.group(3), text))
    browser.open(many)
    browser.run("const b = document.querySelector('.routes'); b.scrollTop = b.scrollHeight")
    browser.run("window.dispatchEvent(new Event('resize'))")
    elements = browser.run("return document.querySelectorAll('.routes *').length")
    check(elements < 1000, f"{elements} elements for {rows} rows")
    check(shown(browser)[-1][0] == str(rows), "the last of the rows is not at the end")
    quiet(browser, many)


def check_fixed(page):
    with Browser(scripts=False) as browser:
        browser.open(page, ready=False)
        source = browser.driver.find_elements("css selector", "#fixed tbody tr")
        check(len(source) > 20, f"without scripts the table has {len(source)} rows")
        check(browser.driver.find_element("css selector", "img.budget").size["width"] > 300, "without scripts no picture")


def big_mesh(file, side=400):
    """A wavy sheet of 2 side^2 triangles as binary STL, in mm."""
    import numpy as np
    x, y = np.meshgrid(np.linspace(-50, 50, side + 1), np.linspace(-50, 50, side + 1))
    p = np.stack([x, y, 2 * np.sin(x / 5) * np.cos(y / 7)], -1).astype("<f4")
    a, b, c, d = p[:-1, :-1], p[:-1, 1:], p[1:, :-1], p[1:, 1:]
    triangles = np.concatenate([np.stack([a, b, d], 2).reshape(-1, 9), np.stack([a, d, c], 2).reshape(-1, 9)])
    records = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("p", "<f4", 9), ("a", "<u2")])
    records["p"] = triangles
    file.write_bytes(b"\0" * 80 + struct.pack("<I", len(triangles)) + records.tobytes())
    return len(triangles)


def check_view(browser, folder):
    triangles = big_mesh(folder / "sheet.stl")
    (folder / "sheet.yaml").write_text(
        "straytrace: 1\nmaterials: {grey: {scatter: {model: lambertian, tis: 10 %}}}\nbodies: {table: {motion: still}}\n"
        "scene:\n  - {name: sheet, file: sheet.stl, units: mm, body: table, material: grey}\n"
        "  - {name: eye, shape: {disk: {outer_radius: 1 cm}}, at: [0 m, 0 m, 30 cm], body: table, material: grey}\n"
        "beams: {probe: {from: [0 m, 0 m, 20 cm], facing: [0, 0, -1], wavelength: 1064 nm, radius: 1 mm, power: 1 W}}\n"
        "receivers: {eye: {on: eye}}\n")
    straytrace("view", "sheet.yaml", "-o", "view.html", "--quiet", folder=folder)
    browser.open(folder / "view.html")
    drawn, of = browser.run("return [stage.scene.triangles, stage.scene.of_triangles]")
    check(of > triangles * 0.99 and drawn < 0.8 * of, f"{drawn} of {of} triangles drawn: not thinned out")
    check("thinned out" in browser.run("return document.querySelector('.scale').textContent"), "and the page does not say so")
    check(len(browser.run("return stage.scene.rays")) > 100, "no sample rays")
    check_scene(browser)
    quiet(browser, folder / "view.html")


def check_cad_parts(browser, folder):
    """Faces of one part of a STEP file are one line of the list, in a colour of the part."""
    straytrace("view", SOURCE / "examples/suspended_bench.yaml", "-o", "cad.html", "--quiet", folder=folder)
    browser.open(folder / "cad.html")
    faces, names, colours = browser.run("return [stage.scene.parts.length, stage.parts.map(p => p.part.name), "
                                        "stage.parts.map(p => p.colour)]")
    check(faces > 20, f"{faces} kinds of faces: there was nothing to put together")
    check(len(names) == len(set(names)) == 9, f"parts of the bench are {names}")
    check(len(set(colours)) == 9, f"parts of the bench have the colours {colours}")
    rows = browser.run("return document.querySelectorAll('.parts > div').length")
    check(rows == 10, f"{rows} lines for nine parts and a title")
    quiet(browser, folder / "cad.html")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        page = make_run(folder)
        data = check_text(page)
        check_history(folder)
        with Browser() as browser:
            browser.open(page)
            check(browser.driver.title == HOSTILE, f"the title is '{browser.driver.title}'")
            check_table(browser, data)
            check_paths(browser, data)
            check_weights(data)
            check_scene(browser)
            sections = browser.run("return [...document.querySelectorAll('section')].map(s => s.id)")
            for wanted in "budget routes scene maps ghosts first materials assumptions energy-balance convergence warnings provenance".split():
                check(wanted in sections, f"no part '{wanted}' in {sections}")
            quiet(browser, page)
            check_network(browser, folder)
            check_many_rows(browser, page, folder)
            check_view(browser, folder)
            check_cad_parts(browser, folder)
        check_fixed(page)
    print("pages are in order")


if __name__ == "__main__":
    main()
