# SPDX-License-Identifier: BSD-3-Clause
"""Routes of light and the objects they meet, as numpy arrays and tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .paths import ByColumn

if TYPE_CHECKING:
    import pandas

Array = npt.NDArray[np.float64]


@dataclass
class Routes(ByColumn):
    """The routes of light to ports as the run file holds them: one entry per ordered route. Its columns are attributes, among
    them hash, name, port, kind, mean, std_error, reverse, trusted, why_not and statement; `columns` lists all with unit and
    meaning."""

    columns: dict[str, tuple[str, str]]       # unit and meaning

    @property
    def coupling(self) -> Array:
        """Recoupled power fraction, the column `mean`; not reliable where not `trusted`."""
        return np.asarray(self.values["mean"])

    @property
    def sigma(self) -> Array:
        """One standard error of it, the column `std_error`."""
        return np.asarray(self.values["std_error"])

    def table(self) -> pandas.DataFrame:
        """One row per route; unresolved couplings are NaN, `hint` has the unreliable estimate."""
        import pandas

        hidden = np.where(self.trusted, 1.0, np.nan)
        return pandas.DataFrame({
            "route": self.name, "port": self.port, "kind": self.kind, "coupling": self.coupling * hidden,
            "sigma": self.sigma * hidden, "C_rev": self.reverse, "resolved": self.trusted, "why_not": self.why_not,
            "hint": self.coupling}, index=pandas.Index([f"{int(h):016x}" for h in self.hash], name="id"))


@dataclass
class Receiver:
    """Light in watts per watt of the main mode; maps row by row from the lower left, NaN where no light was recorded.

    The error of a map is also NaN where it is not resolved."""

    name: str
    power: float                      # not reliable where not `trusted`
    sigma: float
    trusted: bool
    why_not: str
    half: tuple[float, ...]           # m, half width and height of the image
    angle_sine: float                 # half width of the map of directions
    chart: str = ""                   # of `cells`: plane (x, y), polar (radius, angle) or unrolled (along, arc)
    cells: Array | None = None      # [n, 4] edges of the cells of a map without stated pixels [m; angles: rad]
    image: Array | None = None      # [rows, columns] power per pixel, or [n] per cell
    image_error: Array | None = None
    angles: Array | None = None     # [bins, bins] power per cell of direction cosines
    angles_error: Array | None = None
    quadrants: Array | None = None  # [5] lower left, lower right, upper left, upper right, gap
    quadrants_error: Array | None = None
    field: Any = None                 # complex, shape of `image`, of free beams, sqrt(W)/m per sqrt(W) of the main mode
    within_rim: Array | None = None   # m^2, `areas` as the program computed them; None before schema 2.1

    @property
    def areas(self) -> Any:
        """Area of each pixel or cell of `image` [m^2] within the rim of its surface; of runs before schema 2.1, and where
        the rim leaves nothing of it, as a whole."""
        if self.within_rim is not None:
            return self.within_rim
        if self.cells is None:
            return 4 * self.half[0] * self.half[1] / self.image.size if self.image is not None else None
        low, high, first, last = self.cells.T
        return (high - low) * (last - first) * ((high + low) / 2 if self.chart == "polar" else 1.0)


class Receivers(list[Receiver]):
    """The receivers of a run, in the order of its scene."""

    def table(self) -> pandas.DataFrame:
        """One row per receiver: power relative to the main mode, NaN where it is not resolved."""
        import pandas

        rows = [(r.power if r.trusted else np.nan, r.sigma if r.trusted else np.nan, r.trusted, r.why_not) for r in self]
        return pandas.DataFrame(rows, columns=["power", "sigma", "resolved", "why_not"],
                                index=pandas.Index([r.name for r in self], name="receiver"))


class EnergyBalance(dict[str, tuple[float, float]]):
    """The energy balance: name to (mean, standard error) of the power per history."""

    def table(self) -> pandas.DataFrame:
        """One row per term, with its fraction of the emitted power."""
        import pandas

        table = pandas.DataFrame(list(self.values()), columns=["mean", "sigma"], index=pandas.Index(list(self), name="term"))
        table["share"] = table["mean"] / self["emitted"][0] if self.get("emitted", (0, 0))[0] > 0 else np.nan
        return table
