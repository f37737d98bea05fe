#!/usr/bin/python3
"""Draw the picture of the page of receivers from examples/two_mirrors.yaml. Usage: draw_receivers.py PROGRAM [ROOT]"""
import pathlib
import subprocess
import sys
import tempfile

from pictures import small

RECEIVER = "plane"


def main(program, root):
    with tempfile.TemporaryDirectory() as folder:
        run = f"{folder}/run.h5"
        scene = root / "examples" / "two_mirrors.yaml"
        subprocess.run([program, "trace", scene, "-o", run, "--quiet", "--histories", "2e6"], check=True,
                       stdout=subprocess.DEVNULL)
        subprocess.run([program, "maps", run, "-o", folder], check=True, stdout=subprocess.DEVNULL)
        small(f"{folder}/{RECEIVER}.png", root / "docs" / "reference" / "receivers.png", colours=128)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else
                                                           pathlib.Path(__file__).parents[2]).resolve())
