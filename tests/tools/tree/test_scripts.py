#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The scripts of the project have help, reject wrong arguments, and show progress as one line, not as hundreds."""
import os
import pathlib
import pty
import shutil
import signal
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[3]
SCRIPTS = SOURCE / "scripts"
HANDED_ON = {"demo", "test", "bench", "validation"}  # these hand unknown words to another program, or to one of their own


def check(condition, words):
    if not condition:
        sys.exit(f"test_scripts: {words}")


def run(*words, **more):
    return subprocess.run([*map(str, words)], capture_output=True, text=True, timeout=60, **more)


def check_words():
    names = sorted(p.name for p in SCRIPTS.iterdir() if os.access(p, os.X_OK))
    check(len(names) > 8, f"only {names} are scripts")
    for name in names:
        helped = run(SCRIPTS / name, "--help")
        check(helped.returncode == 0 and helped.stdout.startswith(f"Usage: scripts/{name}"), f"{name} --help: {helped}")
        if name not in HANDED_ON:
            rejected = run(SCRIPTS / name, "--xyzzy")
            check(rejected.returncode == 2 and rejected.stderr, f"{name} --xyzzy ends with {rejected.returncode}: {rejected}")


def check_lists():
    """The program needs fewer packages than the documents and the tests; nothing is listed twice."""
    lists = {word: run(SCRIPTS / "setup", *word.split(), "--list").stdout.split() for word in ("", "--docs", "--test")}
    check(set(lists[""]) < set(lists["--docs"]) < set(lists["--test"]), f"the lists are not nested: {lists}")
    for packages in lists.values():
        check(len(packages) == len(set(packages)), f"a package is listed twice: {sorted(packages)}")
    check({"chromium", "valgrind", "python3-sphinx", "libgtest-dev"}.isdisjoint(lists[""]), "the program needs none of these")
    with tempfile.TemporaryDirectory() as place:
        shutil.copytree(SCRIPTS, pathlib.Path(place) / "scripts")
        said = run(pathlib.Path(place) / "scripts/setup", "--remove")
        check(said.returncode == 0 and "nothing to remove" in said.stdout, f"--remove removes what it did not install: {said}")


def shown(text, how, terminal):
    """Output of `how`, a function of scripts/progress.bash, for the text, on a terminal or in a file."""
    words = ["bash", "-euo", "pipefail", "-c", f". {SCRIPTS / 'progress.bash'}; {how}"]
    if not terminal:
        return run(*words, input=text).stderr
    master, slave = pty.openpty()
    process = subprocess.Popen(words, stdin=subprocess.PIPE, stderr=slave, text=True)
    os.close(slave)
    process.stdin.write(text)
    process.stdin.close()
    pieces = []
    try:
        while piece := os.read(master, 65536):
            pieces.append(piece)
    except OSError:  # the other end is closed
        pass
    process.wait()
    return b"".join(pieces).decode()


def check_progress():
    steps = [f"[{k}/487] Building CXX object a{k}.o" for k in range(1, 488)]
    text = "\n".join(["[0/2] Re-checking globbed directories...", *steps]) + "\n"
    in_file = shown(text, "ninja_progress", False).splitlines()
    check(9 <= len(in_file) <= 13 and in_file[-1].startswith("build: 487 steps in "), f"in a file: {in_file}")
    moving = shown(text, "ninja_progress", True)
    check(moving.count("\n") == 1 and moving.count("\r") > 480, f"on a terminal {moving.count(chr(10))} lines stay")
    check(shown(text, "cat >&2", False).count("\n") == 488, "a filter that passes everything on would not be noticed")
    check(shown("ninja: no work to do.\n", "ninja_progress", False) == "", "a build that has nothing to do says so at length")
    broken = shown(text.replace("[400/487] Building", "FAILED: a400.o\nerror: a400\n[400/487] Building"), "ninja_progress", False)
    check("FAILED: a400.o\nerror: a400\n" in broken, "what the compiler says is lost")
    failing = run("bash", "-c", f". {SCRIPTS / 'progress.bash'}; with_clock work bash -c 'echo why; exit 7'")
    check(failing.returncode == 7 and "why" in failing.stderr, f"a failure is hidden: {failing}")


def check_interrupt():
    """Ctrl-C ends the work under the clock too; without the trap it would live on, for background jobs ignore it."""
    with tempfile.TemporaryDirectory() as place:
        own = pathlib.Path(place) / "pid"
        work = f"echo $BASHPID > {own}; exec sleep 60"
        for how, ends in (("with_clock work bash -c", True), ("set -e; run() { \"$@\" & wait; }; run bash -c", False)):
            process = subprocess.Popen(["bash", "-c", f". {SCRIPTS / 'progress.bash'}; {how} '{work}'"], start_new_session=True,
                                       stderr=subprocess.DEVNULL)
            until = time.monotonic() + 20
            while not (own.exists() and own.read_text().strip()) and time.monotonic() < until:
                time.sleep(0.05)
            time.sleep(0.3)
            os.killpg(process.pid, signal.SIGINT)
            process.wait(20)
            time.sleep(0.3)
            worker = int(own.read_text())
            alive = pathlib.Path(f"/proc/{worker}/stat").exists() and " Z " not in pathlib.Path(f"/proc/{worker}/stat").read_text()
            if alive:
                os.kill(worker, signal.SIGKILL)
            check(alive != ends, f"after Ctrl-C the work of '{how}' {'is still running' if alive else 'has ended'}")
            own.unlink()


def check_pictures():
    """Pictures are stamped with a commit, so a tree with uncommitted changes draws none; control: a clean one begins to build."""
    with tempfile.TemporaryDirectory() as place:
        tree = pathlib.Path(place)
        (tree / "scripts").mkdir()
        shutil.copy(SCRIPTS / "pictures", tree / "scripts/pictures")
        (tree / "scripts/build").write_text("#!/bin/sh\necho builds\nexit 7\n")
        (tree / "scripts/build").chmod(0o755)
        who = {**os.environ, **{f"GIT_{role}_{what}": "a@b" for role in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}}
        for words in (["init", "-q"], ["add", "."], ["commit", "-q", "-m", "first"]):
            check(run("git", "-C", tree, *words, env=who).returncode == 0, f"git {words}")
        clean = run(tree / "scripts/pictures", "gallery")
        check(clean.returncode == 7 and "builds" in clean.stdout, f"pictures of a clean tree: {clean}")
        (tree / "change").write_text("1")
        dirty = run(tree / "scripts/pictures", "gallery")
        check(dirty.returncode == 1 and "uncommitted" in dirty.stderr and "builds" not in dirty.stdout,
              f"pictures of a changed tree: {dirty}")


check_words()
check_lists()
check_pictures()
check_interrupt()
check_progress()
print("scripts: as expected")
