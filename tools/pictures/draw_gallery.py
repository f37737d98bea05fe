#!/usr/bin/env python3
"""Draw the pictures of docs/guide/gallery.md: the report of each run and two views down a tube, small.

Usage: draw_gallery.py PROGRAM [NAME...], such as kagra_arm, or geo_tube
"""
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

from pictures import ROOT, small

PAGES = ROOT / "docs" / "guide"
RUNS = ("virgo_tube", "virgo_defect", "et_lf_arm", "kagra_arm", "ligo_arm", "ce_arm")
VIEWS = {"closed": (), "open": ("-p", "spacing=1.2")}
WIDTH = 1000


def main(program, names):
    with tempfile.TemporaryDirectory() as folder:
        for name in [n for n in RUNS if n in names]:
            subprocess.run([program, "run", ROOT / f"examples/{name}.yaml", "-o", f"{folder}/{name}", "--quiet"], check=True,
                           stdout=subprocess.DEVNULL)
            small(f"{folder}/{name}/report.png", PAGES / f"gallery_{name}.png", WIDTH)
        if "geo_tube" not in names:
            return
        for name, options in VIEWS.items():
            subprocess.run([program, "render", ROOT / "examples/geo_tube.yaml", *options, "-o", f"{folder}/{name}.png", "--from",
                            "near", "--fov", "4deg", "--pixels", "400x400", "--quiet"], check=True, stdout=subprocess.DEVNULL)
        both = [Image.open(f"{folder}/{name}.png").convert("RGB") for name in VIEWS]
        side = Image.new("RGB", (820, 400), "white")
        for i, image in enumerate(both):
            side.paste(image, (420 * i, 0))
        side.save(f"{folder}/views.png")
        small(f"{folder}/views.png", PAGES / "gallery_geo_tube.png", WIDTH)


if __name__ == "__main__":
    if len(sys.argv) < 2 or set(sys.argv[2:]) - {*RUNS, "geo_tube"}:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:] or (*RUNS, "geo_tube"))
