# SPDX-License-Identifier: BSD-3-Clause
"""Strain noise as numpy arrays and tables. All strains are one-sided ASDs in 1/sqrt(Hz), [n] over frequency."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .errors import RunError

if TYPE_CHECKING:
    import pandas

    from .model import Model
    from .run import Run

Array = npt.NDArray[np.float64]
BORDER = 1e-5     # of the frequency: distance of points from the border of a bin
BEYOND = ("nan", "constant", "slope")


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


@dataclass
class Curve:
    """One strain noise curve on the frequencies of the run."""

    name: str
    mean: Array                       # [n] speckle (ensemble) average
    sigma: Array                      # [n] one standard error, Monte Carlo
    phase: Array                      # [n] of it: phase quadrature
    amplitude: Array                  # [n] of it: amplitude quadrature
    resolved: bool = True
    why_not: str = ""
    mean_square_phase: float = 0.0    # rad^2
    linear_share: Array | None = None    # [n] fraction of the PSD from motion at that frequency; None before schema 1.5
    input_low: Array | None = None       # [n] of routes: range due to stated inputs; None before schema 1.6
    input_high: Array | None = None
    bound_share: Array | None = None     # [n] of the total: PSD fraction of upper bounds; None before schema 1.8

    @property
    def at_most(self) -> npt.NDArray[np.bool_]:
        """[n] True where upper bounds make a part of `mean`: the true value may be lower by more than 0.05 % and its
        error, which does not count while routes are unresolved."""
        if self.bound_share is None:
            return np.zeros(len(self.mean), dtype=bool)
        less = self.mean * (1 - np.sqrt(np.clip(1 - self.bound_share, 0, None)))
        bound: npt.NDArray[np.bool_] = less > np.maximum(self.sigma if self.resolved else 0, 5e-4 * self.mean)
        return bound


@dataclass
class Bands:
    """Bands of the total other than its Monte Carlo error, [n], 1/sqrt(Hz)."""

    input_low: Array                  # range due to brackets and uncertainties of the input
    input_high: Array
    speckle_05: Array                 # percentiles of one realisation of the static phases
    speckle_50: Array
    speckle_95: Array
    coherent: Array                   # linear sum of the ASDs of the routes
    sources: list[tuple[str, str, float, float, float]]    # name, statement, factors on the total, share of the noise
    taken_as_exact: list[str]


@dataclass
class Positions:
    """Totals with one body at several positions along the beam, over a quarter of the wavelength."""

    body: str
    static_phase: Array               # [p] rad, of the light that it moves
    asd: Array                        # [p, n] 1/sqrt(Hz); the mean of the PSDs is that of the total

    @property
    def low(self) -> Array:
        """[n] Lowest curve at each frequency."""
        lowest: Array = np.min(self.asd, axis=0)
        return lowest

    @property
    def high(self) -> Array:
        """[n] Highest curve at each frequency."""
        highest: Array = np.max(self.asd, axis=0)
        return highest


@dataclass
class Noise:
    """The strain noise of a run. Call it to get the noise for other motion: ``run.noise(motion="storm.yaml")``."""

    frequency: Array                  # [n] Hz, geometric centres of bins
    edges: Array                      # [n + 1] Hz
    total: Curve                      # includes hints of unresolved routes; a lower bound if `unresolved` is not empty
    routes: list[Curve]               # one per route of the run
    unresolved: list[str]             # names with reason
    faint: list[str]                  # also unresolved, but too faint to affect the total
    design: dict[str, Array]          # name: ASD
    margin: float                     # of the first design curve
    bands: Bands | None = None      # None if only the mean was computed
    positions: Positions | None = None  # of a body whose `static_phase` has `positions`
    run: Run | None = field(default=None, repr=False, compare=False)

    @property
    def bound(self) -> str:
        """Kind of the total, for titles: "", " (lower bound)", " (at most)", or, where upper bounds make a part of it and
        routes are unresolved, " (contains upper bounds; 2 routes unresolved)": then it is no bound."""
        missing = len(self.unresolved)
        if self.total.at_most.any():
            routes = f"{missing} route{'' if missing == 1 else 's'} unresolved"
            return f" (contains upper bounds; {routes})" if missing else " (at most)"
        return " (lower bound)" if missing else ""

    @property
    def bounds(self) -> npt.NDArray[np.str_]:
        """[n] The total at each frequency is a "lower" bound (routes are unresolved), an "upper" one (upper bounds make
        a part of it), "neither" (both), or "" (a value with its error)."""
        upper: npt.NDArray[np.bool_] = self.total.at_most
        return np.where(upper, "neither", "lower") if self.unresolved else np.where(upper, "upper", "")

    def __call__(self, motion: Model | Mapping[str, Any] | str | os.PathLike[str] | None = None,
                 response: Model | Mapping[str, Any] | str | os.PathLike[str] | None = None) -> "Noise":
        """The noise of the same traced light with other motion or responses, without tracing: Run.project."""
        if self.run is None:
            raise RunError("this noise is of no run that could be projected again")
        noise = self.run.project(motion, response).noise
        assert noise is not None
        return noise

    def power(self, curve: Curve, low: float = 0.0, high: float = np.inf) -> tuple[float, float]:
        """Integral of the PSD over the band [Hz], strain^2, and its error (the errors of bins add linearly)."""
        inside = (self.frequency >= low) & (self.frequency <= high)
        width = np.diff(self.edges)[inside]
        mean, sigma = curve.mean[inside], curve.sigma[inside]
        return float(np.sum(mean**2 * width)), float(np.sum(2 * mean * sigma * width))

    def shares(self, low: float = 0.0, high: float = np.inf) -> tuple[Array, Array]:
        """Share of each route in the resolved noise power of the band [Hz], and its error; NaN where unresolved."""
        powers = np.array([self.power(r, low, high) for r in self.routes]).reshape(-1, 2)
        resolved = np.array([r.resolved for r in self.routes], dtype=bool)
        value, sigma = np.where(resolved[:, None], powers, 0.0).T
        total, variance = value.sum(), np.sum(sigma**2)
        if total <= 0:
            return np.full(len(value), np.nan), np.full(len(value), np.nan)
        share = value / total
        others = np.maximum(variance - sigma**2, 0)
        error = np.sqrt((1 - share) ** 2 * sigma**2 + share**2 * others) / total
        return np.where(resolved, share, np.nan), np.where(resolved, error, np.nan)

    def at(self, hz: npt.ArrayLike, curve: Curve | None = None) -> Array:
        """The ASD of the total, or of a curve, at frequencies: linear in log-log between bin centres, the average of
        the bin next to a line or a zero, NaN outside the band."""
        return between_bins(hz, self.edges, (curve or self.total).mean)

    def table(self) -> pandas.DataFrame:
        """One row per frequency: total, its errors and bands, design curves [1/sqrt(Hz)], `bounds`; index: Hz."""
        import pandas

        columns = {"h": self.total.mean, "sigma": self.total.sigma, "phase": self.total.phase,
                   "amplitude": self.total.amplitude}
        if self.bands is not None:
            for name in ("input_low", "input_high", "speckle_05", "speckle_50", "speckle_95", "coherent"):
                columns[name] = getattr(self.bands, name)
        columns |= self.design
        table = pandas.DataFrame(columns, index=pandas.Index(self.frequency, name="frequency_Hz"))
        table["bound"] = self.bounds
        return table

    def to_gwpy(self, curve: Curve | None = None, *, interpolate: float | None = None) -> Any:
        """A gwpy FrequencySeries of the ASD. It supports regular axes only: a logarithmic axis is an error unless
        `interpolate` gives the step [Hz] of a regular one within the band, interpolated linearly in log-log between
        the bins."""
        from .observatory.gwpy import frequency_series

        return frequency_series(self, curve or self.total, interpolate)
