# SPDX-License-Identifier: BSD-3-Clause
"""A headless Chromium for tests of pages, with software WebGL, without a network, and with one family of fonts."""
import json
import os
import pathlib
import tempfile

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

FLAGS = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1300,900", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
NO_NETWORK = "--host-resolver-rules=MAP * ~NOTFOUND"
# Files of fonts-liberation2 and fonts-dejavu-core, which scripts/setup --test installs.
FONTS = {"Liberation Sans": ("/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
                             "/usr/share/fonts/truetype/liberation2/LiberationSans-Bold.ttf"),
         "DejaVu Sans": ("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                         "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf")}
USUAL, WIDE = FONTS
FONTS_CONF = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "urn:fontconfig:fonts.dtd">
<fontconfig>
  <dir>{folder}/fonts</dir>
  <cachedir>{folder}/cache</cachedir>
  <match target="pattern"><edit name="family" mode="assign" binding="same"><string>{family}</string></edit></match>
</fontconfig>
"""


def font_settings(family, folder):
    """A fontconfig file with one family, which it returns for every name."""
    (folder / "fonts").mkdir()
    for file in map(pathlib.Path, FONTS[family]):
        if not file.exists():
            raise SystemExit(f"browser: {file} is missing; scripts/setup --test installs it")
        (folder / "fonts" / file.name).symlink_to(file)
    settings = folder / "fonts.conf"
    settings.write_text(FONTS_CONF.format(folder=folder, family=family))
    return settings


class Browser:
    def __init__(self, scripts=True, font=USUAL, loopback=False):
        """loopback: reaches servers of this machine."""
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for flag in (*FLAGS, NO_NETWORK + ", EXCLUDE 127.0.0.1" * loopback):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        if not scripts:
            options.add_experimental_option("prefs", {"profile.managed_default_content_settings.javascript": 2})
        self.scripts = scripts
        self.folder = tempfile.TemporaryDirectory()
        settings = font_settings(font, pathlib.Path(self.folder.name))
        service = Service("/usr/bin/chromedriver", env={**os.environ, "FONTCONFIG_FILE": str(settings)})
        self.driver = webdriver.Chrome(options=options, service=service)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()
        self.folder.cleanup()

    def open(self, file, ready=True):
        self.driver.get(pathlib.Path(file).resolve().as_uri())
        if ready:
            WebDriverWait(self.driver, 60).until(lambda d: d.execute_script("return document.body.dataset.ready") == "yes")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def set_width(self, width, height=900):
        """Sets the inside of the window. Windows themselves do not get narrower than 500 px."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})

    def set_scheme(self, scheme, media=""):
        """light or dark, as the system of the reader has it; media: print for a sheet."""
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                    {"media": media, "features": [{"name": "prefers-color-scheme", "value": scheme}]})

    def resize(self, width, height=900):
        """Sets the inside of the window, and waits until the page has drawn itself anew."""
        self.set_width(width, height)
        if self.scripts:
            self.driver.execute_async_script("const done = arguments[0];"
                                             "requestAnimationFrame(() => requestAnimationFrame(() => done()))")

    def fonts_of(self, selector):
        """The families that draw the text of an element."""
        self.driver.execute_cdp_cmd("DOM.enable", {})
        self.driver.execute_cdp_cmd("CSS.enable", {})
        root = self.driver.execute_cdp_cmd("DOM.getDocument", {})["root"]["nodeId"]
        node = self.driver.execute_cdp_cmd("DOM.querySelector", {"nodeId": root, "selector": selector})["nodeId"]
        fonts = self.driver.execute_cdp_cmd("CSS.getPlatformFontsForNode", {"nodeId": node})["fonts"]
        return {font["familyName"] for font in fonts}

    def said(self):
        """Messages of the console since the last call."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def asked_for(self):
        """All addresses requested since the last call."""
        events = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        return [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]
