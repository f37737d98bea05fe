#!/usr/bin/env python3
"""Draw the pictures of docs/reference/interfaces. Usage: plot_interfaces.py [ROOT]"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

LINE = 1064e-9                          # m
SILICA = 1.45003


def amplitudes(angle, n_in, layers, n_out):
    """r_s, r_p and power transmittances of a stack of (index, thickness in m) by characteristic matrices."""
    sine = n_in * np.sin(angle)
    result = []
    for p in (False, True):
        def admittance(n):
            q = np.sqrt(n * n - sine * sine + 0j)
            return q, (q / (n * n) if p else q)
        (_, y_in), (_, y_out) = admittance(n_in), admittance(n_out)
        b, c = np.ones_like(y_out), y_out
        for n, thickness in reversed(layers):
            q, y = admittance(n)
            phase = 2 * np.pi * q * thickness / LINE
            b, c = np.cos(phase) * b - 1j * np.sin(phase) / y * c, -1j * y * np.sin(phase) * b + np.cos(phase) * c
        r, t = (y_in * b - c) / (y_in * b + c), 2 * y_in / (y_in * b + c)
        result.append((r, np.abs(t) ** 2 * np.real(y_out / y_in)))
    return result


def figure(path, draw, height=3.6):
    fig, axes = plt.subplots(1, 2, figsize=(8, height), dpi=100)
    draw(axes)
    for ax in axes:
        ax.grid(alpha=0.3)
        ax.legend(fontsize=8, frameon=False)
    fig.tight_layout()
    fig.savefig(path)
    plt.close(fig)


def power_axes(ax, title):
    ax.set(xlabel="angle of incidence (deg)", ylabel="share of power", title=title, xlim=(0, 90), ylim=(0, 1.02))


DEGREES = np.linspace(0, 89.99, 1800)
ANGLES = np.radians(DEGREES)


def fixed(axes):
    for ax, (reflect, transmit), title in zip(axes, ((0.7, 0.28), (0.05, 0.0)), ("reflect: 0.7, transmit: 0.28",
                                                                                 "reflect: 0.05")):
        ax.stackplot([0, 90], [[reflect] * 2, [transmit] * 2, [1 - reflect - transmit] * 2],
                     labels=["R", "T", "absorbed or scattered"], colors=["C0", "C1", "0.85"])
        power_axes(ax, title)


def fresnel(axes):
    for ax, (n_in, n_out), title in zip(axes, ((1, SILICA), (SILICA, 1)), ("vacuum to silica", "silica to vacuum")):
        for (r, _), name in zip(amplitudes(ANGLES, n_in, [], n_out), ("s", "p")):
            ax.plot(DEGREES, np.abs(r) ** 2, label=f"R {name}")
        power_axes(ax, title)


def film(axes):
    quarter = [(1.38, LINE / 4 / 1.38)]
    for (r, _), name in zip(amplitudes(ANGLES, 1, quarter, 1.52), ("s", "p")):
        axes[0].plot(DEGREES, np.abs(r) ** 2, label=f"R {name}, MgF$_2$ on 1.52")
    power_axes(axes[0], "one quarter wave")
    axes[0].set(ylim=(0, 0.3), xlim=(0, 75))
    high, low = (2.07, LINE / 4 / 2.07), (1.45, LINE / 4 / 1.45)
    for (_, t), name in zip(amplitudes(ANGLES, 1, [high] + 18 * [low, high], 1.45), ("s", "p")):
        axes[1].semilogy(DEGREES, np.maximum(t, 1e-9), label=f"T {name}, (HL)$^{{18}}$H")
    axes[1].set(xlabel="angle of incidence (deg)", ylabel="share of power", title="mirror, 37 layers", xlim=(0, 90),
                ylim=(1e-7, 2))


STEEL = ((0, 0.005, 0.6), (60, 0.005, 0.6), (70, 0.02, 0.57), (80, 0.11, 0.45), (82, 0.19, 0.39), (84, 0.26, 0.33),
         (85, 0.30, 0.30), (86, 0.40, 0.25), (87, 0.50, 0.20), (88, 0.70, 0.10), (89, 0.90, 0.02), (90, 1, 0))


def coating(axes):
    table = np.array(STEEL)
    columns = np.c_[table[:, 1], 1 - table[:, 1] - table[:, 2], table[:, 2]]
    for ax, low in zip(axes, (0, 78)):
        for k, name in enumerate(("R", "S", "absorbed")):
            ax.plot(table[:, 0], columns[:, k], "o-", ms=3, lw=1, color=f"C{k}", label=name)
        power_axes(ax, "tube_steel, entries")
        ax.set_xlim(low, 90)


def polarisation(axes):
    for ax, (n_in, n_out), title in zip(axes, ((1, SILICA), (SILICA, 1)), ("reflected, unpolarised light in",
                                                                           "silica to vacuum, light at 45 deg in")):
        (rs, _), (rp, _) = amplitudes(ANGLES, n_in, [], n_out)
        power = 0.5 * (np.abs(rs) ** 2 + np.abs(rp) ** 2)
        if n_in == 1:
            ax.plot(DEGREES, 0.5 * (np.abs(rs) ** 2 - np.abs(rp) ** 2) / power, label="q")
        else:
            cross = rs * np.conj(rp) / power
            ax.plot(DEGREES, cross.real, label="u")
            ax.plot(DEGREES, -cross.imag, label="v")
        ax.set(xlabel="angle of incidence (deg)", ylabel="Stokes over power", title=title, xlim=(0, 90),
               ylim=(-1.05, 1.05))


def media(axes):
    def sellmeier(x, strengths, resonances):
        return np.sqrt(1 + sum(b * x * x / (x * x - c) for b, c in zip(strengths, resonances)))
    x = np.linspace(0.4, 2.2, 400)
    axes[0].plot(x, sellmeier(x, (0.6961663, 0.4079426, 0.8974794), (0.0684043**2, 0.1162414**2, 9.896161**2)),
                 label="fused_silica")
    axes[0].plot(x, sellmeier(x, (1.03961212, 0.231792344, 1.01046945), (0.00600069867, 0.0200179144, 103.560653)),
                 label="bk7")
    axes[0].plot(x, sellmeier(x, (1.4313493, 0.65054713, 5.3414021), (0.0726631**2, 0.1193242**2, 18.028251**2)),
                 label="sapphire")
    axes[0].set(xlabel="wavelength (µm)", ylabel="refractive index n")
    x = np.linspace(1.36, 4, 300)
    axes[1].plot(x, sellmeier(x, (10.6684293, 0.003043475, 1.54133408), (0.301516485**2, 1.13475115**2, 1104.0**2)),
                 label="silicon", color="C3")
    axes[1].set(xlabel="wavelength (µm)", ylabel="refractive index n")


def main(root):
    folder = root / "docs" / "reference" / "interfaces"
    for draw in (fixed, fresnel, film, coating, polarisation, media):
        figure(folder / f"{draw.__name__}.png", draw)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve())
