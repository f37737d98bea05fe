# SPDX-License-Identifier: BSD-3-Clause
"""Uncertainties of a run other than its Monte-Carlo error, as bands of its picture."""

import numpy as np

SPECKLE, INPUT, POSITIONS = "#56B4E9", "#E69F00", "#009E73"     # Okabe and Ito


def draw_bands(axes, noise):
    """Uncertainty by static phases and inputs: the wide pale band is speckle, the hatched one the inputs."""
    bands, f = noise.bands, noise.frequency
    if noise.positions is not None:
        p = noise.positions
        axes.fill_between(f, np.maximum(p.low, 1e-300), p.high, color=POSITIONS, alpha=0.3, lw=0, zorder=2,
                          label=f"{len(p.static_phase)} positions of {p.body}")
    if bands is None:
        return
    axes.fill_between(f, np.maximum(bands.speckle_05, 1e-300), bands.speckle_95, color=SPECKLE, alpha=0.22, lw=0,
                      label="one realisation: 5 to 95 %", zorder=1)
    axes.plot(f, bands.speckle_95, color=SPECKLE, lw=0.8, zorder=1)
    if bands.sources:
        axes.fill_between(f, np.maximum(bands.input_low, 1e-300), bands.input_high, facecolor="none", hatch="////",
                          edgecolor=INPUT, alpha=0.7, lw=0.6, label="stated input uncertainty", zorder=2)
