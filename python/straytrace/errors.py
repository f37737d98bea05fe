# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong, in the words of the command line."""

import json
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """A problem of an input, and its remedy. Lines and columns count from 1; 0: the whole."""

    message: str
    suggestion: str = ""
    file: str = ""
    line: int = 0
    column: int = 0
    width: int = 1                    # number of characters concerned, from `column` on
    severity: str = "error"           # or "warning"


def problems_of(text: str) -> tuple[Problem, ...]:
    """Of the JSON list that the program gives."""
    return tuple(Problem(p["what"], p.get("suggestion", ""), p.get("file", ""), p.get("line", 0), p.get("column", 0),
                         p.get("width", 1), p["severity"]) for p in json.loads(text))


class InputError(ValueError):
    """The input is wrong and nothing was run. `str()` is the message of the command line, `problems` lists all
    problems."""

    def __init__(self, text: str, problems: str = "") -> None:
        super().__init__(text, problems)          # what a copy in another process is made from
        stripped = text.rstrip("\n")
        self.text = stripped if "error: " in stripped else "error: " + stripped
        self.problems = problems_of(problems) if problems else (Problem(stripped),)

    def __str__(self) -> str:
        return self.text


class RunError(InputError):
    """The file is not a readable run file, or lacks the requested data; the message states the reason."""


class NumericalError(ArithmeticError):
    """A numerical failure, not an error of the input: please report it with the model and the seed."""


class StraytraceWarning(UserWarning):
    """A warning about a result."""
