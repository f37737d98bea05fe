# SPDX-License-Identifier: BSD-3-Clause
"""The network of an interferometer, solved: the tables of `straytrace ifo` (docs/theory/interferometer.md)."""

from __future__ import annotations

import json
import os
import re
import warnings
from collections.abc import Mapping
from typing import Any, TYPE_CHECKING, Union

import numpy as np

from . import engine
from .errors import StraytraceWarning
from .model import Model, Parameters, overrides

if TYPE_CHECKING:
    import pandas

Quantity = Union[str, float]


class Interferometer:
    """The interferometer of a model, with the bits of `straytrace ifo`. Each method solves it anew, so that changes of the model act.

    Tables are pandas data frames in SI; `attrs["units"]` holds the units of columns. Responses are complex numbers for motion
    proportional to exp(+2 pi i f t). NaN: zero within rounding. A frequency is a text with a unit, or a number in Hz::

        ifo = straytrace.Interferometer("examples/ifo_cavity.yaml")
        ifo.operating_point()["cavities"].finesse
        ifo.transfer("LENGTH", "PDH", band=("1 Hz", "10 kHz")).abs()

    model: a Model, a dict or a file.
    params: overrides parameters of the model, as -p.
    """

    def __init__(self, model: Model | Mapping[str, Any] | str | os.PathLike[str], params: Parameters | None = None) -> None:
        self.model, self.params = Model.of(model), params

    def operating_point(self) -> dict[str, pandas.DataFrame]:
        """`readouts`, `cavities`, powers at the `ports` and the `energy` balance, by the part of the network."""
        return self._tables("point", index={"readouts": "readout", "cavities": "cavity", "ports": "port"})

    def scan(self, parameter: str, start: Quantity, stop: Quantity, *, points: int | None = None) -> pandas.DataFrame:
        """All read-outs over a parameter of the network or a degree of freedom.

        start, stop: texts with a unit, "-5 nm"; plain numbers for a parameter that has none.
        points: 201 unless given."""
        ends = _text(start, "start"), _text(stop, "stop")
        return self._one("scan", parameter, *ends, points=points, index=parameter)

    def errors(self) -> pandas.DataFrame:
        """Error signals by read-out and degree of freedom: value, slope, best phase of demodulation, linear range, offset."""
        return self._one("errors").set_index(["readout", "freedom"])

    def slopes(self, readout: str) -> pandas.DataFrame:
        """Slope of a read-out of power with respect to each number of the network, per SI unit, with value and units. Index: parameter."""
        return self._one("slopes", readout, index="parameter")

    def sensing(self, at: Quantity | None = "10 Hz") -> pandas.DataFrame:
        """Response of each read-out (row) to each degree of freedom (column) at one frequency, complex."""
        return _complex(self._one("sensing", at=at, index="readout"))

    def transfer(self, cause: str, readout: str, *, band: tuple[Quantity, Quantity] | None = None,
                 points: int | None = None) -> pandas.Series:
        """Complex response of a read-out, a mirror or `h` to a cause: a degree of freedom, `laser.frequency`, `ITM.force` and others. Index: frequency [Hz].

        band: "1 Hz" to "10 kHz" unless given.
        points: 201 unless given."""
        if cause.startswith("stray:"):
            raise ValueError(f"cause is {cause!r}; a stray field has two quadratures: use stray_transfer")
        table = self._one("transfer", cause, readout, band=band, points=points, index="frequency")
        response = (table["re"] + 1j * table["im"]).rename(f"{readout} per {cause}")
        response.attrs = {"unit": table.attrs["units"]["re"]}
        return response

    def noise(self, readout: str, *, referred_to: str | None = None, band: tuple[Quantity, Quantity] | None = None,
              points: int | None = None) -> pandas.DataFrame:
        """One-sided ASDs of a read-out by source, and their total. Index: frequency [Hz].

        referred_to: a degree of freedom whose displacement [m/sqrt(Hz)] the noise is expressed as.
        band, points: as for `transfer`."""
        words = [] if referred_to is None else ["--referred-to", referred_to]
        return self._one("noise", readout, band=band, points=points, index="frequency", words=words)

    def loops(self, at: Quantity | None = "10 Hz") -> dict[str, pandas.DataFrame]:
        """`loops`: plant, open-loop gain (complex), suppression and margins of each; `stray`: strain per relative stray field at each entrance,
        with lengths held and by each loop; `noise`: of the strain, so too; `filters` of subtracted channels. At one frequency."""
        return {name: _complex(table) for name, table in self._tables("loops", at=at).items()}

    def suppression(self, *, band: tuple[Quantity, Quantity] | None = None, points: int | None = None) -> pandas.DataFrame:
        """|1/(1 + G)| of each loop, with its open-loop gain (complex). Index: frequency [Hz]; arguments as for `transfer`."""
        return _complex(self._tables("loops", "suppression", band=band, points=points, index={"suppression": "frequency"})["suppression"])

    def strain_noise(self, *, band: tuple[Quantity, Quantity] | None = None, points: int | None = None) -> pandas.DataFrame:
        """One-sided ASDs of the strain by source and their total, with all loops and subtractions acting. Index: frequency [Hz]; arguments
        as for `transfer`."""
        return self._tables("loops", "noise", band=band, points=points, index={"strain_noise": "frequency"})["strain_noise"]

    def stray(self, entrance: str | None = None, at: Quantity | None = "10 Hz") -> pandas.DataFrame:
        """Response of all read-outs to a relative stray field: per Im s (`phase`) and per Re s (`amplitude`), complex, at one frequency.

        entrance: one of the named entrances, "all" beams of the network, or None: all named ones."""
        return _complex(self._one("stray", *([] if entrance is None else [entrance]), at=at)).set_index(["entrance", "readout"])

    def stray_transfer(self, entrance: str, readout: str, *, band: tuple[Quantity, Quantity] | None = None,
                       points: int | None = None) -> pandas.DataFrame:
        """The same for one entrance and read-out, a mirror or `h` over frequency [Hz]; arguments as for `transfer`."""
        return _complex(self._one("transfer", f"stray:{entrance}", readout, band=band, points=points, index="frequency"))

    def modes(self) -> dict[str, pandas.DataFrame]:
        """Of a network with Hermite-Gauss modes: `resonances`, `mismatch`, `content` of beams by order, and `truncation`."""
        return self._tables("modes")

    def network(self) -> Model:
        """The network, presets included, as a model."""
        answer = self._ask(("network",), [])
        return Model.from_text(answer.output, self.model.path)

    def _ask(self, show: tuple[str, ...], words: list[str]) -> engine.Answer:
        texts = self.model.texts()
        answer = engine.ask("ifo", next(iter(texts)), *overrides(self.params), *words, "--show", *show, unsaved=texts)
        for problem in answer.problems:
            warnings.warn(str(problem), StraytraceWarning, stacklevel=4)
        for text in answer.warnings:
            warnings.warn(text, StraytraceWarning, stacklevel=4)
        return answer

    def _tables(self, show: str, *names: str, at: Quantity | None = None, band: tuple[Quantity, Quantity] | None = None,
                points: int | None = None, index: Mapping[str, str] | None = None, words: list[str] | None = None) -> dict[str, pandas.DataFrame]:
        import pandas

        words = ["--format", "json", *(words or [])]
        if at is not None:
            words += ["--at", _text(at, "at", "Hz")]
        if band is not None:
            if isinstance(band, str) or len(band) != 2:
                raise TypeError(f"band is {band!r}; write two frequencies: ('1 Hz', '10 kHz')")
            low, high = band
            words += ["--band", f"{_text(low, 'band', 'Hz')}, {_text(high, 'band', 'Hz')}"]
        if points is not None:
            words += ["--points", str(points)]
        answer = json.loads(self._ask((show, *names), words).output)
        units = answer.pop("units")
        answer.pop("warnings")      # told by engine.ask
        found = {}
        for key, rows in answer.items():
            name = re.sub(r"_[^_]*Hz$", "", key)      # sensing_10Hz
            if name in found:
                raise ValueError(f"at is {at!r}; write one frequency")
            table = pandas.DataFrame({c: _column([row[c] for row in rows]) for c in (rows[0] if rows else {})})
            if index and name in index and len(table):
                table = table.set_index(index[name])
            table.attrs["units"] = units.get(key) or {}
            found[name] = table
        return found

    def _one(self, show: str, *names: str, index: str | None = None, **options: Any) -> pandas.DataFrame:
        return self._tables(show, *names, index=None if index is None else {show: index}, **options)[show]


def _text(value: Quantity, name: str, unit: str = "") -> str:
    """As an option of the command line."""
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise TypeError(f"{name} is {value!r}; write a text with a unit such as '10 Hz', or a number")
    return value if isinstance(value, str) else f"{float(value)!r}{unit and ' ' + unit}"


def _column(values: list[Any]) -> Any:
    """Texts, or numbers with NaN for what is zero within rounding."""
    if any(isinstance(v, str) for v in values):
        return values
    return np.array([np.nan if v is None else v for v in values], dtype=float)


def _complex(table: pandas.DataFrame) -> pandas.DataFrame:
    """Columns `name` and `arg_name` as one complex column."""
    arguments = [c for c in table.columns if c.startswith("arg_")]
    out = table.drop(columns=arguments)
    for column in arguments:
        name = column.removeprefix("arg_")
        out[name] = table[name] * np.exp(1j * table[column])
    out.attrs["units"] = {c: u for c, u in table.attrs["units"].items() if c not in arguments}
    return out
