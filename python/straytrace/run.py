# SPDX-License-Identifier: BSD-3-Clause
"""A run file as numpy arrays. Layout: schema/run-1.txt. All strains are one-sided ASDs in 1/sqrt(Hz)."""

import pathlib
from dataclasses import dataclass, field

import h5py
import numpy as np

SCHEMA_MAJOR = 1
KINDS = ("scattered", "ghost", "edge")


class RunError(Exception):
    """The file is not a run file that can be read; the message says why."""


def _text(value):
    if isinstance(value, np.ndarray):           # a binary or large input file
        value = value.tobytes()
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return str(value)


def _texts(dataset):
    return [_text(value) for value in dataset[()]]


@dataclass
class Curve:
    """One strain noise curve on the frequencies of the run."""

    name: str
    mean: np.ndarray
    sigma: np.ndarray                 # one standard error, Monte Carlo
    phase: np.ndarray
    amplitude: np.ndarray
    resolved: bool = True
    why_not: str = ""
    mean_square_phase: float = 0.0    # rad^2
    linear_share: np.ndarray | None = None    # of the PSD, by motion of that frequency; None before schema 1.5
    input_low: np.ndarray | None = None       # of routes: what stated inputs leave open; None before schema 1.6
    input_high: np.ndarray | None = None


@dataclass
class Bands:
    """Beside the Monte-Carlo error of the total, 1/sqrt(Hz)."""

    input_low: np.ndarray             # what brackets and uncertainties of the input leave open
    input_high: np.ndarray
    speckle_05: np.ndarray            # percentiles of one realisation of the static phases
    speckle_50: np.ndarray
    speckle_95: np.ndarray
    coherent: np.ndarray              # linear sum of the ASDs of the routes
    sources: list                     # (name, statement, least and largest factor on the total, share of the noise)
    taken_as_exact: list


@dataclass
class Noise:
    frequency: np.ndarray             # Hz, geometric centres
    edges: np.ndarray                 # Hz
    total: Curve                      # a lower bound when `unresolved` is not empty
    routes: list                      # of Curve, one per route of the run
    unresolved: list                  # names with reason
    faint: list                       # unresolved too, but too faint to move the total
    design: dict                      # name: ASD
    margin: float                     # of the first design curve
    bands: Bands | None = None        # None where only the mean was made

    def power(self, curve, low=0.0, high=np.inf):
        """Integral of the PSD over the band, strain^2, with its error (errors of bins add)."""
        inside = (self.frequency >= low) & (self.frequency <= high)
        width = np.diff(self.edges)[inside]
        mean, sigma = curve.mean[inside], curve.sigma[inside]
        return float(np.sum(mean**2 * width)), float(np.sum(2 * mean * sigma * width))

    def shares(self, low=0.0, high=np.inf):
        """Share of each route in the resolved noise power of the band, and its error; NaN where unresolved."""
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


@dataclass
class Routes:
    """Columns of the coupling table: one entry per ordered route."""

    hash: np.ndarray
    name: list
    port: list
    coupling: np.ndarray              # recoupled power fraction; only a hint where not `trusted`
    sigma: np.ndarray
    reverse: np.ndarray               # C_rev, not multiplied into `coupling`
    by_reverse: np.ndarray            # carries the numbers of the same route run backwards
    trusted: np.ndarray
    why_not: list
    kind: list                        # "scattered"; "ghost", "edge": computed, without a Monte-Carlo error
    statement: list                   # of ghosts and edges: what the number is and how far it holds


@dataclass
class Receiver:
    """Light in watts per watt of the main mode; maps row by row from the lower left, NaN where no light was seen.

    An error of a map is NaN, too, where it is not resolved."""

    name: str
    power: float                      # only a hint where not `trusted`
    sigma: float
    trusted: bool
    why_not: str
    half: tuple                       # m, half width and height of the image
    angle_sine: float                 # half width of the map of directions
    image: np.ndarray | None = None   # power per pixel
    image_error: np.ndarray | None = None
    angles: np.ndarray | None = None
    angles_error: np.ndarray | None = None
    quadrants: np.ndarray | None = None   # lower left, lower right, upper left, upper right, gap
    quadrants_error: np.ndarray | None = None
    field: np.ndarray | None = None   # complex, of free beams, sqrt(W)/m per sqrt(W) of the main mode


@dataclass
class Run:
    """A run file, read whole; the file is closed again."""

    path: pathlib.Path
    attributes: dict                  # of the root: version, model_hash, seed, histories ...
    routes: Routes
    ledger: dict                      # name: (mean, standard error) of the power per history
    arrived: dict                     # group: (mean, standard error)
    absorbed: dict                    # group, then "(in media)": (mean, standard error); empty before schema 1.3
    groups: list
    bodies: list
    ports: list
    warnings: list
    noise: Noise | None = None
    files: dict = field(default_factory=dict)   # input texts by name
    receivers: list = field(default_factory=list)
    beam_power: float = 0.0           # W, 0: not stated

    @property
    def complete(self):
        return bool(self.attributes["complete"])


def _attributes(file):
    values = {}
    for name, value in file.attrs.items():
        values[name] = _text(value) if isinstance(value, (bytes, str)) else value
    return values


def _routes(file, ports):
    group = file["classes"]
    count = len(group["hash"])
    kinds = group["kind"][()] if "kind" in group else np.zeros(count, int)    # since schema 1.4
    return Routes(
        hash=group["hash"][()],
        name=_texts(group["name"]),
        port=[ports[i] for i in group["port"][()]],
        coupling=group["mean"][()],
        sigma=group["std_error"][()],
        reverse=group["reverse"][()],
        by_reverse=group["by_reverse"][()].astype(bool) if "by_reverse" in group else np.zeros(count, bool),
        trusted=group["trusted"][()].astype(bool),
        why_not=_texts(group["why_not"]),
        kind=[KINDS[k] for k in kinds],
        statement=_texts(group["statement"]) if "statement" in group else [""] * count,
    )


def _bands(group):
    if "bands" not in group:
        return None
    bands = group["bands"]
    curves = [bands[name][()] for name in ("input_low", "input_high", "speckle_05", "speckle_50", "speckle_95", "coherent")]
    sources = list(zip(_texts(bands["source"]), _texts(bands["statement"]), bands["source_low"][()].tolist(),
                       bands["source_high"][()].tolist(), bands["source_share"][()].tolist()))
    return Bands(*curves, sources, _texts(bands["taken_as_exact"]))


def _noise(file):
    if "noise" not in file:
        return None
    group, total, routes = file["noise"], file["noise/total"], file["noise/routes"]
    columns = ("mean", "sigma", "phase", "amplitude")
    arrays = {name: routes[name][()] for name in columns}
    names, why = _texts(routes["name"]), _texts(routes["why_not"])
    resolved, phase = routes["resolved"][()], routes["mean_square_phase"][()]
    later = [routes[name][()] if name in routes else None for name in ("linear_share", "input_low", "input_high")]
    design = group["design"]
    return Noise(
        frequency=group["frequency"][()],
        edges=group["frequency_edges"][()],
        total=Curve("total", *(total[name][()] for name in columns),
                    linear_share=total["linear_share"][()] if "linear_share" in total else None),
        routes=[
            Curve(names[i], *(arrays[c][i] for c in columns), bool(resolved[i]), why[i], float(phase[i]),
                  *(rows[i] if rows is not None else None for rows in later))
            for i in range(len(names))
        ],
        unresolved=_texts(group["unresolved"]),
        faint=_texts(group["faint"]),
        design=dict(zip(_texts(design["name"]), design["asd"][()])),
        margin=float(group.attrs["margin"]),
        bands=_bands(group),
    )


def _pairs(names, group):
    return dict(zip(names, zip(group["mean"][()].tolist(), group["std_error"][()].tolist())))


def _coherent(maps, number, shape, area):
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


def _receivers(file):
    if "receivers" not in file:
        return []
    about, maps, found = file["receivers"], file["maps"], []
    for i, name in enumerate(_texts(file["names/receivers"])):
        receiver = Receiver(name, float(about["mean"][i]), float(about["std_error"][i]), bool(about["trusted"][i]),
                            _text(about["why_not"][i]), tuple(0.5 * about["size"][i]), float(about["angle_sine"][i]))
        columns, rows = (int(n) for n in about["pixels"][i])
        bins = int(about["angle_bins"][i])
        for key, shape in (("image", (rows, columns)), ("angles", (bins, bins)), ("quadrants", (-1,))):
            part = slice(*maps[key + "_offset"][i:i + 2])
            if part.stop > part.start:
                setattr(receiver, key, maps[key][part].reshape(shape))
                setattr(receiver, key + "_error", maps[key + "_error"][part].reshape(shape))
        if receiver.image is not None:
            receiver.field = _coherent(maps, i, (rows, columns), 4 * np.prod(receiver.half) / receiver.image.size)
        found.append(receiver)
    return found


def _read(file, path):
    attributes = _attributes(file)
    if attributes.get("file_type") != "straytrace-run":
        raise RunError(f"'{path}' is not a straytrace run file")
    if int(attributes["schema"][0]) != SCHEMA_MAJOR:
        version = ".".join(str(n) for n in attributes["schema"])
        raise RunError(f"'{path}' has format {version}; this program reads format {SCHEMA_MAJOR}")
    groups, ports = _texts(file["names/groups"]), _texts(file["names/ports"])
    inputs = file["input/files"]
    return Run(
        path=pathlib.Path(path),
        attributes=attributes,
        routes=_routes(file, ports),
        ledger=_pairs(_texts(file["ledger/name"]), file["ledger"]),
        arrived=_pairs(groups, file["arrived"]),
        absorbed=_pairs(groups + ["(in media)"], file["absorbed"]) if "absorbed" in file else {},
        groups=groups,
        bodies=_texts(file["names/bodies"]),
        ports=ports,
        warnings=_texts(file["warnings/scene"]) + _texts(file["warnings/trace"]),
        noise=_noise(file),
        receivers=_receivers(file),
        beam_power=float(file["receivers"].attrs["beam_power"]) if "receivers" in file else 0.0,
        files={_text(text.attrs["name"]): _text(text[()]) for text in inputs.values()},
    )


def open_run(path):
    """Reads the run file at `path`, or `run.h5` in the folder `path`."""
    path = pathlib.Path(path)
    if path.is_dir():
        path = path / "run.h5"
    try:
        with h5py.File(path, "r") as file:
            return _read(file, path)
    except (OSError, KeyError, ValueError) as error:
        raise RunError(f"cannot read '{path}': {error}") from error
