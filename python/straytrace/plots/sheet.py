# SPDX-License-Identifier: BSD-3-Clause
"""What pictures of the JSON of a command share: its numbers, title and notes, the command line."""

import argparse
import json
import pathlib
import sys
import textwrap

import matplotlib.pyplot as plt
import numpy as np

from .style import GREY, STYLE, save
from .words import shortened


def values(numbers):
    """Numbers of the JSON, where null is unknown."""
    return np.array([np.nan if x is None else x for x in numbers], dtype=float)


def frame(figure, axes, title, width, notes):
    """Title above, notes in small letters below."""
    axes.set_title("\n".join(textwrap.wrap(shortened(title, 160), width)))
    figure.text(0.01, 0.012, notes, fontsize=7.5, color=GREY, linespacing=1.4)
    figure.tight_layout(rect=(0, 0.03 + 0.022 * notes.count("\n"), 1, 1))


def draw_json(prog, about, picture, arguments=None):
    """Command line `JSON -o FILE`: draws picture(contents). Exit code 2 for an invalid file."""
    parser = argparse.ArgumentParser(prog=prog, description=about)
    parser.add_argument("json", type=pathlib.Path)
    parser.add_argument("-o", "--out", type=pathlib.Path, required=True)
    options = parser.parse_args(arguments)
    try:
        contents = json.loads(options.json.read_text(encoding="utf-8"))
        with plt.rc_context(STYLE | {"font.size": 9.5, "legend.fontsize": 8.5, "axes.titlesize": 11}):
            save(picture(contents), options.out)
    except (OSError, ValueError, KeyError) as error:
        print(f"error: {options.json}: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    return 0
