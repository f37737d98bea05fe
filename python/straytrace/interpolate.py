# SPDX-License-Identifier: BSD-3-Clause
"""Between the frequencies of a curve."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

BEYOND = ("nan", "constant", "slope")
Array = npt.NDArray[np.float64]


def log_log(hz: npt.ArrayLike, frequency: Array, strain: npt.ArrayLike, beyond: str = "nan") -> Array:
    """Straight lines in log-log between the points; beside a point of 0, in value over log f. Outside them: `nan`, not
    known; `constant`, the value at the end; `slope`, on with the power law of the last two points. On from a 0 it is 0."""
    if beyond not in BEYOND:
        raise ValueError(f"beyond is one of {', '.join(BEYOND)}, not '{beyond}'")
    known_values = np.asarray(strain, float)
    x, known = np.atleast_1d(np.log(np.asarray(hz, float))), np.log(frequency)
    with np.errstate(divide="ignore"):
        y = np.log(known_values)
    outside: Any = np.nan if beyond == "nan" else None
    zero = known_values == 0
    beside = np.interp(x, known, zero.astype(float), left=0, right=0) > 0
    value: Array = np.interp(x, known, np.where(zero, 0, y), left=outside, right=outside)
    if beyond == "slope":
        for side, (i, k) in ((x < known[0], (0, 1)), (x > known[-1], (-1, -2))):
            value[side] = np.nan if zero[i] or zero[k] else y[i] + (y[k] - y[i]) / (known[k] - known[i]) * (x[side] - known[i])
    value = np.exp(value)
    value[beside] = np.interp(x[beside], known, known_values)
    for side, i in ((x < known[0], 0), (x > known[-1], -1)):
        if zero[i] and beyond != "nan":
            value[side] = 0
    return value.reshape(np.shape(np.asarray(hz)))
