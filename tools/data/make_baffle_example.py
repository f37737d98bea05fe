#!/usr/bin/env python3
"""Write examples/data/baffle_watts.csv: the power on the photodiodes of examples/instrumented_baffle.yaml, as measured.

Usage: make_baffle_example.py PROGRAM SCENE FILE

The truth differs from the scene: baffle shifted by 0.4 mm and -0.2 mm, mirrors that scatter 1.5 times as much, with heights of other seeds.
The measurement adds noise of 1 % and 1e-9 W.
"""
import csv
import pathlib
import random
import subprocess
import sys
import tempfile

TRUTH = {"shift_x": "0.4 mm", "shift_y": "-0.2 mm", "polish": "3e-8 /sr", "draw_I": "2023", "draw_E": "2024"}


def main(program, scene, file):
    with tempfile.TemporaryDirectory() as folder:
        every = pathlib.Path(folder) / "photodiodes.csv"
        words = [program, "wave", scene, "--csv", every, "--quiet"] + [w for name, value in TRUTH.items() for w in ("-p", f"{name}={value}")]
        subprocess.run(words, check=True, capture_output=True)
        table = list(csv.DictReader(every.read_text().splitlines()))
    noise = random.Random(20230714)
    with open(file, "w", encoding="ascii") as out:
        out.write("# made by tools/data/make_baffle_example.py\nphotodiode, power [W], error [W]\n")
        for row in table:
            power = float(row["power [W]"])
            error = 0.01 * power + 1e-9
            out.write(f"{row['photodiode']}, {noise.gauss(power, error):.5g}, {error:.2g}\n")


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
