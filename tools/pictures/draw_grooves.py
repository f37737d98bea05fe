#!/usr/bin/env python3
"""Draw the picture of docs/reference/scatter/grooves: its formula, for light from across and along. No arguments."""
import pathlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

PICTURE = pathlib.Path(__file__).resolve().parents[2] / "docs/reference/scatter/grooves.png"
ACROSS, ALONG, NORMAL, GRAZING = 0.3, 0.03, 0.5, 0.9   # those of the page's example
INCIDENCE = np.radians(30)


def slant(w):
    return np.sqrt(w[2] ** 2 + (ACROSS * w[0]) ** 2 + (ALONG * w[1]) ** 2)


def brdf(wi, wo):
    h = wi[:, None, None] + wo
    size = np.sqrt((h ** 2).sum(axis=0))
    h = h / size
    spread = (h[0] / ACROSS) ** 2 + (h[1] / ALONG) ** 2 + h[2] ** 2
    normals = 1 / (np.pi * ACROSS * ALONG * spread ** 2)
    fresnel = NORMAL + (GRAZING - NORMAL) * (1 - np.minimum(size / 2, 1)) ** 5
    return fresnel * normals / (2 * (wo[2] * slant(wi) + wi[2] * slant(wo)))


def main():
    axis = np.linspace(-1, 1, 361)
    x, y = np.meshgrid(axis, axis)
    z2 = 1 - x ** 2 - y ** 2
    wo = np.stack([x, y, np.sqrt(np.maximum(z2, 1e-9))])
    figure, panels = plt.subplots(1, 2, figsize=(8, 3.9), layout="constrained")
    sine, cosine = np.sin(INCIDENCE), np.cos(INCIDENCE)
    for panel, wi, name in ((panels[0], (sine, 0, cosine), "across"), (panels[1], (0, sine, cosine), "along")):
        value = np.where(z2 > 0, np.log10(brdf(np.array(wi), wo)), np.nan)
        image = panel.imshow(value, extent=(-1, 1, -1, 1), origin="lower", vmin=-4, vmax=1.5, cmap="viridis")
        panel.plot(wi[0], wi[1], "wx", ms=7)
        panel.plot(-wi[0], -wi[1], "w+", ms=9)
        panel.set_title(f"light from 30\u00b0 {name} the grooves", fontsize=10)
        panel.set_xlabel("direction cosine across")
        panel.set_ylabel("direction cosine along")
    figure.colorbar(image, ax=panels, label="log10 BSDF / (1/sr)", shrink=0.85)
    figure.savefig(PICTURE, dpi=95)


if __name__ == "__main__":
    main()
