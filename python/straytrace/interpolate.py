# SPDX-License-Identifier: BSD-3-Clause
"""Between the frequencies of a curve."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

BORDER = 1e-5     # of the frequency: distance of points from the border of a bin
BEYOND = ("nan", "constant", "slope")
Array = npt.NDArray[np.float64]


def between_bins(hz: npt.ArrayLike, edges: Array, mean: npt.ArrayLike) -> Array:
    """A curve of averages over bins, as `straytrace paths` reads it: straight in log-log between the centres; next to a bin
    above twice the geometric mean of its neighbours (a line) or a bin of 0 the average of the bin; NaN outside the bins."""
    x, value = np.atleast_1d(np.asarray(hz, float)), np.asarray(mean, float)
    centre, n = np.sqrt(edges[:-1] * edges[1:]), len(edges) - 1
    own = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, n - 1)
    result: Array = value[own]
    if n > 1:
        low = np.clip(np.searchsorted(centre, x, side="right") - 1, 0, n - 2)
        out = np.zeros(n, dtype=bool)
        out[1:-1] = value[1:-1] ** 2 > 4 * value[:-2] * value[2:]
        smooth = (value[low] > 0) & (value[low + 1] > 0) & ~out[low] & ~out[low + 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.log(x / centre[low]) / np.log(centre[low + 1] / centre[low])
            result = np.where(smooth, value[low] * (value[low + 1] / value[low]) ** share, result)
    result = np.where((x >= edges[0]) & (x < edges[-1]), result, np.nan)
    return result.reshape(np.shape(np.asarray(hz)))


def with_borders_of_lines(edges: Array, mean: npt.ArrayLike) -> tuple[Array, Array]:
    """Centres of bins and averages over them, and points on either side of the borders of bins that hold a line, as
    between_bins() knows it: between all of them the line stays within its bin, and its PSD times the width is its power."""
    centre, value = np.sqrt(edges[:-1] * edges[1:]), np.asarray(mean, float)
    lines = 1 + np.flatnonzero(value[1:-1] ** 2 > 4 * value[:-2] * value[2:])
    borders = np.union1d(lines, lines + 1)
    hz = np.concatenate([centre, edges[borders] * (1 - BORDER), edges[borders] * (1 + BORDER)])
    asd = np.concatenate([value, value[borders - 1], value[borders]])
    order = np.argsort(hz, kind="stable")
    return hz[order], asd[order]


def log_log(hz: npt.ArrayLike, frequency: Array, strain: npt.ArrayLike, beyond: str = "nan") -> Array:
    """Straight lines in log-log between the points; next to a point of 0, linear in value over log f. Outside them: `nan`, not
    known; `constant`, the value at the end; `slope`, on with the power law of the last two points. On from a 0 it is 0."""
    if beyond not in BEYOND:
        raise ValueError(f"beyond is one of {', '.join(BEYOND)}, not '{beyond}'")
    known_values = np.asarray(strain, float)
    x, known = np.atleast_1d(np.log(np.asarray(hz, float))), np.log(frequency)
    with np.errstate(divide="ignore"):
        y = np.log(known_values)
    outside: Any = np.nan if beyond == "nan" else None
    zero = known_values == 0
    near_zero = np.interp(x, known, zero.astype(float), left=0, right=0) > 0
    value: Array = np.interp(x, known, np.where(zero, 0, y), left=outside, right=outside)
    if beyond == "slope":
        for side, (i, k) in ((x < known[0], (0, 1)), (x > known[-1], (-1, -2))):
            value[side] = np.nan if zero[i] or zero[k] else y[i] + (y[k] - y[i]) / (known[k] - known[i]) * (x[side] - known[i])
    value = np.exp(value)
    value[near_zero] = np.interp(x[near_zero], known, known_values)
    for side, i in ((x < known[0], 0), (x > known[-1], -1)):
        if zero[i] and beyond != "nan":
            value[side] = 0
    return value.reshape(np.shape(np.asarray(hz)))
