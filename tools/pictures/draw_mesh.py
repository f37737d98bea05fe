#!/usr/bin/python3
"""Draw the picture of the page of meshes from examples/holder.obj. Usage: draw_mesh.py [ROOT]"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # noqa: E402
from PIL import Image  # noqa: E402

COLOUR = {"pocket": "#1f5fa8", "outside": "#c9ccd1"}


def faces(path):
    """Group and corners of every face."""
    vertices, group, found = [], "", []
    for line in path.read_text(encoding="utf-8").splitlines():
        key, *words = line.split() or [""]
        if key == "v":
            vertices.append([float(w) for w in words])
        elif key == "g":
            group = words[0]
        elif key == "f":
            found.append((group, [vertices[int(w.split("/")[0]) - 1] for w in words]))
    return found


def main(root):
    figure = plt.figure(figsize=(7.2, 4.2), dpi=100)
    for number, (azimuth, title) in enumerate(((-60, "from the front"), (30, "from the side"))):
        axes = figure.add_subplot(1, 2, number + 1, projection="3d")
        for group, corners in faces(root / "examples" / "holder.obj"):
            axes.add_collection3d(Poly3DCollection([corners], facecolor=COLOUR[group], edgecolor="k", linewidth=0.6,
                                                   alpha=0.75))
        axes.set(xlim=(-25, 25), ylim=(-25, 25), zlim=(0, 50), xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]",
                 title=title)
        axes.view_init(elev=35, azim=azimuth)
    figure.subplots_adjust(left=0.02, right=0.94, wspace=0.22)
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])
    picture.quantize(48).save(root / "docs" / "reference" / "shapes" / "mesh.png", optimize=True)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2])
