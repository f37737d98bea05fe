#!/usr/bin/env python3
"""Makes the design curves of data/curves again: strain ASD of public budgets, thinned to some 400 points.

Usage: build/compare-venv/bin/python tools/data/make_design_curves.py FOLDER [--et-d ET_D_asd.txt]

Needs pygwinc (scripts/setup --test). The table of ET-D is the file ET_D_asd.txt of the package bilby from PyPI
(bilby/gw/detector/noise_curves; LIGO-P1600143); without --et-d it is left as it is.
"""
import argparse
import importlib.metadata
import pathlib

import numpy as np

CURVES = {  # name: (pygwinc name, lowest and highest frequency in Hz, points)
    "aligo-gwinc": ("aLIGO", 5, 5000, 420),
    "aplus-gwinc": ("Aplus", 5, 5000, 420),
    "ce1-gwinc": ("CE1", 3, 5000, 420),
    "ce2-silica-gwinc": ("CE2silica", 3, 5000, 420),
}


def write(path, title, hz, asd):
    rows = "".join(f"{f:.6g} {h:.6g}\n" for f, h in zip(hz, asd))
    path.write_text(f"# {title}\n# frequency [Hz], strain ASD [1/sqrt(Hz)], one-sided\n{rows}")


def thinned(hz, asd, tolerance):
    """Points that leave straight lines in log-log within the tolerance of all others, from each the farthest that does."""
    x, y, keep, n = np.log(hz), np.log(asd), [0], len(hz)
    while keep[-1] < n - 1:
        i = keep[-1]
        ahead = range(i + 1, min(i + 400, n))
        slopes = {j: (y[j] - y[i]) / (x[j] - x[i]) for j in ahead}
        good = [j for j in ahead if np.all(np.abs(y[i] + slopes[j] * (x[i + 1:j] - x[i]) - y[i + 1:j]) < tolerance)]
        keep.append(max(good))
    return keep


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--et-d", type=pathlib.Path)
    asked = parser.parse_args()
    import gwinc

    version = importlib.metadata.version("gwinc")
    for name, (ifo, low, high, points) in CURVES.items():
        hz = np.array([float(f"{f:.6g}") for f in np.geomspace(low, high, points)])
        asd = np.sqrt(gwinc.load_budget(ifo, freq=hz).run().psd)
        write(asked.folder / f"{name}.txt", f"{ifo} of pygwinc {version}: total of its budget", hz, asd)
    if asked.et_d:
        table = np.loadtxt(asked.et_d)
        thin = thinned(table[:, 0], table[:, 1], 1e-3)
        title = "ET-D, table of LIGO-P1600143 as in bilby (ET_D_asd.txt), thinned: lines in log-log miss no point by 0.1 %"
        write(asked.folder / "et-d.txt", title, table[thin, 0], table[thin, 1])


main()
