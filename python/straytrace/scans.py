# SPDX-License-Identifier: BSD-3-Clause
"""A model over its parameters, on any executor of concurrent.futures."""

from __future__ import annotations

import itertools
import json
import os
import pathlib
import sys
import warnings
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field
from typing import Any, TYPE_CHECKING, Union

import numpy as np

from . import engine
from .errors import StraytraceWarning
from .model import Model, overrides, trace_words, traced
from .run import Run, Scratch, open_run

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

Point = dict[str, Union[str, float]]


@dataclass
class ScanPoint:
    """One point: its parameters and its run."""

    params: Point
    run: Run

    def worst(self) -> tuple[float, float, float]:
        """Largest ratio of the noise to its margin line (margin times the first design curve), its standard error, and
        the frequency [Hz] where it is; NaN without a design curve or noise."""
        noise = self.run.noise
        if noise is None or not noise.design:
            return (float("nan"),) * 3
        line = noise.margin * next(iter(noise.design.values()))
        ratio = np.where(line > 0, noise.total.mean / np.where(line > 0, line, 1), np.nan)
        if not np.any(np.isfinite(ratio)):
            return (float("nan"),) * 3
        i = int(np.nanargmax(ratio))
        return float(ratio[i]), float(noise.total.sigma[i] / line[i]), float(noise.frequency[i])


@dataclass
class Scan:
    """Points in the requested order. Temporary run files are deleted with it."""

    points: list[ScanPoint]
    complete: bool = True             # False: stopped early; unfinished points are missing
    scratch: Scratch | None = field(default=None, repr=False)

    def table(self, frequencies: Sequence[float] = (10.0, 30.0, 100.0)) -> pandas.DataFrame:
        """One row per point: parameters, h at `frequencies` [Hz] with one standard error [1/sqrt(Hz)], the largest
        ratio to the margin line with its error and frequency, and which bound h is: "lower", "upper", "neither" or ""
        (`Noise.bounds`)."""
        import pandas

        rows = []
        for point in self.points:
            row: dict[str, Any] = dict(point.params)
            noise = point.run.noise
            for f in frequencies if noise is not None else ():
                assert noise is not None
                row[f"h({f:g} Hz)"] = float(noise.at(f))
                row[f"sigma({f:g} Hz)"] = float(np.interp(np.log(f), np.log(noise.frequency), noise.total.sigma,
                                                         left=np.nan, right=np.nan))
            row["worst_ratio"], row["worst_sigma"], row["worst_Hz"] = point.worst()
            bounds = set() if noise is None else set(noise.bounds) - {""}
            row["bound"] = "neither" if "neither" in bounds else "".join(bounds)
            rows.append(row)
        return pandas.DataFrame(rows)

    def plot(self, path: str | os.PathLike[str] | None = None) -> Figure:
        """The noise of every point, and the largest ratio to the margin line per point.

        path: also written there."""
        import matplotlib.pyplot as plt

        from .plots.points import draw
        from .plots.style import STYLE, save

        with plt.rc_context(STYLE):
            figure: Figure = draw(self)
            plt.close(figure)
            if path is not None:
                save(figure, path)
        return figure


def _points(params: Mapping[str, Iterable[str | float]] | Iterable[Mapping[str, str | float]]) -> list[Point]:
    """All combinations of lists, or the points as given."""
    if isinstance(params, Mapping):
        for name, values in params.items():
            if isinstance(values, (str, int, float)):
                raise TypeError(f"params[{name!r}] is {values!r}, one value; write a list of them: [{values!r}]")
        names = list(params)
        points: list[Point] = [dict(zip(names, values)) for values in itertools.product(*params.values())]
    else:
        points = [dict(point) for point in params]
    if not points:
        raise ValueError("a scan needs at least one point: {'aperture': ['50 cm', '60 cm']}")
    for point in points:
        overrides(point)
    return points


def _work(texts: Mapping[str, str], point: Point, out: str | None, options: dict[str, Any]) -> bytes | str:
    """What a worker does, here or on another machine: the bytes of the run file, or its name where it is to be kept."""
    run = traced(texts, "run", [*overrides(point), *trace_words(**options)], out, False, warn=False)
    return str(run.path) if out is not None else run.path.read_bytes()


def _serial(jobs: list[tuple[Any, ...]]) -> Iterable[bytes | str]:
    for job in jobs:
        yield _work(*job)


def _parallel(executor: Executor, jobs: list[tuple[Any, ...]]) -> Iterable[bytes | str]:
    futures: list[Future[bytes | str]] = [executor.submit(_work, *job) for job in jobs]
    try:
        for future in futures:
            yield future.result()
    except BaseException:
        for future in futures:
            future.cancel()
        engine.interrupt_all()                  # those that threads of this process wait for
        raise


def scan(model: Model | Mapping[str, Any] | str | os.PathLike[str],
         params: Mapping[str, Iterable[str | float]] | Iterable[Mapping[str, str | float]], *,
         executor: Executor | None = None, out: str | os.PathLike[str] | None = None, progress: bool = True,
         **options: Any) -> Scan:
    """Runs the model at every point: all combinations of ``{"aperture": ["50 cm", "60 cm"], "n": [40, 80]}``, or a list of
    points ``[{"aperture": "50 cm", "n": 40}, ...]``.

    executor: any of concurrent.futures, with threads, processes or remote jobs; add `threads=1` if as many points as
    cores run at once. Remote machines need this package; model and result are transferred with the job, data files
    named in the model are not. Without an executor, points run one by one on all cores.
    out: folder for a run file per point, point000.h5 ...: finished points are reused, not traced again.
    progress: one line per point on stderr.
    options: those of Model.run (histories, until, seed, threads, max_time, force).

    Ctrl-C returns the finished points, with ``complete == False``."""
    source = Model.of(model)
    points = _points(params)
    trace_words(**options)                      # reports wrong ones
    if out is not None:
        pathlib.Path(out).mkdir(parents=True, exist_ok=True)
    folder = pathlib.Path(out) if out is not None else None
    jobs = [(source.texts(), point, str(folder / f"point{i:03}.h5") if folder else None, options)
            for i, point in enumerate(points)]
    result = Scan([], scratch=None if folder else Scratch())
    try:
        for i, answer in enumerate(_parallel(executor, jobs) if executor is not None else _serial(jobs)):
            result.points.append(ScanPoint(points[i], _kept(answer, result.scratch, i)))
            if result.points[-1].run.attributes.get("stopped_by") == "signal":
                result.complete = False
            if progress:
                print(f"scan  {i + 1} of {len(points)}: {', '.join(f'{k}={v}' for k, v in points[i].items())}",
                      file=sys.stderr)
            if not result.complete:
                break
    except KeyboardInterrupt:
        result.complete = False
    if not result.complete:
        warnings.warn(f"stopped early, after {len(result.points)} of {len(points)} points", StraytraceWarning, stacklevel=2)
    return result


def _kept(answer: bytes | str, scratch: Scratch | None, number: int) -> Run:
    if isinstance(answer, str) or scratch is None:
        return open_run(str(answer))
    place = scratch.file(f"point{number:03}.h5")
    pathlib.Path(place).write_bytes(answer)
    run = open_run(place)
    run.scratch = scratch
    return run


@dataclass(frozen=True)
class Candidate:
    """A candidate of an optimisation. `ratio`: the largest of h, or power, to its limit, with one standard error; `upper`:
    the same with the confidence of the limit in all bins at once; the limits are met at 1 or below."""

    settings: dict[str, str]
    objective: float
    ratio: float
    sigma: float
    upper: float
    frequency: float                  # Hz, of that bin; NaN for a power
    met: bool
    front: bool                       # no other one is both cheaper and quieter
    histories: int                    # 0: not traced


@dataclass
class Optimum:
    """Result of `optimise`. Temporary files are deleted with it."""

    candidates: list[Candidate]
    best: Candidate | None            # traced with a seed that the search has not used; None: none meets the limits
    run: Run | None                   # of the best
    complete: bool                    # False: stopped early; the same call with `out` resumes
    text: str                         # as the command prints it
    # Of the best, by the text of each limit: d cost/d ln limit, or d(h/line) of the least noise; 0: it does not bind, NaN: not known.
    prices_of_limits: dict[str, float] = field(default_factory=dict)
    sigmas_of_prices: dict[str, float] = field(default_factory=dict)     # one standard error, Monte Carlo
    scratch: Scratch | None = field(default=None, repr=False)

    def table(self) -> pandas.DataFrame:
        """One row per candidate, in the order of the search."""
        import pandas

        return pandas.DataFrame([{**c.settings, **{k: v for k, v in vars(c).items() if k != "settings"}} for c in self.candidates])


def _candidate(found: Mapping[str, Any]) -> Candidate:
    nan = float("nan")
    limits = [limit for limit in found["limits"] if limit["upper"] is not None]
    worst: Mapping[str, Any] = max(limits, key=lambda limit: float(limit["upper"]), default={"ratio": {}, "upper": nan, "frequency_Hz": nan})

    def number(value: float | None) -> float:
        return nan if value is None else float(value)

    return Candidate(dict(found["settings"]), number(found["objective"]), number(worst["ratio"].get("value")),
                     number(worst["ratio"].get("sigma")), number(worst["upper"]), number(worst["frequency_Hz"]), found["met"],
                     found.get("front", False), found["histories"] if found["traced"] else 0)


def optimise(model: Model | Mapping[str, Any] | str | os.PathLike[str], *, minimise: str | None = None,
             vary: Mapping[str, str] | None = None, subject: Sequence[str] = (), pareto: bool = False, most: int | None = None,
             most_histories: int | None = None, out: str | os.PathLike[str] | None = None, **options: Any) -> Optimum:
    """Least cost or least noise over parameters, under limits, as `straytrace optimise`; what is absent is taken from the
    table `optimise` of the model.

    minimise: ``"count(baffles*)"`` or ``"h_total"``.
    vary: ``{"rim": "34cm..40cm", "n": "10..60:integer", "scene.tube.material": "steel,dlc"}``.
    subject: limits, ``["h_total < 0.05 x line with 95 %", "rim > 34 cm"]``.
    pareto: also the front of cost and noise. most: candidates of one search.
    most_histories: of a candidate, from `histories` on, where the error would hide the next step.
    out: folder for all results; the same call resumes there. None: a temporary one.
    options: those of Model.run (histories, seed, threads, max_time)."""
    source = Model.of(model)
    scratch = Scratch() if out is None else None
    folder = pathlib.Path(scratch.file("optimise") if scratch else os.fspath(out))  # type: ignore[arg-type]
    words = [*trace_words(**options), "--format", "json", "--quiet", "-o", str(folder)]
    words += [f"--minimise={minimise}"] if minimise is not None else []
    words += [f"--vary={name}={values}" for name, values in (vary or {}).items()] + [f"--subject={limit}" for limit in subject]
    words += ["--pareto"] if pareto else []
    words += [f"--most={most}"] if most is not None else []
    words += [f"--most-histories={most_histories}"] if most_histories is not None else []
    texts = source.texts()
    answer = engine.ask("optimise", next(iter(texts)), *words, unsaved=texts)
    found = json.loads(answer.output)
    chosen = None if found["best"] is None else found["finalists"][found["best"]]
    best = _candidate(chosen) if chosen else None
    prices, sigmas = ({p["limit"]: float("nan") if p[key] is None else p[key] for p in (chosen or {}).get("prices_of_limits", [])}
                      for key in ("per_ln_limit", "sigma"))
    run = open_run(folder / "best" / "run.h5") if best else None
    return Optimum([_candidate(c) for c in found["candidates"]], best, run, answer.complete,
                   (folder / "optimise.txt").read_text(encoding="utf-8"), prices, sigmas, scratch)
