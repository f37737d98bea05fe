# SPDX-License-Identifier: BSD-3-Clause
"""Draws a run: python3 -m straytrace.plots RUN_FILE_OR_FOLDER -o report.png, --maps FOLDER for its receivers, or --wave field.png
for the field of its cavity."""

import argparse
import json
import pathlib
import sys

import matplotlib.pyplot as plt

from ..run import RunError, open_run
from . import maps, overview, wave
from .style import STYLE, save


def pictures(run, options):
    """The requested pictures, each with its file."""
    if options.wave is not None:
        figure = wave.draw(run)
        if figure is not None:
            yield figure, options.wave
        return
    if options.maps is None:
        yield overview.draw(run, options.band, options.measured), options.out
        return
    for receiver in run.receivers:
        figure = maps.draw(run, receiver)
        if figure is not None:
            yield figure, options.maps / (receiver.name.replace("/", "_") + ".png")


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="straytrace.plots", description="Draws the pictures of a run.")
    parser.add_argument("run", help="run file, or the folder that holds run.h5")
    out = parser.add_mutually_exclusive_group()
    out.add_argument("-o", "--out", type=pathlib.Path, default="report.png", help="picture of the run to write (png, pdf or svg)")
    out.add_argument("--maps", type=pathlib.Path, metavar="FOLDER", help="write the maps of the receivers instead, a NAME.png each")
    out.add_argument("--wave", type=pathlib.Path, metavar="FILE", help="draw the field of the cavity instead")
    parser.add_argument("--band", nargs=2, type=float, metavar=("LOW", "HIGH"), help="Hz, for the shares of the routes")
    parser.add_argument("--measured", type=lambda file: json.loads(pathlib.Path(file).read_text()), default=(), metavar="FILE.json",
                        help="measured strain to draw over the noise, as straytrace report writes it")
    options = parser.parse_args(arguments)
    try:
        run = open_run(options.run)
    except RunError as error:
        print(error, file=sys.stderr)
        return 2
    with plt.rc_context(STYLE if options.maps is None and options.wave is None else maps.STYLE):
        for figure, path in pictures(run, options):
            try:
                save(figure, path)
            except OSError as error:
                print(f"error: cannot write '{path}': {error.strerror}", file=sys.stderr)
                return 2
            finally:
                plt.close(figure)
    return 0


if __name__ == "__main__":
    sys.exit(main())
