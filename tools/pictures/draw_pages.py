#!/usr/bin/python3
"""Draw the pictures of report and view as a browser shows them, without scroll bars. Usage: draw_pages.py PROGRAM [NAME...]

NAME: report, view, cad_bench_view, rb1, first_scene or live. Needs Chromium (scripts/setup --test).
"""
import base64
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/tools/report"))
sys.dont_write_bytecode = True

from selenium.webdriver.support.ui import WebDriverWait  # noqa: E402

from browser import Browser  # noqa: E402

from pictures import small  # noqa: E402

NO_BARS = "const s = document.createElement('style'); s.textContent = '::-webkit-scrollbar { display: none }'; document.head.append(s)"


def picture(file, to, width, height, element=None, opened=Browser.open, **browser):
    """Of the page from its top, or of one element of it."""
    with tempfile.TemporaryDirectory() as folder, Browser(**browser) as browser:
        opened(browser, file)
        browser.resize(width, height)
        browser.run(NO_BARS)
        browser.resize(width, height)
        place = browser.run(f"const r = document.querySelector({element!r}).getBoundingClientRect();"
                            "return [r.x, r.y + scrollY, r.width, r.height]") if element else (0, 0, width, height)
        clip = dict(zip(("x", "y", "width", "height"), place)) | {"scale": 1}
        shot = browser.driver.execute_cdp_cmd("Page.captureScreenshot", {"clip": clip, "captureBeyondViewport": True})
        whole = pathlib.Path(folder) / "page.png"
        whole.write_bytes(base64.b64decode(shot["data"]))
        small(whole, to)


def open_live(browser, address):
    """A live page once it has followed its run for a while."""
    browser.driver.get(address)
    WebDriverWait(browser.driver, 120).until(lambda d: d.execute_script("return results") > 3)


def live_picture(program, folder, to):
    words = [program, "run", ROOT / "examples/virgo_arm.yaml", "-o", f"{folder}/live", "--until", "h_total < 0.01 %", "--live"]
    with subprocess.Popen(list(map(str, words)), stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as child:
        address = next(found[1] for line in child.stderr if (found := re.match(r"live page: (\S+)", line)))
        try:
            picture(address, to, 1000, 900, opened=open_live, loopback=True)
        finally:
            child.kill()


def main(program, names):
    docs, examples = ROOT / "docs", ROOT / "examples"
    with tempfile.TemporaryDirectory() as folder:
        def made(*words):
            subprocess.run([program, *map(str, words), "--quiet"], check=True, stdout=subprocess.DEVNULL)

        if "report" in names:
            made("run", examples / "virgo_arm.yaml", "-o", f"{folder}/demo")
            picture(f"{folder}/demo/report.html", docs / "reference/report.png", 1000, 900)
        if "view" in names:
            made("view", examples / "bench.yaml", "-o", f"{folder}/bench.html")
            picture(f"{folder}/bench.html", docs / "reference/view.png", 1400, 900)
        if "cad_bench_view" in names:
            made("view", examples / "suspended_bench.yaml", "-o", f"{folder}/cad.html")
            picture(f"{folder}/cad.html", docs / "guide/cad_bench_view.png", 1080, 760, ".stage")
        if "rb1" in names:
            made("view", examples / "benches/rb1.yaml", "-o", f"{folder}/rb1.html")
            picture(f"{folder}/rb1.html", docs / "guide/gallery_rb1_view.png", 1080, 760, ".stage")
        if "live" in names:
            live_picture(program, folder, docs / "reference/live.png")
        if "first_scene" in names:
            page = (docs / "guide/first_scene.md").read_text(encoding="utf-8")
            for name, scene in re.findall(r"^```yaml\n# ([\w-]+\.yaml)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
                pathlib.Path(folder, name).write_text(scene, encoding="utf-8")
            made("view", f"{folder}/row.yaml", "-o", f"{folder}/row.html")
            picture(f"{folder}/row.html", docs / "guide/first_scene_view.png", 1080, 760, ".stage")


if __name__ == "__main__":
    ALL = ("report", "view", "cad_bench_view", "rb1", "first_scene", "live")
    if len(sys.argv) < 2 or set(sys.argv[2:]) - set(ALL):
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:] or ALL)
