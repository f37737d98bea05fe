# SPDX-License-Identifier: BSD-3-Clause
"""From the datasets of a run file to objects. Layout: schema/run-2.txt."""

from __future__ import annotations

import hashlib
import pathlib
import re
from typing import Any

import numpy as np

from .curves import Bands, Curve, Noise, Positions
from .errors import RunError
from .routes import Receiver, Receivers, Routes

SCHEMA_MAJORS = (1, 2)
USER_BLOCK = 512  # bytes


def text(value: Any) -> str:
    """Of a dataset or attribute."""
    if isinstance(value, np.ndarray):           # a binary or large input file
        value = value.tobytes()
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return str(value)


def texts(dataset: Any) -> list[str]:
    """Of a dataset of texts."""
    return [text(value) for value in dataset[()]]


def pairs(names: list[str], group: Any) -> dict[str, tuple[float, float]]:
    """Mean and standard error by name."""
    return dict(zip(names, zip(group["mean"][()].tolist(), group["std_error"][()].tolist())))


def energy_balance_of(file: Any) -> dict[str, tuple[float, float]]:
    """Power emitted and the terms it ends in. Files of schema 1 use other names."""
    group = file["energy_balance"] if "energy_balance" in file else file["ledger"]
    names = {"limit": "truncated", "window": "roulette"}
    return pairs([names.get(name, name) for name in texts(group["name"])], group)


def attributes(file: Any) -> dict[str, Any]:
    """Those of the root."""
    return {name: text(value) if isinstance(value, (bytes, str)) else value for name, value in file.attrs.items()}


def check_intact(path: pathlib.Path) -> None:
    """RunError when the bytes do not have the hash of the first line."""
    with open(path, "rb") as file:
        words = file.read(USER_BLOCK).split(b"\n")[0].split()
        if words[:2] != [b"straytrace-run", b"sha256"] or len(words) != 5:
            return
        found = hashlib.sha256()
        size = 0
        while block := file.read(1 << 20):
            found.update(block)
            size += len(block)
    if size != int(words[4]):
        raise RunError(f"'{path}' is damaged: it contains {size} bytes of {int(words[4])}\n"
                       "  copy it again from where it was made, or make it again with: straytrace run")
    if found.hexdigest().encode() != words[2]:
        raise RunError(f"'{path}' is damaged: its content does not match its checksum\n"
                       "  copy it again from where it was made, or make it again with: straytrace run")


def check_format(about: dict[str, Any], path: pathlib.Path) -> None:
    """RunError for a file that is not a run file, or has an unknown schema."""
    if about.get("file_type") != "straytrace-run":
        raise RunError(f"'{path}' is not a straytrace run file\n  name the run.h5 that straytrace run wrote")
    if int(about["schema"][0]) not in SCHEMA_MAJORS:
        version = ".".join(str(n) for n in about["schema"])
        raise RunError(f"'{path}' has format {version}; this program reads formats {SCHEMA_MAJORS[0]} and {SCHEMA_MAJORS[1]}\n"
                       "  use the version of straytrace that wrote it, or make the run again")


def column(file: Any, dataset: Any) -> Any:
    """Values of a column of a table: flags, names and words in the place of the codes that its unit explains."""
    unit, values = text(dataset.attrs.get("unit", "")), dataset[()]
    if dataset.dtype.kind in "SO":
        return texts(dataset)
    if unit == "0 or 1":
        return values.astype(bool)
    if unit.startswith("row of "):
        names = texts(file[unit.removeprefix("row of ")])
        return [names[i] for i in values]
    if codes := dict(re.findall(r"(\d+) (\w+)(?:, |$)", unit)) if unit.startswith("0 ") else {}:
        return [codes[str(i)] for i in values]
    return values


def routes_of(file: Any) -> Routes:
    """/classes: what has one entry for each route. Files of schema 1 may lack the first three columns."""
    group = file["classes"]
    count = len(group["hash"])
    values: dict[str, Any] = {"kind": ["scattered"] * count, "statement": [""] * count, "by_reverse": np.zeros(count, bool)}
    columns = {name: ("", "") for name in values}
    for name, dataset in group.items():
        if dataset.shape == (count,) and not name.startswith(("step_", "replica_")):
            values[name] = column(file, dataset)
            columns[name] = text(dataset.attrs.get("unit", "")), text(dataset.attrs.get("meaning", ""))
    return Routes(values, columns)


def _bands(group: Any) -> Bands | None:
    if "bands" not in group:
        return None
    bands = group["bands"]
    names = ("input_low", "input_high", "speckle_05", "speckle_50", "speckle_95", "coherent")
    curves: dict[str, Any] = {name: bands[name][()] for name in names}
    sources = list(zip(texts(bands["source"]), texts(bands["statement"]), bands["source_low"][()].tolist(),
                       bands["source_high"][()].tolist(), bands["source_share"][()].tolist()))
    return Bands(**curves, sources=sources, taken_as_exact=texts(bands["taken_as_exact"]))


def _positions(group: Any) -> Positions | None:
    if "positions" not in group:
        return None
    part = group["positions"]
    return Positions(text(part.attrs["body"]), part["phase"][()], part["asd"][()])


def noise_of(file: Any) -> Noise | None:
    """/noise."""
    if "noise" not in file:
        return None
    group, total, routes = file["noise"], file["noise/total"], file["noise/routes"]
    columns = ("mean", "sigma", "phase", "amplitude")
    arrays = {name: routes[name][()] for name in columns}
    names, why = texts(routes["name"]), texts(routes["why_not"])
    resolved, phase = routes["resolved"][()], routes["mean_square_phase"][()]
    later: dict[str, Any] = {name: routes[name][()] for name in ("linear_share", "input_low", "input_high") if name in routes}
    design, unresolved = group["design"], texts(group["unresolved"])
    return Noise(
        frequency=group["frequency"][()],
        edges=group["frequency_edges"][()],
        total=Curve("total", **{name: total[name][()] for name in columns}, resolved=not unresolved,
                    linear_share=total["linear_share"][()] if "linear_share" in total else None,
                    bound_share=total["bound_share"][()] if "bound_share" in total else None),
        routes=[
            Curve(names[i], **{c: arrays[c][i] for c in columns}, resolved=bool(resolved[i]), why_not=why[i],
                  mean_square_phase=float(phase[i]),
                  **{key: rows[i] for key, rows in later.items()})
            for i in range(len(names))
        ],
        unresolved=unresolved,
        faint=texts(group["faint"]),
        design=dict(zip(texts(design["name"]), design["asd"][()])),
        margin=float(group.attrs["margin"]),
        bands=_bands(group),
        positions=_positions(group),
    )


def _coherent(maps: Any, number: int, shape: tuple[int, ...], area: Any) -> Any:
    """Sum over routes of sqrt(P/area) e^(i phase)."""
    total = None
    for i in np.flatnonzero(maps["field_receiver"][()] == number):
        part = slice(*maps["field_offset"][i:i + 2])
        mean = maps["field_real"][part] + 1j * maps["field_imaginary"][part]
        size = np.abs(mean)
        phase = np.divide(mean, size, out=np.zeros_like(mean), where=size > 0)
        wave = np.sqrt(maps["field_power"][part] / area) * phase
        total = wave if total is None else total + wave
    if total is None:
        return None
    total[total == 0] = np.nan                  # no light was seen there
    return total.reshape(shape)


def receivers_of(file: Any) -> Receivers:
    """/receivers and /maps."""
    found = Receivers()
    if "receivers" not in file:
        return found
    about, maps = file["receivers"], file["maps"]
    for i, name in enumerate(texts(file["names/receivers"])):
        receiver = Receiver(name, float(about["mean"][i]), float(about["std_error"][i]), bool(about["trusted"][i]),
                            text(about["why_not"][i]), tuple(0.5 * about["size"][i]), float(about["angle_sine"][i]))
        columns, rows = (int(n) for n in about["pixels"][i])
        bins = int(about["angle_bins"][i])
        pixels: tuple[int, ...] = (rows, columns)
        if "chart" in about and (chart := text(about["chart"][i])):      # since schema 1.9
            receiver.chart, pixels = chart, (-1,)
            receiver.cells = about["cells"][slice(*about["cell_offset"][i:i + 2])]
        shapes: list[tuple[str, tuple[int, ...]]] = [("image", pixels), ("angles", (bins, bins)), ("quadrants", (-1,))]
        for key, shape in shapes:
            part = slice(*maps[key + "_offset"][i:i + 2])
            if part.stop > part.start:
                setattr(receiver, key, maps[key][part].reshape(shape))
                setattr(receiver, key + "_error", maps[key + "_error"][part].reshape(shape))
        if receiver.image is not None:
            if "area" in about:                                          # since schema 2.1
                receiver.within_rim = about["area"][slice(*about["area_offset"][i:i + 2])].reshape(pixels)
            receiver.field = _coherent(maps, i, pixels, np.ravel(receiver.areas))
        found.append(receiver)
    return found
