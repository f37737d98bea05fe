#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Live pages of straytrace run and view in a browser, and who may use them. Usage: test_live.py PROGRAM"""
import contextlib
import http.client
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.parse

import h5py
import numpy as np

sys.dont_write_bytecode = True
from browser import Browser  # noqa: E402
from page_colours import faint  # noqa: E402
from page_layout import faults  # noqa: E402
from test_report import PROGRAM, SOURCE, check, straytrace  # noqa: E402

GOOD = (SOURCE / "examples/end_bench.yaml").read_text() + "report: {pictures: [budget]}\n"  # the fastest
SCENE = "bench.yaml"
FAST = (SOURCE / "tests/scenes/et_hf_backscatter.yaml", "-p", "rings=40")
FIRST = 2**17  # the fewest in blocks that a longer run takes over
ENDLESS = 10**10
QUIET = {**os.environ, "STRAYTRACE_PYTHON": "/bin/false"}  # no pictures


def wait_for(there, what, seconds=60):
    until = time.monotonic() + seconds
    while not (found := there()):
        check(time.monotonic() < until, f"{what} did not come")
        time.sleep(0.05)
    return found


class Live:
    """The program with --live, and the address that it prints."""

    def __init__(self, *words, folder, path=""):
        self.errors = open(folder / f"live{len(list(folder.glob('live*.txt')))}.txt", "w+")
        self.child = subprocess.Popen([PROGRAM, *map(str, words), "--live"], cwd=folder, stdout=subprocess.DEVNULL,
                                      stderr=self.errors, env={**QUIET, "PATH": path + os.environ["PATH"]})
        found = wait_for(lambda: re.search(r"live page: (\S+)", self.said()), "the address")
        self.address = found.group(1)
        parts = urllib.parse.urlsplit(self.address)
        self.host, self.port, self.token = parts.hostname, parts.port, parts.path.split("/")[1]

    def said(self):
        return pathlib.Path(self.errors.name).read_text()

    def ask(self, path, method="GET", body=None, token=None, **headers):
        """Status and body of a reply."""
        link = http.client.HTTPConnection(self.host, self.port, timeout=10)
        with contextlib.closing(link):
            link.request(method, f"/{self.token if token is None else token}/{path}", body, headers)
            reply = link.getresponse()
            return reply.status, reply.read(), dict(reply.getheaders())

    def state(self):
        return json.loads(self.ask("state.json")[1])

    def end(self, code):
        self.child.send_signal(signal.SIGINT)
        self.child.wait(60)
        check(self.child.returncode == code, f"Ctrl-C gives {self.child.returncode}, not {code}: {self.said()}")
        with contextlib.closing(socket.socket()) as link:
            check(link.connect_ex((self.host, self.port)) != 0, "the port is still open")


def sums(run):
    """What a trace has summed, bit by bit."""
    kept = {}
    with h5py.File(run) as file:
        for group in ("classes", "tree", "total", "noise"):
            if group in file:
                file[group].visititems(lambda name, item, group=group: kept.update(
                    {f"{group}/{name}": np.asarray(item[()]).tobytes()} if isinstance(item, h5py.Dataset) else {}))
    check(len(kept) > 10, f"{run} holds {sorted(kept)} only")
    return kept


def check_access(live):
    """Only who knows the address, on this machine, by this name."""
    check(live.host == "127.0.0.1" and re.fullmatch("[0-9a-f]{32}", live.token), f"the address is {live.address}")
    check(live.ask("live")[0] == 200, "the page does not come")                                    # control of what follows
    other = "0" * 32
    for what, status in (("no token", live.ask("live", token="")[0]), ("another token", live.ask("live", token=other)[0]),
                         ("half a token", live.ask("live", token=live.token[:16])[0]),
                         ("another host", live.ask("live", Host=f"evil.example:{live.port}")[0]),
                         ("no port in the host", live.ask("live", Host="127.0.0.1")[0]),
                         ("a button of another page", live.ask("stop", "POST", Origin="http://evil.example")[0]),
                         ("a button without a token", live.ask("stop", "POST", token=other)[0])):
        check(status == 403, f"{what}: {status}")
    for method, path, status in (("PUT", "live", 405), ("DELETE", "live", 405), ("GET", "stop", 404), ("POST", "live", 404),
                                 ("GET", "../run.h5", 404), ("GET", "report.html", 404)):
        check(live.ask(path, method)[0] == status, f"{method} {path}: {live.ask(path, method)[0]}, not {status}")
    check(live.ask("extend", "POST", "1" * 10000)[0] == 400, "a long request is read")
    check(live.ask("live", token=live.token + "/" + "x" * 20000)[0] == 400, "a long address is read")
    headers = {key.lower(): value for key, value in live.ask("live")[2].items()}
    check("access-control-allow-origin" not in headers and headers["referrer-policy"] == "no-referrer", f"headers: {headers}")
    with contextlib.closing(socket.socket()) as link:
        own = [ip for ip in socket.gethostbyname_ex(socket.gethostname())[2] if not ip.startswith("127.")]
        check(not own or link.connect_ex((own[0], live.port)) != 0, "another address of this machine is served too")
    check(live.state()["phase"] in ("preparing", "tracing"), "a request without the right has stopped the run")


def check_layout(browser, what):
    for width in (390, 1300):
        said = faults(browser, width)
        check(not said, f"{what} at {width} px: {said[:3]}")
    for scheme in ("dark", "light"):
        browser.set_scheme(scheme)
        said = faint(browser)
        check(not said, f"{what}, {scheme}: {said[:3]}")


def words(browser):
    return browser.run("return document.querySelector('main').innerText")


def check_run(browser, folder):
    """A run that is followed, extended before its end and after it, stopped and closed."""
    live = Live("run", SCENE, "-o", "out", "--histories", ENDLESS, "--threads", 2, folder=folder)
    check_access(live)
    browser.driver.get(live.address)
    wait_for(lambda: browser.run("return document.querySelectorAll('#budget .marks path').length") > 3, "a curve")
    wait_for(lambda: browser.run("return document.querySelectorAll('#routes tbody tr').length") > 3, "a table of routes")
    wait_for(lambda: browser.run("return document.querySelectorAll('#errors .marks path').length") > 0, "the error")
    check("Tracing: " in words(browser) and browser.run("return document.querySelector('progress').value") < 1, "no progress")
    check_layout(browser, "live")
    for text, status in (("", 400), ("h_total < 1,5 %", 400), ("receiver:nothing < 5 %", 400), ("12", 400)):
        got = live.ask("extend", "POST", text)
        check(got[0] == status and json.loads(got[1])["remedy"], f"extend '{text}': {got}")
    type_target(browser, "nonsense")
    wait_for(lambda: "not a stop rule" in words(browser), "the complaint about a wrong target")
    check(live.state()["phase"] == "tracing", "a wrong target has ended the trace")
    browser.run("document.querySelector('button').click()")                                         # Stop
    state = wait_for(lambda: (s := live.state())["phase"] == "finished" and s, "the end after Stop")
    check(state["early"] and "Stopped early" in wait_for(lambda: "Stopped" in (t := words(browser)) and t, "the words"), "not early")
    check_report(live, browser, folder)
    live.end(85)
    wait_for(lambda: "The program has ended" in words(browser), "the word that the program has ended")
    check(browser.run("return [...document.querySelectorAll('button, input')].every(b => b.disabled)"), "a button without a program")


def type_target(browser, text):
    """As from the keyboard."""
    field = browser.driver.find_element("id", "target")
    field.clear()
    field.send_keys(text + "\n")


def check_report(live, browser, folder):
    status, page, _ = live.ask("report.html")
    check(status == 200 and page == (folder / "out/report.html").read_bytes(), "the report served is not that on the disk")
    browser.driver.switch_to.frame(browser.driver.find_element("css selector", "iframe"))
    wait_for(lambda: browser.run("return document.body && document.body.dataset.ready") == "yes", "the report")
    check("Noise budget" in browser.run("return document.body.innerText"), "the frame does not show the report")
    browser.driver.switch_to.default_content()
    said = [m for m in browser.said() if "400 (Bad Request)" not in m]  # the browser tells of wrong targets
    check(not said, f"the console says {said[:3]}")
    asked = [url for url in browser.asked_for() if not url.startswith((f"http://127.0.0.1:{live.port}/{live.token}/", "data:", "blob:"))]
    check(not asked, f"the page asks for {asked[:3]}")


def check_bits(folder):
    """A page changes no bit; a target before or after the end gives the run of that many histories."""
    live = Live("run", *FAST, "-o", "extended", "--histories", FIRST, "--threads", 1, folder=folder)
    wait_for(lambda: live.state()["phase"] == "finished", "the first end")
    runs = {FIRST: sums(folder / "extended/run.h5")}
    check(live.ask("extend", "POST", str(ENDLESS))[0] == 200, "it cannot be extended")
    wait_for(lambda: live.state()["histories"] > 2 * FIRST, "more histories")
    check(live.ask("extend", "POST", str(2 * ENDLESS))[0] == 200, "the target cannot be changed before the end")
    wait_for(lambda: live.state()["wanted_histories"] >= 2 * ENDLESS, "the new target")
    check(live.ask("stop", "POST")[0] == 200, "it cannot be stopped")
    wait_for(lambda: live.state()["phase"] == "finished", "the second end")
    runs[live.state()["histories"]] = sums(folder / "extended/run.h5")
    check(live.ask("stop", "POST")[0] == 200, "it cannot be closed")
    check(live.child.wait(30) == 85, f"Close gives {live.child.returncode}: {live.said()}")
    check("resuming from" in live.said(), "it began again")
    for histories, run in runs.items():
        straytrace("run", *FAST, "-o", f"{histories}.h5", "--histories", histories, "--threads", 2, "--quiet", folder=folder)
        whole = sums(folder / f"{histories}.h5")
        other = [key for key in whole if whole[key] != run.get(key)]
        check(not other, f"a page has changed {other[:3]} of {histories} histories")
    check(len(runs) == 2 and runs[FIRST] != whole, "other histories would not be noticed")          # negative control


def check_words(folder):
    """Wrong options, before anything is written."""
    with contextlib.closing(socket.socket()) as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        for more, said in ((("-o", "none", "--live", "--live-port", port), f"port {port} cannot be had"),
                           (("-o", "none.h5", "--live"), "name a folder"), (("-o", "none", "--live-port", port), "--live"),
                           (("-o", "none", "--live", "--live-port", "70000"), "65535")):
            done = subprocess.run([PROGRAM, "run", SCENE, *more], cwd=folder, capture_output=True, text=True, timeout=60)
            check(done.returncode == 2 and said in done.stderr, f"{more}: {done.returncode}, {done.stderr}")
            check(not (folder / "none").exists() and not (folder / "none.h5").exists(), f"{more} leaves files")


def check_view(browser, folder):
    """A picture that follows its scene; errors keep the last good one."""
    scene, good = folder / SCENE, GOOD
    live = Live("view", SCENE, folder=folder)
    browser.driver.get(live.address)
    shown = "return document.body.dataset.shown"
    wait_for(lambda: browser.run(shown) == "1", "the first picture")
    browser.run("const s = document.querySelector('iframe').contentWindow.stage; s.controls.dispatchEvent({type: 'start'});"
                " s.camera.position.x += 0.125; s.controls.update()")
    place = "return document.querySelector('iframe').contentWindow.stage.camera.position.toArray()"
    before = browser.run(place)
    scene.write_text(good.replace("brdf: sensor", "brfd: sensor"))
    wait_for(lambda: "brfd" in words(browser) and "The scene has errors" in words(browser), "the error")
    line = good[:good.index("brdf: sensor")].count("\n") + 1
    check(f"bench.yaml:{line}:" in words(browser), f"no line of the error in: {words(browser)[:300]}")
    check(browser.run(shown) == "1" and live.ask("picture.html")[0] == 200, "the last good picture is gone")
    check_layout(browser, "view")
    scene.write_text(good + "\n# changed\n")
    wait_for(lambda: browser.run(shown) == "2", "the second picture")
    check("The scene has errors" not in words(browser), "the error stays")
    check(np.allclose(browser.run(place), before), f"the camera went from {before} to {browser.run(place)}")
    live.end(0)
    check(not (folder / "view.html").exists(), "a file that nobody named")


def check_open(folder):
    """The browser gets the address in a file of this user alone, which is gone at the end."""
    tools, seen = folder / "tools", folder / "seen"
    tools.mkdir()
    (tools / "xdg-open").write_text(f'#!/bin/sh\nstat -c "%a %n" "$1" > {seen}.part\ncat "$1" >> {seen}.part\nmv {seen}.part {seen}\n')
    (tools / "xdg-open").chmod(0o755)
    live = Live("view", SCENE, "--open", folder=folder, path=f"{tools}:")
    wait_for(seen.exists, "the browser")
    mode, name = seen.read_text().split()[:2]
    check(mode == "600" and live.address in seen.read_text(), f"the browser got {seen.read_text()}")
    check(live.token not in name, "the name of the file shows the token")
    live.end(0)
    check(not pathlib.Path(name).exists(), "the file with the address stays")


def main():
    with tempfile.TemporaryDirectory() as name, Browser(loopback=True) as browser:
        folder = pathlib.Path(name)
        (folder / SCENE).write_text(GOOD)
        check_words(folder)
        check_run(browser, folder)
        check_bits(folder)
        check_view(browser, folder)
        check_open(folder)
    print("live pages follow, stop and extend")


if __name__ == "__main__":
    main()
