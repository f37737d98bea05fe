# SPDX-License-Identifier: BSD-3-Clause
"""Starts the program, so that Python and the command line give the same bits, and listens to it."""

from __future__ import annotations

import json
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .errors import InputError, NumericalError, Problem, problems_of

HERE = pathlib.Path(__file__).resolve().parent
DONE, INPUT_ERROR, NUMERICAL_FAILURE, UNMET, CHECKPOINTED = 0, 2, 3, 4, 85

_running: set[subprocess.Popen[bytes]] = set()
_guard = threading.Lock()


@dataclass(frozen=True)
class Progress:
    """Progress of a trace."""

    histories: int
    wanted_histories: int             # of the current stage
    seconds: float
    histories_per_s: float
    rays_per_s: float
    error: float                      # relative error for the stop rule; NaN before its first check
    wanted_error: float               # 0: the rule is not about errors
    line: str                         # the progress line of the command


@dataclass(frozen=True)
class Answer:
    """Messages of the program."""

    output: str                       # stdout
    complete: bool                    # False: stopped early with a valid result
    warnings: list[str]               # as printed, of a command that speaks to people
    problems: tuple[Problem, ...]     # of a command with --format json


def program() -> str:
    """The program: STRAYTRACE_PROGRAM, or that of this package, of its source tree, or of the search path."""
    if chosen := os.environ.get("STRAYTRACE_PROGRAM"):
        if found := shutil.which(chosen):
            return found
        raise InputError(f"the environment variable STRAYTRACE_PROGRAM names '{chosen}', which is no program: name another, or build "
                         "it with scripts/build")
    for place in (HERE / "bin" / "straytrace", HERE.parents[1] / "build" / "straytrace"):
        if os.access(place, os.X_OK) and place.is_file():
            return str(place)
    if found := shutil.which("straytrace"):
        return found
    raise InputError("the program straytrace was not found: build it with scripts/build, or name it in the environment "
                     "variable STRAYTRACE_PROGRAM")


def environment() -> dict[str, str]:
    """In which the program draws its pictures with this Python."""
    return {**os.environ, "STRAYTRACE_PYTHON": sys.executable, "STRAYTRACE_PYTHONPATH": str(HERE.parent)}


def _heard(event: Mapping[str, Any], progress: Callable[[Progress], object] | None) -> None:
    if progress is None:
        return
    numbers: dict[str, Any] = {key: math.nan if value is None else value for key, value in event.items() if key != "event"}
    progress(Progress(**numbers))


class _Listener:
    """Reads stderr of the program until it ends; Ctrl-C is handed on to it once, a second one ends it."""

    def __init__(self, process: subprocess.Popen[bytes], progress: Callable[[Progress], object] | None) -> None:
        self.process, self.progress = process, progress
        self.problems: tuple[str, str] | None = None
        self.words: list[str] = []
        self.stop_requested = False

    def listen(self) -> None:
        while True:
            try:
                if not self._next_line():
                    self.process.wait()
                    return
            except KeyboardInterrupt:
                if self.stop_requested:
                    raise
                self.stop_requested = True
                self.process.send_signal(signal.SIGINT)

    def _next_line(self) -> bool:
        assert self.process.stderr is not None
        line = self.process.stderr.readline().decode("utf-8", "replace")
        if line.startswith('{"'):
            event = json.loads(line)
            if event["event"] == "progress":
                _heard(event, self.progress)
            else:
                self.problems = event["text"], json.dumps(event["problems"])
        elif line:
            self.words.append(line)
        return bool(line)


def interrupt_all() -> None:
    """Requests every program run by this process to finish its current work."""
    with _guard:
        for process in _running:
            process.send_signal(signal.SIGINT)


def ask(*words: str, unsaved: Mapping[str, str] | None = None,
        progress: Callable[[Progress], object] | None = None) -> Answer:
    """Runs the command `words`. `unsaved`: text that is read where a file of this name is meant. Raises InputError and
    NumericalError as the program means them."""
    with tempfile.TemporaryDirectory(prefix="straytrace-") as folder, tempfile.TemporaryFile() as output:
        options = ["--events"]
        for i, (name, text) in enumerate((unsaved or {}).items()):
            place = pathlib.Path(folder, f"{i}.yaml")
            place.write_text(text, encoding="utf-8")
            options += ["--unsaved", f"{name}={place}"]
        process = subprocess.Popen([program(), *options, *words], stdin=subprocess.DEVNULL, stdout=output,
                                   stderr=subprocess.PIPE, env=environment(), start_new_session=True)
        with _guard:
            _running.add(process)
        listener = _Listener(process, progress)
        try:
            listener.listen()
        finally:
            with _guard:
                _running.discard(process)
            if process.poll() is None:
                process.kill()
                process.wait()
            if process.stderr is not None:
                process.stderr.close()
        output.seek(0)
        return _answer(process.returncode, output.read().decode("utf-8", "replace"), listener)


def _warnings(lines: Sequence[str]) -> list[str]:
    """Those among the lines of stderr, each with the lines that are set in below it."""
    found: list[str] = []
    inside = False
    for line in lines:
        if line.startswith("warning: ") or ": warning: " in line:
            found.append(line)
            inside = True
        elif inside and line.startswith(" "):
            found[-1] += line
        else:
            inside = False
    return [warning.rstrip("\n").removeprefix("warning: ") for warning in found]


def _problems_in(words: str) -> tuple[Problem, ...]:
    """Lists of problems among the words of stderr."""
    found: tuple[Problem, ...] = ()
    at = words.find("[\n")
    while at >= 0:
        try:
            _, end = json.JSONDecoder().raw_decode(words, at)
            found += problems_of(words[at:end])
        except ValueError:
            end = at + 1
        at = words.find("[\n", end)
    return found


def _answer(code: int, output: str, listener: _Listener) -> Answer:
    if code in (DONE, UNMET, CHECKPOINTED):         # unmet: what no candidate of `optimise` reaches
        return Answer(output, code != CHECKPOINTED, _warnings(listener.words), _problems_in("".join(listener.words)))
    text, problems = listener.problems or ("".join(listener.words), "")
    if code == INPUT_ERROR:
        raise InputError(text or "the program rejected its input without a message", problems)
    if code == NUMERICAL_FAILURE:
        raise NumericalError(text.rstrip("\n"))
    if listener.stop_requested:
        raise KeyboardInterrupt
    how = f"code {code}" if code >= 0 else f"signal {signal.Signals(-code).name}"
    raise RuntimeError(f"the program ended with {how}: {text.strip() or 'without a message; was there enough memory?'}")


def command(arguments: Sequence[str] | None = None) -> None:
    """The command `straytrace`: becomes the program."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        name = program()
    except InputError as error:
        sys.exit(str(error))
    os.execve(name, ["straytrace", *words], environment())
