#!/usr/bin/python3
"""Draws the picture of docs/reference/budget.md: draw_budget.py STRAYTRACE. Traces the Virgo arm for some seconds."""
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[1]

with tempfile.TemporaryDirectory() as folder:
    program = pathlib.Path(sys.argv[1]).resolve()
    run = [program, "run", ROOT / "examples/virgo_arm.yaml", "-o", f"{folder}/run", "--histories", "3e5", "--quiet"]
    subprocess.run(run, check=True)
    subprocess.run([program, "budget", "adv", f"{folder}/run/run.h5", "--band", "5 Hz, 1 kHz", "-o", folder, "--quiet"],
                   check=True)
    picture = Image.open(f"{folder}/budget.png").convert("RGB").quantize(200)
    picture.save(ROOT / "docs/reference/budget.png", optimize=True)
