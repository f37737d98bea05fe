# SPDX-License-Identifier: BSD-3-Clause
"""Curves for gwpy (the extra straytrace[gwpy])."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ..curves import Curve, Noise

UNIT = "1 / Hz(1/2)"  # as gwpy writes it


def frequency_series(noise: Noise, curve: Curve, interpolate: float | None) -> Any:
    """Noise.to_gwpy."""
    try:
        from gwpy.frequencyseries import FrequencySeries
    except ImportError:
        raise ImportError("to_gwpy needs gwpy, which is not here: pip install gwpy") from None
    f, values = noise.frequency, curve.mean
    steps = np.diff(f)
    if interpolate is not None:
        if not interpolate > 0:
            raise ValueError(f"interpolate is the step of the frequencies in Hz, for example 0.5, not {interpolate!r}")
        count = np.arange(np.ceil(f[0] / interpolate), np.floor(f[-1] / interpolate) + 1)
        if len(count) < 2:
            raise ValueError(f"a step of {interpolate:g} Hz leaves fewer than two points in {f[0]:g} to {f[-1]:g} Hz")
        f = count * interpolate
        values = noise.at(f, curve)
        steps = np.full(len(f) - 1, interpolate)
    elif len(f) < 2 or np.ptp(steps) > 1e-9 * steps[0]:
        raise ValueError(f"a FrequencySeries needs a regular axis, but this one grows from steps of {steps[0]:.3g} Hz to "
                         f"{steps[-1]:.3g} Hz; write to_gwpy(interpolate=0.5) for steps of 0.5 Hz, or take table(), which "
                         "holds any axis")
    title = (noise.run.title if noise.run is not None else "") or "stray light"
    name = title + noise.bound if curve is noise.total else curve.name + (" (at most)" if curve.at_most.any() else "")
    return FrequencySeries(values, unit=UNIT, f0=f[0], df=steps[0], name=name)
