# SPDX-License-Identifier: BSD-3-Clause
"""The ranked routes of a run. Conditions that select routes are those of `straytrace paths --where`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas

    from .curves import Noise


@dataclass
class Path:
    """One route: a row of `straytrace paths`. Numbers that are not resolved are NaN."""

    rank: int
    id: str                           # stable between runs of the same model
    port: str
    sequence: str                     # "ITM·S > baffle·S > ITM·S"
    kind: str                         # scattered, ghost or edge
    resolved: bool
    why_not: str
    coupling: float                   # recoupled power fraction of the ordered route
    coupling_sigma: float
    hint: float                       # unreliable estimate of the coupling where it is not resolved
    C_rev: float
    share: float                      # of the resolved strain noise power
    share_sigma: float
    body: str                         # whose motion contributes most
    phase_sensitivity: float                      # rad/m
    rms_phase: float                  # rad
    regime: str
    opl: float                        # m, mean optical path
    vertices: int
    histories: int                    # that scored
    strain: Callable[[float], float]    # Hz to 1/sqrt(Hz)

    @property
    def at_most(self) -> bool:
        """True if its numbers are upper bounds: diffraction at edges, which speckle reduces."""
        return self.kind == "edge"

    @property
    def objects(self) -> list[str]:
        """The objects that the light meets, in order; empty for a row `other`, which sums many routes."""
        return [step.split("·")[0] for step in self.sequence.split(" > ") if "·" in step]

    @property
    def scatters(self) -> int:
        """Number of events S in the sequence, including the first and the last."""
        return sum(step.strip().endswith("·S") for step in self.sequence.split(">"))


Where = str | Callable[[Path], bool]


@dataclass
class Paths(Sequence[Path]):
    """Routes by rank."""

    rows: list[Path]
    ask: Callable[[str], list[str]]   # ids of the rows for which a condition is true

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: Any) -> Any:
        return Paths(self.rows[index], self.ask) if isinstance(index, slice) else self.rows[index]

    def __iter__(self) -> Iterator[Path]:
        return iter(self.rows)

    def where(self, which: Where | None) -> Paths:
        """The routes for which `which` is true: a function of a row, or a condition of `straytrace paths --where`, for
        example ``'via("baffle*") and h(30 Hz) > 1e-25 and share > 5 %'``. Raises InputError."""
        if which is None:
            return self
        if callable(which):
            return Paths([row for row in self.rows if which(row)], self.ask)
        if not isinstance(which, str):
            raise TypeError(f"where is {which!r}; write a condition such as 'via(\"baffle*\")', or a function of a row")
        wanted = set(self.ask(which))
        return Paths([row for row in self.rows if row.id in wanted], self.ask)

    def table(self, frequencies: Sequence[float] = (10.0, 30.0, 100.0)) -> pandas.DataFrame:
        """One row per route; h at `frequencies` [Hz] in 1/sqrt(Hz), NaN outside the band and where not resolved."""
        import pandas

        names = ("id", "port", "sequence", "kind", "scatters", "coupling", "coupling_sigma", "share", "share_sigma", "body",
                 "phase_sensitivity", "rms_phase", "regime", "opl", "at_most", "resolved", "why_not", "histories")
        columns: dict[str, list[Any]] = {name: [getattr(row, name) for row in self.rows] for name in names}
        columns |= {f"h({f:g} Hz)": [row.strain(f) for row in self.rows] for f in frequencies}
        return pandas.DataFrame(columns, index=pandas.Index([row.rank for row in self.rows], name="rank"))


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def paths_from(answer: Mapping[str, Any], noise: Noise | None, ask: Callable[[str], list[str]]) -> Paths:
    """Rows of `straytrace paths --format json`."""
    curves = {curve.name: curve for curve in noise.routes} if noise is not None else {}

    def strain_of(name: str, resolved: bool) -> Callable[[float], float]:
        curve = curves.get(name) if resolved else None
        return lambda hz: math.nan if noise is None or curve is None else float(noise.at(hz, curve))

    rows = []
    for r in answer["routes"]:
        coupling = r["coupling"] or {"value": None, "sigma": None}
        rows.append(Path(
            rank=r["rank"], id=r["id"], port=r["port"], sequence=r["sequence"], kind=r["kind"], resolved=r["resolved"],
            why_not=r["why_not"], coupling=_number(coupling["value"]), coupling_sigma=_number(coupling["sigma"]),
            hint=_number(r["coupling_hint"]), C_rev=r["C_rev"], share=_number(r["share"]["value"]),
            share_sigma=_number(r["share"]["sigma"]), body=r["moving_body"],
            phase_sensitivity=_number(r["phase_sensitivity_rad_per_m"]), rms_phase=_number(r["rms_phase_rad"]), regime=r["regime"],
            opl=_number(r["path_length_m"]["mean"]), vertices=r["vertices"], histories=r["histories_scored"],
            strain=strain_of(r["sequence"], r["resolved"])))
    return Paths(rows, ask)
