# SPDX-License-Identifier: BSD-3-Clause
"""The progress line of a trace, in notebooks, on terminals and in logs."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

from .engine import Progress

Shown = Callable[[Progress], object]
LOG_EVERY = 10.0  # s, where the line cannot be written over


class _Line:
    """On stderr: one line that is written over, elsewhere a line now and then."""

    def __init__(self) -> None:
        self.terminal, self.next, self.drawn = sys.stderr.isatty(), 0.0, False

    def __call__(self, progress: Progress) -> None:
        if self.terminal:
            sys.stderr.write("\r\x1b[K" + progress.line)
            sys.stderr.flush()
            self.drawn = True
        elif progress.seconds >= self.next and progress.seconds > 0.5:
            print(progress.line, file=sys.stderr)
            self.next = progress.seconds + LOG_EVERY

    def close(self) -> None:
        if self.drawn:
            sys.stderr.write("\n")


class _Cell:
    """In a notebook: text below the cell that is written over."""

    def __init__(self) -> None:
        self.handle: Any = None
        self.last = 0.0

    def __call__(self, progress: Progress) -> None:
        from IPython.display import display

        if time.monotonic() - self.last < 0.3:
            return
        self.last = time.monotonic()
        text = {"text/plain": progress.line}
        if self.handle is None:
            self.handle = display(text, raw=True, display_id=True)
        else:
            self.handle.update(text, raw=True)

    def close(self) -> None:
        pass


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, "kernel")


class shown:
    """Context: what is called with the progress. `wanted`: True, False, or a function of your own."""

    def __init__(self, wanted: bool | Shown | None) -> None:
        self.line: _Line | _Cell | None = None
        if callable(wanted):
            self.call: Shown | None = wanted
            return
        if wanted:
            self.line = _Cell() if _in_notebook() else _Line()
        self.call = self.line

    def __enter__(self) -> Shown | None:
        return self.call

    def __exit__(self, *_: object) -> None:
        if self.line is not None:
            self.line.close()
