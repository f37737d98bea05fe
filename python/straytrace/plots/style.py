# SPDX-License-Identifier: BSD-3-Clause
"""Colours, fonts and the writing of files that all pictures share."""

import argparse
import json
import os
import pathlib
import sys
import tempfile

import matplotlib.pyplot as plt
from PIL import Image, ImageChops, PngImagePlugin

# Okabe and Ito: distinguishable with every common kind of colour vision. Black is the total, grey the design curve.
ROUTE_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
GREY = "#6b6b6b"
LIGHT = "#d9d9d9"
TERM_COLOURS = {"absorbed": "#0072B2", "escaped": "#56B4E9", "truncated": "#E69F00"}
STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "axes.titlesize": 12,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "legend.frameon": False,
    "legend.fontsize": 10,
}


def plain_number(x, _position=None):
    return f"{x:g}"


def shrink(name):
    """Lines, bands and text keep their look with 256 colours, in a third of the bytes; a picture that would change visibly stays."""
    with Image.open(name) as picture:
        full, text, dpi = picture.convert("RGB"), picture.info.get("Software"), picture.info.get("dpi")
    few = full.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    if max(most for _, most in ImageChops.difference(few.convert("RGB"), full).getextrema()) > 16:
        return
    origin = PngImagePlugin.PngInfo()
    if text:
        origin.add_text("Software", text)
    few.save(name, format="PNG", pnginfo=origin, dpi=dpi)


def save(figure, path):
    """Appears complete or not at all. A PNG file also states its origin in a text chunk."""
    path = pathlib.Path(path)
    handle, name = tempfile.mkstemp(prefix=path.name + ".part-", dir=path.parent or ".")
    os.close(handle)
    try:
        made_by = next((text.get_text() for text in figure.texts if "straytrace " in text.get_text()), None)
        as_png = {"metadata": {"Software": made_by}, "pil_kwargs": {"compress_level": 1}} if path.suffix == ".png" else {}
        figure.savefig(name, format=path.suffix[1:] or "png", **as_png)
        if path.suffix == ".png":
            shrink(name)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, path)
    finally:
        pathlib.Path(name).unlink(missing_ok=True)


def draw_file(arguments, name, about, kind, draw):
    """Command line of a module that draws one JSON file, of kind `kind`, as NAME.png unless -o names another picture."""
    parser = argparse.ArgumentParser(prog=f"straytrace.plots.{name}", description=about)
    parser.add_argument("file", metavar=name, help=kind)
    parser.add_argument("-o", "--out", default=f"{name}.png")
    options = parser.parse_args(arguments)
    try:
        with open(options.file, encoding="utf-8") as file:
            content = json.load(file)
        with plt.rc_context(STYLE):
            figure = draw(content)
            save(figure, options.out)
            plt.close(figure)
    except (OSError, ValueError, KeyError) as error:
        print(f"error: {options.file}: {error}", file=sys.stderr)
        return 1
    return 0
