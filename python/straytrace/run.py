# SPDX-License-Identifier: BSD-3-Clause
"""A run file: arrays, tables, pictures, and its noise under other motion. Layout: schema/run-2.txt."""

from __future__ import annotations

import hashlib
import json
import os
import pathlib
import shutil
import tempfile
import warnings
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import h5py

from . import engine, reading
from .curves import Noise
from .errors import RunError, StraytraceWarning
from .paths import Paths, Where, paths_from
from .routes import EnergyBalance, Receiver, Receivers, Routes
from .sensitivity import Sensitivity, sensitivity_from
from .wave import SeamCheck, Wave, WaveRing, seam_of, wave_of, wave_ring_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .model import Model

__all__ = ["Run", "RunError", "Scratch", "open_run"]


class Scratch:
    """A temporary folder that lives as long as this object."""

    def __init__(self) -> None:
        self.folder = tempfile.mkdtemp(prefix="straytrace-")
        weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)

    def file(self, name: str) -> str:
        """The path of a file in it."""
        return str(pathlib.Path(self.folder, name))


@dataclass
class Run:
    """The content of a run file. The file is closed after reading."""

    path: pathlib.Path
    attributes: dict[str, Any]        # of the root: version, model_hash, seed, histories ...
    routes: Routes
    energy_balance: EnergyBalance                    # name: (mean, standard error) of the power per history
    arrived: dict[str, tuple[float, float]]     # group: (mean, standard error)
    absorbed: dict[str, tuple[float, float]]    # group, then "(in media)"; empty before schema 1.3
    groups: list[str]
    bodies: list[str]
    ports: list[str]
    warnings: list[str]
    noise: Noise | None = None      # None: traced only; project() computes it
    files: dict[str, str] = field(default_factory=dict)   # input texts by name
    receivers: Receivers = field(default_factory=Receivers)
    beam_power: float = 0.0           # W; 0: not stated
    wave: Wave | None = None          # of the table `wave` of the scene, since schema 2.2
    wave_ring: WaveRing | None = None     # of a ring or folded cavity, since schema 2.3
    seam: SeamCheck | None = None     # the noise at another crossover angle; None: not checked, or before schema 2.3
    scratch: Scratch | None = field(default=None, repr=False)    # holds a temporary file

    @property
    def complete(self) -> bool:
        """False: stopped early; a valid result that can be resumed."""
        return bool(self.attributes["complete"])

    @property
    def histories(self) -> int:
        """Number of histories traced."""
        return int(self.attributes["histories"])

    @property
    def title(self) -> str:
        """Title of the model, or an empty string."""
        return str(self.attributes.get("title") or "")

    @property
    def maps(self) -> dict[str, Receiver]:
        """The receivers with an image, a map of directions or quadrants, by name."""
        return {r.name: r for r in self.receivers
                if r.image is not None or r.angles is not None or r.quadrants is not None}

    @property
    def provenance(self) -> dict[str, Any]:
        """Version, commit, seed, model hash and names of all input files of the run."""
        wanted = ("program", "version", "commit", "build_flags", "created", "title", "model_hash", "seed", "histories",
                  "complete", "stop_rule", "stopped_by", "motion_file")
        found = {name: self.attributes[name] for name in wanted if name in self.attributes}
        return {**{k: int(v) if k in ("seed", "histories") else v for k, v in found.items()},
                "complete": self.complete, "files": sorted(self.files)}

    def paths(self, where: Where | None = None, low: float = 0.0, high: float = 0.0) -> Paths:
        """The routes, ranked by their share of the noise, as `straytrace paths`.

        where: selects routes by a function of a row, or by a condition of `straytrace paths --where`, for example
        ``'via("baffle*") and h(30 Hz) > 1e-25'``.
        low, high: Hz, band for the shares; 0: all frequencies."""
        words = ["paths", str(self.path), "--format", "json", "--by", "port"]
        if high > low:
            words += ["--band", f"{float(low)!r} Hz..{min(float(high), 1e12)!r} Hz"]

        def ids(condition: str) -> list[str]:
            return [row["id"] for row in json.loads(engine.ask(*words, "--where", condition).output)["routes"]]

        return paths_from(json.loads(engine.ask(*words).output), self.noise, ids).where(where)

    def project(self, motion: Model | Mapping[str, Any] | str | os.PathLike[str] | None = None,
                response: Model | Mapping[str, Any] | str | os.PathLike[str] | None = None,
                out: str | os.PathLike[str] | None = None) -> Run:
        """The same traced light with other motion (or `noise`, `interferometer`) and other responses at ports: a new
        run, without tracing. Each argument is a file, a Model or a dict of its tables, ``{"bodies": {"tube":
        {"motion": ...}}}``.
        out: a folder for all results, or a run file (.h5); None: a temporary file, deleted with the result."""
        scratch = Scratch() if out is None else None
        place = scratch.file("run.h5") if scratch else os.fspath(out)  # type: ignore[arg-type]
        words = ["noise", str(self.path), "-o", place]
        unsaved: dict[str, str] = {}
        for option, given in (("motion", motion), ("response", response)):
            if given is None:
                continue
            texts = {} if isinstance(given, (str, os.PathLike)) else texts_of(given, option)
            words += ["--" + option, next(iter(texts), str(given))]
            unsaved |= texts
        answer = engine.ask(*words, unsaved=unsaved)
        run = open_run(place)
        run.scratch = scratch
        for warning in answer.warnings:
            warnings.warn(warning, StraytraceWarning, stacklevel=2)
        return run

    def sensitivity(self, only: Sequence[str] = (), trace: Sequence[str] = (), step: float | None = None, histories: int | None = None,
                    threads: int | None = None) -> Sensitivity:
        """Elasticities of h with respect to its inputs, as `straytrace sensitivity`.

        only: classes, "strength", "shape", "motion", "response", "traced"; all by default.
        trace: parameters, or values of the scene by their place, to trace at both ends of a `step` of their logarithm, with
        the histories of the run or this number; without `step` it is chosen."""
        words = ["sensitivity", str(self.path), "--format", "json", "--quiet"]
        words += ["--only", ",".join(only)] if only else []
        if trace:
            words += ["--trace", ",".join(trace)]
            words += ["--step", repr(float(step))] if step is not None else []
        words += ["--histories", str(histories)] if histories is not None else []
        words += ["--threads", str(threads)] if threads is not None else []
        return sensitivity_from(json.loads(engine.ask(*words).output))

    def with_inputs(self, *settings: str) -> dict[str, Any]:
        """The summary of the noise with other inputs, without tracing, as `straytrace noise --set`: "steel=x2",
        "steel.brdf=5e-3/sr", "tube.motion=x2"."""
        words = ["noise", str(self.path), "--format", "json", "--quiet"]
        for setting in settings:
            words += ["--set", setting]
        summary: dict[str, Any] = json.loads(engine.ask(*words).output)
        return summary

    def plot(self, path: str | os.PathLike[str] | None = None, *, low: float = 0.0, high: float = 0.0) -> Figure:
        """Plot of the run: noise, routes, energy balance.

        path: also written there (png, pdf, svg).
        low, high: Hz, band for the shares; 0: all frequencies."""
        import matplotlib.pyplot as plt

        from .plots.overview import draw
        from .plots.style import STYLE, save

        with plt.rc_context(STYLE):
            figure: Figure = draw(self, (low, high) if high > low else None)
            plt.close(figure)                   # of no window: a notebook shows it once, as the value of its cell
            if path is not None:
                save(figure, path)
        return figure

    def plot_map(self, receiver: str, path: str | os.PathLike[str] | None = None) -> Figure:
        """Plots of a receiver: image, directions, quadrants, with their errors.

        receiver: one of `maps`.
        path: also written there."""
        import matplotlib.pyplot as plt

        from .plots.maps import STYLE, draw
        from .plots.style import save

        if receiver not in self.maps:
            raise RunError(f"'{self.path}' has no map of '{receiver}'; it has maps of: {', '.join(self.maps) or 'nothing'}")
        with plt.rc_context(STYLE):
            figure: Figure = draw(self, self.maps[receiver])
            plt.close(figure)
            if path is not None:
                save(figure, path)
        return figure

    def save(self, path: str | os.PathLike[str]) -> None:
        """Copies the run file to `path`."""
        part = pathlib.Path(f"{os.fspath(path)}.part-{os.getpid()}")
        shutil.copyfile(self.path, part)
        os.replace(part, path)


def texts_of(given: Any, option: str) -> dict[str, str]:
    """The texts of motion or responses by the names of their files, the main one first: of a Model with those that it includes."""
    if hasattr(type(given), "texts"):
        texts: dict[str, str] = given.texts()
        return texts
    if isinstance(given, Mapping):
        from .tree import dump, scene_tree

        text = dump(scene_tree(given))
        return {f"{option}-{hashlib.sha256(text.encode()).hexdigest()[:8]}.yaml": text}
    raise TypeError(f"{option} is {given!r}; give a Model, a dict of its tables, or the name of a YAML file")


def _read(file: Any, path: pathlib.Path) -> Run:
    about = reading.attributes(file)
    reading.check_format(about, path)
    texts, pairs = reading.texts, reading.pairs
    groups, ports = texts(file["names/groups"]), texts(file["names/ports"])
    run = Run(
        path=path,
        attributes=about,
        routes=reading.routes_of(file),
        energy_balance=EnergyBalance(reading.energy_balance_of(file)),
        arrived=pairs(groups, file["arrived"]),
        absorbed=pairs([*groups, "(in media)"], file["absorbed"]) if "absorbed" in file else {},
        groups=groups,
        bodies=texts(file["names/bodies"]),
        ports=ports,
        warnings=texts(file["warnings/scene"]) + texts(file["warnings/trace"]),
        noise=reading.noise_of(file),
        receivers=reading.receivers_of(file),
        beam_power=float(file["receivers"].attrs["beam_power"]) if "receivers" in file else 0.0,
        wave=wave_of(file),
        wave_ring=wave_ring_of(file),
        seam=seam_of(file),
        files={reading.text(item.attrs["name"]): reading.text(item[()]) for item in file["input/files"].values()},
    )
    if run.noise is not None:
        run.noise.run = run
    return run


def open_run(path: str | os.PathLike[str]) -> Run:
    """Reads the run file at `path`, or `run.h5` in the folder `path`. Raises RunError for a file that is not a run, is
    damaged, or has a newer format."""
    path = pathlib.Path(path)
    if path.is_dir():
        path = path / "run.h5"
    try:
        reading.check_intact(path)
        with h5py.File(path, "r") as file:
            return _read(file, path)
    except (OSError, KeyError) as error:
        raise RunError(f"cannot read '{path}': {error}") from error
