#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The program against other codes that solve the whole problem (docs/theory/codes.md).

Each case gives another code the stated inputs (tools/codes/inputs.json), compares all results, and repeats the comparison with wrong
inputs, which must disagree. Needs scripts/setup --peers.

Examples:
  scripts/validation codes                  all cases
  scripts/validation codes response         the response of a moving scatterer, FINESSE 3
  scripts/validation codes --write          put the tables and pictures into the page
"""
import argparse
import importlib
import json
import pathlib
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PAGES = SOURCE / "docs/theory"
CASES = {"response": "FINESSE 3", "ghosts": "gtrace", "receivers": "Mitsuba 3 and Raysect", "field": "OSCAR",
         "shelves": "measured shelves of Enhanced LIGO"}


def write(name, lines, draw):
    """Lines between <!-- name --> and <!-- end -->, and the picture."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    page = PAGES / ("published.md" if name == "shelves" else "codes.md")
    text = page.read_text(encoding="utf-8")
    begin = text.index(f"<!-- {name} -->") + len(f"<!-- {name} -->")
    end = text.index("<!-- end -->", begin)
    page.write_text(text[:begin] + "\n\n" + "\n".join(lines) + "\n\n" + text[end:], encoding="utf-8")
    figure, axis = plt.subplots(figsize=(7, 4.2), layout="constrained")
    draw(axis)
    figure.savefig(PAGES / f"codes_{name}.png", dpi=130, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(prog="scripts/validation codes", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="case", choices=[[], *CASES], help=f"{', '.join(CASES)}; default: all")
    parser.add_argument("--program", default=str(SOURCE / "build/straytrace"))
    parser.add_argument("--write", action="store_true", help="put tables and pictures into the pages")
    asked = parser.parse_args()
    inputs = json.loads((pathlib.Path(__file__).parent / "inputs.json").read_text(encoding="utf-8"))
    fine = True
    for name in asked.cases or CASES:
        lines, draw, good, controls = importlib.import_module(name).run(asked.program, inputs.get(name))
        lines += ["", "| wrong input (control) | |", "| --- | --- |"]
        lines += [f"| {what} | {'rejected' if rejected else '**not rejected**'} |" for what, rejected in controls.items()]
        print(f"{name}: {CASES[name]}", *lines, "", sep="\n", flush=True)
        if asked.write:
            write(name, lines, draw)
        fine = fine and good and all(controls.values())
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
