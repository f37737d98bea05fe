# SPDX-License-Identifier: BSD-3-Clause
"""Numbers and names as text."""

import os.path

import numpy as np


def shortened(text, length):
    """Keeps both ends of a long name, where light leaves and rejoins the beam."""
    if len(text) <= length:
        return text
    head = (length - 1) // 2
    return text[:head] + "…" + text[-(length - 1 - head):]


def told_apart(names, length):
    """Long names made shorter, each around the place where it differs from those that would look the same."""
    short = [shortened(name, length) for name in names]
    told = list(short)
    for i, name in enumerate(names):
        alike = {other for other, s in zip(names, short) if s == short[i]}
        if len(alike) > 1:
            start = name.rfind(" ", 0, len(os.path.commonprefix(list(alike)))) + 1
            end = length // 4
            told[i] = f"{name[:end]}…{name[start:start + length - 2 * end - 2]}…{name[-end:]}"
    return told


def _last_digit(sigma):
    """Decimal place of the last digit that the error allows: one digit of it, two when it begins with 1."""
    top = int(np.floor(np.log10(sigma)))
    return top - 1 if sigma / 10.0**top < 1.95 else top


def plain(value, sigma, unit=""):
    """6.1 ± 0.2, with the digits that the error allows."""
    if not (np.isfinite(value) and np.isfinite(sigma)):
        return "unresolved"
    if sigma == 0:
        return f"{value:.4g} ± 0{unit}"
    digits = max(0, -_last_digit(sigma))
    if digits > 6:
        return f"{value:.3g} ± {sigma:.1g}{unit}"
    return f"{value:.{digits}f} ± {sigma:.{digits}f}{unit}"


def power_of_ten(value, sigma, bound=False):
    """(1.23 ± 0.04) x 10^-24; without an error it was computed, not sampled; an upper bound has two digits, rounded up."""
    if bound and value > 0:
        exponent = int(np.floor(np.log10(value)))
        digits = np.ceil(value / 10.0 ** (exponent - 1) * (1 - 1e-12)) / 10
        return rf"at most {digits:.1f}$\times 10^{{{exponent}}}$"
    if not (np.isfinite(value) and np.isfinite(sigma)):
        return "unresolved"
    if max(abs(value), sigma) == 0:
        return "0"
    exponent = int(np.floor(np.log10(max(abs(value), sigma))))
    if -2 <= exponent <= 3:
        return plain(value, sigma)
    scale = 10.0**exponent
    if sigma == 0:
        return rf"{value / scale:.3g}$\times 10^{{{exponent}}}$ (computed)"
    return rf"({plain(value / scale, sigma / scale)})$\times 10^{{{exponent}}}$"


def hertz(value):
    """Three digits, never in powers of ten."""
    return f"{float(f'{value:.3g}'):.10g}"
