# SPDX-License-Identifier: BSD-3-Clause
"""Stray light as a noise of a pygwinc budget: ``noises = [..., StrayLight.of("run.h5")]``.

Imports without pygwinc; only making a noise needs it.
"""

from __future__ import annotations

import importlib
import os
import pathlib
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

from .curves import BEYOND, log_log, with_borders_of_lines
from .run import Run, RunError, open_run


class _Absent:
    def __init__(self, *_arguments: object, **_values: object) -> None:
        raise ImportError("StrayLight is a noise of pygwinc, which is not here: pip install gwinc")


try:
    Noise: Any = importlib.import_module("gwinc.nb").Noise
    dhdl: Any = importlib.import_module("gwinc.ifo.noises").dhdl
except ImportError:
    Noise, dhdl = _Absent, None

QUANTITIES = ("displacement", "strain")


Known = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], str]


def _of_run(path: pathlib.Path) -> Known:
    run = open_run(path)
    if run.noise is None:
        raise RunError(f"'{path}' contains no noise, only couplings: give a run with ports")
    hz, strain = with_borders_of_lines(run.noise.edges, run.noise.total.mean)
    return hz, strain, (run.attributes.get("title") or "") + run.noise.bound


def _of_budget(path: pathlib.Path) -> Known:
    """Sum of the stray light in a file of ``straytrace budget --export pygwinc``."""
    with h5py.File(path, "r") as file:
        parts = file["Total/budget"] if "Total/budget" in file else {}
        psds = [part["PSD"][()] for name, part in parts.items() if name.startswith("StrayLight")]
        if not psds:
            raise RunError(f"'{path}' contains no noise called StrayLight")
        return file["Freq"][()], np.sqrt(np.sum(psds, axis=0)), ""


def _of_text(path: pathlib.Path) -> Known:
    """Columns frequency and strain of h_asd.txt or of two columns; of budget.txt all columns StrayLight*_strain."""
    lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
    try:
        table = np.array([line.replace(",", " ").split() for line in lines if line.strip() and line[0] != "#"], float)
    except ValueError as error:
        raise RunError(f"'{path}' is not a table of numbers: {error}") from None
    if table.ndim != 2 or table.shape[1] < 2:
        raise RunError(f"'{path}' has no columns of frequency and strain")
    heads = [line[1:].split() for line in lines if line.startswith("#")]
    titles: list[str] = next((t for t in heads if len(t) == table.shape[1] and t[0] in ("Hz", "frequency_Hz")), [])
    stray = [i for i, t in enumerate(titles) if t.startswith("StrayLight") and t.endswith("_strain")]
    if titles[:1] == ["Hz"] and table.shape[1] > 2 and not stray:
        raise RunError(f"'{path}' is a budget without stray light")
    if not stray and table.shape[1] > 2 and titles[1:2] != ["h_mean"]:
        raise RunError(f"'{path}' has {table.shape[1]} columns, and none is named h_mean or StrayLight_strain")
    if titles[1:2] == ["h_mean"] and len(table) > 1:  # centres of logarithmic bins
        centre = table[:, 0]
        middle = np.sqrt(centre[:-1] * centre[1:])
        return *with_borders_of_lines(np.r_[centre[0] ** 2 / middle[0], middle, centre[-1] ** 2 / middle[-1]], table[:, 1]), ""
    if not stray:
        return table[:, 0], table[:, 1], ""
    return table[:, 0], np.sqrt(np.sum(table[:, stray] ** 2, axis=1)), ""


def read_strain(path: str | os.PathLike[str]) -> Known:
    """Frequencies [Hz], one-sided strain ASD [1/sqrt(Hz)] and title of the stray light in a file: a run file (or the
    folder of run.h5), an exported budget (HDF5), or text. For runs these are averages over bins. A bin with a line
    also has points at its edges, so that the line is as wide as its bin and PSD times width is its power. Raises
    RunError."""
    path = pathlib.Path(path)
    if path.is_dir():
        path = path / "run.h5"
    try:
        if not h5py.is_hdf5(path):
            frequency, strain, title = _of_text(path)
        else:
            with h5py.File(path, "r") as file:
                read = _of_run if "file_type" in file.attrs else _of_budget
            frequency, strain, title = read(path)
    except (OSError, UnicodeDecodeError) as error:
        raise RunError(f"cannot read '{path}': {error}") from error
    if not (np.all(frequency > 0) and np.all(np.diff(frequency) > 0)):
        raise RunError(f"the frequencies of '{path}' do not increase from above 0")
    if np.any(strain < 0):
        raise RunError(f"'{path}' is not an ASD: its value at {frequency[strain < 0][0]:g} Hz is negative")
    return frequency, strain, title or path.name


class StrayLight(Noise):  # type: ignore[misc]
    """Stray light from a file as a noise of a gwinc Budget. calc() returns the PSD of the difference of the arms,
    m^2/Hz, which the calibration of the budget converts to h^2. For use without a budget, `quantity = "strain"` gives
    h^2.

    Create a class for each file: ``StrayLight.of("run.h5")``, or a subclass that sets `file`."""

    file: str | os.PathLike[str] | None = None    # run file, exported budget or text: read_strain
    beyond = "nan"          # outside the band of the file: log_log
    quantity = "displacement"
    style = {"label": "stray light", "color": "black"}

    @classmethod
    def of(cls, file: Run | str | os.PathLike[str], name: str = "StrayLight", **values: Any) -> type[StrayLight]:
        """A class for a file or a Run; names must be unique within a budget. Further values: `beyond`, `quantity`,
        `style`."""
        unknown = sorted(set(values) - {"beyond", "quantity", "style"})
        if unknown:
            raise TypeError(f"StrayLight.of takes beyond, quantity and style, not {', '.join(unknown)}")
        if isinstance(file, Run):
            values["run"], file = file, file.path        # whose file may go with it
        if values.get("beyond", cls.beyond) not in BEYOND:
            raise ValueError(f"beyond is one of {', '.join(BEYOND)}, not '{values['beyond']}'")
        if values.get("quantity", cls.quantity) not in QUANTITIES:
            raise ValueError(f"quantity is one of {', '.join(QUANTITIES)}, not '{values['quantity']}'")
        label = {"label": "stray light: " + read_strain(file)[2], "color": "black"}
        return type(name, (cls,), {"file": file, "style": label, **values})

    def load(self) -> None:
        if self.file is None:
            raise RunError("StrayLight needs a file: StrayLight.of('run.h5')")
        self._known = read_strain(self.file)[:2]

    def calc(self) -> npt.NDArray[np.float64]:
        if not hasattr(self, "_known"):
            self.load()
        frequency, strain = self._known
        psd = log_log(self.freq, frequency, strain, self.beyond) ** 2
        if self.quantity not in QUANTITIES:
            raise ValueError(f"quantity is one of {', '.join(QUANTITIES)}, not '{self.quantity}'")
        if self.quantity == "strain":
            return psd
        if self.ifo is None:
            raise RunError("a displacement needs the length of the arms: use StrayLight in a Budget with an ifo, or "
                           "quantity='strain'")
        displacement: npt.NDArray[np.float64] = psd / dhdl(self.freq, self.ifo.Infrastructure.Length)[0]
        return displacement
