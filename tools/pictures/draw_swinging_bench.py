#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draw docs/theory/swinging_bench.png: strain of a bench behind an end mirror that swings, for two positions of the
scatterer a wavelength over 8 apart (R5.03): ASD of sin and cos of 4 pi x/lambda times the two responses (9.3, 9.4).

Usage: draw_swinging_bench.py. Numbers of the Virgo benches of 2019; stops when they are not those of R5.02."""
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

PICTURE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "theory" / "swinging_bench.png"
LIGHT, WAVELENGTH, LENGTH, MASS = 299792458.0, 1.064e-6, 3000.0, 42.0
TRANSMISSION, SHARE, POWER, GAIN, POLE = 4e-6, 0.03e-6, 100e3, 142.3, 55.0
SWING, HZ = 2e-6, 1.0                     # m peak, Hz
RATE, SECONDS, SEGMENT = 512, 420, 20     # samples/s, s, s of each periodogram


def response(f):
    """Strain per Im s and per Re s of the bench, with the recoupled share in the field."""
    phase = WAVELENGTH / (4 * np.pi * LENGTH) * TRANSMISSION * np.sqrt(SHARE) * np.ones_like(f)
    slow = 8 * POWER * TRANSMISSION * GAIN / (LIGHT * MASS * (2 * np.pi * f) ** 2 * LENGTH)
    return phase, slow / np.hypot(1, f / POLE) * np.sqrt(SHARE)


def asd(x):
    """One-sided ASD, Hann windows, half overlap, mean of the periodograms; 0 and half the rate left out."""
    n = RATE * SEGMENT
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(n) / n)
    parts = [window * (p - p.mean()) for p in (x[i:i + n] for i in range(0, len(x) - n + 1, n // 2))]
    psd = 2 * np.mean([np.abs(np.fft.rfft(p)) ** 2 for p in parts], axis=0) / (RATE * np.sum(window**2))
    return np.fft.rfftfreq(n, 1 / RATE)[1:-1], np.sqrt(psd)[1:-1]


def advanced_virgo(f):
    x = np.log(f / 300)
    terms = ((0.07, -0.142, -1.437, 0.407), (3.1, -0.466, -1.043, -0.548), (0.4, -0.304, 2.896, -0.293),
             (0.09, 1.466, 3.722, -0.984))
    return 1.259e-24 * sum(a * np.exp(p + q * x + r * x**2) for a, p, q, r in terms)


def main():
    phase, pressure = response(np.array([10.0, 20.0, 50.0]))
    np.testing.assert_allclose(phase[0], 1.955e-20, rtol=1e-3)
    np.testing.assert_allclose(pressure, [5.20e-19, 1.243e-19, 1.57e-20], rtol=5e-3)
    t = np.arange(RATE * SECONDS) / RATE
    figure, panels = plt.subplots(1, 2, figsize=(9.6, 4.4), dpi=100, sharey=True)
    for axes, position, name in zip(panels, (0.0, WAVELENGTH / 8), ("$x_0 = 0$", "$x_0 = \\lambda/8$")):
        angle = 4 * np.pi / WAVELENGTH * (position + SWING * np.sin(2 * np.pi * HZ * t))
        f, sine = asd(np.sin(angle))
        cosine = asd(np.cos(angle))[1]
        by_phase, by_pressure = response(f)
        axes.loglog(f, by_pressure * cosine, color="#D55E00", lw=1.4, label="radiation pressure, ASD of the cosine (9.4)")
        axes.loglog(f, by_phase * sine, color="#0072B2", lw=1.4, label="phase, ASD of the sine (9.3)")
        axes.loglog(f, advanced_virgo(f), color="#6b6b6b", lw=1.6, ls="--", label="adv-lal")
        axes.set(xlim=(2.5, 40), ylim=(1e-24, 1e-17), xticks=(3, 5, 10, 20, 30), xlabel="frequency [Hz]", title=f"scatterer at {name}")
        axes.xaxis.set_major_formatter(lambda hz, _: f"{hz:g}")
        axes.xaxis.set_minor_formatter(lambda hz, _: "")
        axes.grid(which="major", alpha=0.3)
    panels[0].set_ylabel(r"strain [1/$\sqrt{\mathrm{Hz}}$], one-sided")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=4, fontsize=8.5, frameon=False)
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    figure.savefig(PICTURE)
    print(f"{PICTURE.name}: {PICTURE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
