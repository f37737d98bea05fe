#!/usr/bin/python3
"""Draws the picture of docs/reference/budget.md: draw_budget.py STRAYTRACE. Traces the Virgo arm for some seconds."""
import pathlib
import subprocess
import sys
import tempfile

from pictures import ROOT, small

with tempfile.TemporaryDirectory() as folder:
    program = pathlib.Path(sys.argv[1]).resolve()
    run = [program, "run", ROOT / "examples/virgo_arm.yaml", "-o", f"{folder}/run", "--histories", "3e5", "--quiet"]
    subprocess.run(run, check=True)
    subprocess.run([program, "budget", "adv", f"{folder}/run/run.h5", "--band", "5 Hz, 1 kHz", "-o", folder, "--quiet"],
                   check=True)
    small(f"{folder}/budget.png", ROOT / "docs/reference/budget.png")
