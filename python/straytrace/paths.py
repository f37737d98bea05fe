# SPDX-License-Identifier: BSD-3-Clause
"""The ranked routes of a run. Conditions that select routes are those of `straytrace paths --where`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TYPE_CHECKING, Union

if TYPE_CHECKING:
    import pandas

    from .curves import Noise


@dataclass
class PathColumn:
    """A column of `straytrace paths`, as the program describes it."""

    key: str                          # name of the attribute of a `Path`
    at: str                           # place in a row of the JSON: "/path_length_m/mean"
    kind: str                         # text, flag, count, number, list, or estimate: a number with its standard error
    unit: str
    help: str

    def read(self, row: Mapping[str, Any]) -> dict[str, Any]:
        """Attributes of a row of the JSON: its value, and of an estimate KEY_sigma. Unknown numbers are NaN."""
        found: Any = row
        for step in self.at.split("/")[1:]:
            found = found.get(step) if isinstance(found, Mapping) else None
        if self.kind == "estimate":
            found = found or {}
            return {self.key: _number(found.get("value")), self.key + "_sigma": _number(found.get("sigma"))}
        if self.kind == "number":
            return {self.key: _number(found)}
        return {self.key: {"text": "", "flag": False, "count": 0, "list": []}[self.kind] if found is None else found}


@dataclass
class ByColumn:
    """A row or table whose columns are attributes."""

    values: dict[str, Any]  # by the name of their column

    def __getattr__(self, key: str) -> Any:
        if key.startswith("__") or key == "values":
            raise AttributeError(key)
        try:
            return self.values[key]
        except KeyError:
            raise AttributeError(f"there is no column '{key}'; there are: {', '.join(self.values)}") from None


@dataclass
class Path(ByColumn):
    """One route: a row of `straytrace paths`. Its columns are attributes, among them rank, id, port, sequence, kind,
    resolved, coupling, coupling_sigma, share, share_sigma, body and opl; `Paths.columns` lists all with unit and
    meaning. Numbers that are not resolved are NaN."""

    strain: Callable[[float], float]  # Hz to 1/sqrt(Hz)

    @property
    def at_most(self) -> bool:
        """True if its numbers are upper bounds: those of kind edge, which speckle reduces."""
        return bool(self.kind == "edge")

    @property
    def objects(self) -> list[str]:
        """The objects that the light meets, in order; of ghosts whose fields add, also those of all other listed ghosts.
        Empty for a row `other`, which sums many routes."""
        listed = [route["sequence"] for route in self.folded] if self.vertices > 0 else []
        return [step.split("·")[0] for route in [self.sequence, *listed] for step in route.split(" > ") if "·" in step]

    @property
    def scatters(self) -> int:
        """Number of events S in the sequence, including the first and the last."""
        return sum(step.strip().endswith("·S") for step in self.sequence.split(">"))


Where = Union[str, Callable[[Path], bool]]


@dataclass
class Paths(Sequence[Path]):
    """Routes by rank."""

    rows: list[Path]
    columns: list[PathColumn]
    ask: Callable[[str], list[str]]   # ids of the rows for which a condition is true

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: Any) -> Any:
        return Paths(self.rows[index], self.columns, self.ask) if isinstance(index, slice) else self.rows[index]

    def __iter__(self) -> Iterator[Path]:
        return iter(self.rows)

    def where(self, which: Where | None) -> Paths:
        """The routes for which `which` is true: a function of a row, or a condition of `straytrace paths --where`, for
        example ``'via("baffle*") and h(30 Hz) > 1e-25 and share > 5 %'``. Raises InputError."""
        if which is None:
            return self
        if callable(which):
            return Paths([row for row in self.rows if which(row)], self.columns, self.ask)
        if not isinstance(which, str):
            raise TypeError(f"where is {which!r}; write a condition such as 'via(\"baffle*\")', or a function of a row")
        wanted = set(self.ask(which))
        return Paths([row for row in self.rows if row.id in wanted], self.columns, self.ask)

    def table(self, frequencies: Sequence[float] = (10.0, 30.0, 100.0)) -> pandas.DataFrame:
        """One row per route with all its columns; h at `frequencies` [Hz] in 1/sqrt(Hz), NaN outside the band and where
        not resolved."""
        import pandas

        names = [name for c in self.columns if c.kind != "list" and c.key != "rank"
                 for name in ([c.key, c.key + "_sigma"] if c.kind == "estimate" else [c.key])]
        columns = {name: [getattr(row, name) for row in self.rows] for name in [*names, "scatters", "at_most"]}
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

    columns = [PathColumn(**column) for column in answer["columns"]]
    rows = []
    for row in answer["routes"]:
        values = {key: value for column in columns for key, value in column.read(row).items()}
        rows.append(Path(values, strain_of(row["sequence"], row["resolved"])))
    return Paths(rows, columns, ask)
