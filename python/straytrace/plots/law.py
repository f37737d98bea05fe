# SPDX-License-Identifier: BSD-3-Clause
"""Draws a BSDF model: python3 -m straytrace.plots.law LAW.json -o law.png, LAW.json as `straytrace inspect` prints it."""

import argparse
import json
import sys

import matplotlib.pyplot as plt

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")  # Okabe and Ito
STYLE = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False}


def draw(law):
    with plt.rc_context(STYLE):
        figure, (lobe, total) = plt.subplots(1, 2, figsize=(8.5, 3.6), dpi=100, width_ratios=(3, 2))
        colours = {}
        top = 0.0
        for curve in law["bsdf"]:
            colour = colours.setdefault(curve["deg"], COLOURS[len(colours) % len(COLOURS)])
            label = f"{curve['deg']:g} deg" + ("" if curve["side"] > 0 else ", through")
            lobe.loglog(curve["offset"], curve["bsdf"], color=colour, linestyle="-" if curve["side"] > 0 else "--",
                        label=label, linewidth=1.4)
            top = max([top, *curve["bsdf"]])
        if top > 0:
            lowest = min(v for c in law["bsdf"] for v in c["bsdf"] if v > 0)
            lobe.set_ylim(max(lowest / 3, top * 1e-12), top * 3)
            lobe.legend(title="incidence")
        lobe.set_xlim(1e-5, 2)
        lobe.set_xlabel(r"$|\beta-\beta_0|$ (direction cosines)")
        lobe.set_ylabel("BSDF [1/sr]")
        lobe.set_title(law["material"], loc="left", fontweight="bold")
        angle = [row["deg"] for row in law["tis"]]
        for key, colour, label in (("scattered", COLOURS[0], "scattered (TIS)"), ("reflect", COLOURS[1], "specular R"),
                                   ("transmit", COLOURS[2], "specular T")):
            values = [row[key] for row in law["tis"]]
            if max(values) > 0:
                total.semilogy(angle, values, color=colour, marker=".", label=label)
        total.set_xlabel("incidence [deg]")
        total.set_ylabel("share of the power")
        if total.lines:
            total.legend()
        for axes in (lobe, total):
            axes.grid(True, which="major", color="#d9d9d9", linewidth=0.6)
        figure.tight_layout()
        return figure


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("law")
    parser.add_argument("-o", "--out", required=True)
    options = parser.parse_args(arguments)
    try:
        with open(options.law, encoding="utf-8") as file:
            law = json.load(file)
        figure = draw(law)
        figure.savefig(options.out, pil_kwargs={"optimize": True})
    except (OSError, ValueError, KeyError) as error:
        print(f"error: {options.law}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
