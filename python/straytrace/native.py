# SPDX-License-Identifier: BSD-3-Clause
"""The engine inside this process, by the library libstraytrace: numpy arrays without a second process, run files and temporary
files, for loops over many small projections::

    from straytrace import native
    run = native.Model("arm.yaml").trace(until="h_total < 5 %")
    for factor in np.geomspace(0.1, 10, 100):
        noise = run.noise(set=[f"baffle=x{factor}"])
        print(factor, noise.at(30))

The numbers have the bits of the commands. The rest of the package needs neither this module nor the library: where it is missing,
or where the system is older than that for which it was built (glibc 2.36 for packages), `native.available()` is False."""

from __future__ import annotations

import ctypes
import json
import math
import os
import pathlib
from collections.abc import Callable, Mapping, Sequence
from ctypes import CFUNCTYPE, POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_uint64, c_void_p
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from .curves import between_bins
from .engine import HERE, Progress, program
from .errors import InputError, NumericalError
from .model import Model as Tree
from .model import Parameters, overrides
from .run import texts_of

__all__ = ["Model", "Noise", "Run", "available", "open_run"]

Array = npt.NDArray[np.float64]
INPUT_ERROR, NUMERICAL_ERROR = 2, 3


class _Progress(ctypes.Structure):
    _fields_ = [("histories", c_uint64), ("wanted_histories", c_uint64), ("seconds", c_double), ("histories_per_s", c_double),
                ("error", c_double), ("wanted_error", c_double)]


_Listener = CFUNCTYPE(c_int, POINTER(_Progress), c_void_p)


class _Settings(ctypes.Structure):
    _fields_ = [("seed", POINTER(c_uint64)), ("histories", c_uint64), ("until", c_char_p), ("threads", c_uint),
                ("max_seconds", c_double), ("progress", _Listener), ("context", c_void_p)]


_TEXTS = POINTER(c_char_p)
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "error": (c_int, []), "error_text": (c_char_p, []), "error_table": (c_char_p, []),
    "read": (c_void_p, [c_char_p, c_char_p, _TEXTS]), "model_about": (c_char_p, [c_void_p]), "free_model": (None, [c_void_p]),
    "trace": (c_void_p, [c_void_p, POINTER(_Settings)]), "open": (c_void_p, [c_char_p]),
    "save": (c_void_p, [c_void_p, c_char_p]), "run_about": (c_char_p, [c_void_p]), "free_run": (None, [c_void_p]),
    "project": (c_void_p, [c_void_p, c_char_p, c_char_p, _TEXTS]), "noise_about": (c_char_p, [c_void_p]),
    "array": (POINTER(c_double), [c_void_p, c_char_p, POINTER(c_size_t)]),
    "paths": (c_char_p, [c_void_p, POINTER(c_double), c_size_t, c_double, c_double]), "free_noise": (None, [c_void_p]),
}
_loaded: list[Any] = []


def _places() -> list[str]:
    """Files of the library: that of STRAYTRACE_LIBRARY, or of this package, of its source tree, of the system."""
    if chosen := os.environ.get("STRAYTRACE_LIBRARY"):
        return [chosen]
    near = [HERE / "bin" / "libstraytrace.so", HERE.parents[1] / "build" / "src" / "libstraytrace.so"]
    try:
        near.append(pathlib.Path(program()).resolve().parents[1] / "lib" / "libstraytrace.so.0")       # of a package
    except InputError:
        pass
    return [str(place) for place in near if place.is_file()] + ["libstraytrace.so.0"]


def _library() -> Any:
    if _loaded:
        return _loaded[0]
    reasons = []
    for place in _places():
        try:
            library = ctypes.CDLL(place)
            for name, (result, arguments) in _FUNCTIONS.items():
                function = getattr(library, "straytrace_" + name)
                function.restype, function.argtypes = result, arguments
        except (OSError, AttributeError) as error:
            reasons.append(str(error))
        else:
            _loaded.append(library)
            return library
    raise InputError("the library libstraytrace cannot be used here: " + "; ".join(reasons) + "\n  build it with scripts/build, name it in "
                     "the environment variable STRAYTRACE_LIBRARY, or use straytrace.Model, which needs only the program")


def available() -> bool:
    """Whether the library can be loaded."""
    try:
        return _library() is not None
    except InputError:
        return False


def _call(name: str, *arguments: Any) -> Any:
    """The result of the function; its error as an exception."""
    library = _library()
    if found := getattr(library, "straytrace_" + name)(*arguments):
        return found
    kind, text = library.straytrace_error(), library.straytrace_error_text().decode()
    if kind == INPUT_ERROR:
        raise InputError(text, library.straytrace_error_table().decode())
    raise NumericalError(text) if kind == NUMERICAL_ERROR else RuntimeError(text)


class _Held:
    """An object of the library, freed with this one."""

    def __init__(self, kind: str, address: int) -> None:
        self.kind, self.address = kind, address

    def about(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(_call(self.kind + "_about", self.address))
        return found

    def __del__(self) -> None:
        if _loaded:
            getattr(_loaded[0], "straytrace_free_" + self.kind)(self.address)


def _texts(words: Sequence[str]) -> Any:
    return (c_char_p * (len(words) + 1))(*[word.encode() for word in words], None)


class Model:
    """A scene that was read and checked: a file, a `straytrace.Model` or a dict of its tables."""

    title: str
    hash: str                         # of everything that decides a trace, but seed and histories
    bodies: list[str]
    ports: list[str]
    receivers: list[str]
    surfaces: int
    warnings: str                     # as `straytrace check` prints them

    def __init__(self, scene: Tree | Mapping[str, Any] | str | os.PathLike[str], params: Parameters | None = None) -> None:
        """Raises InputError with all problems at once."""
        text = None
        if isinstance(scene, (str, os.PathLike)):
            name = os.fspath(scene)
        else:
            name, text = _single(Tree.of(scene).texts())
        self._held = _Held("model", _call("read", name.encode(), text.encode() if text is not None else None,
                                          _texts(overrides(params)[1::2])))
        self.__dict__.update(self._held.about())

    def trace(self, *, histories: int | float | None = None, until: str | None = None, seed: int | None = None, threads: int = 0,
              max_time: float = 0.0, progress: Callable[[Progress], object] | None = None) -> Run:
        """Traces the light, with the arguments of `straytrace.Model.trace`.

        progress: called some times a second; the trace ends with a valid result when it returns False, and after Ctrl-C."""
        raised: list[BaseException] = []

        def listen(state: Any, _: Any) -> int:
            try:
                return progress is None or progress(_progress(state.contents)) is not False
            except KeyboardInterrupt:
                return False
            except BaseException as error:            # raised again below: C must not see it
                raised.append(error)
                return False

        settings = _Settings(seed=ctypes.pointer(c_uint64(seed)) if seed is not None else None, histories=int(histories or 0),
                             until=until.encode() if until else None, threads=threads, max_seconds=max_time,
                             progress=_Listener(listen))
        run = Run(_Held("run", _call("trace", self._held.address, byref(settings))))
        if raised:
            raise raised[0]
        return run


def _progress(state: Any) -> Progress:
    line = f"{state.histories} histories, {state.seconds:.0f} s"
    return Progress(state.histories, state.wanted_histories, state.seconds, state.histories_per_s, math.nan, state.error,
                    state.wanted_error, line)


class Run:
    """Traced light, from which noise follows without tracing."""

    title: str
    seed: int
    histories: int
    complete: bool                    # False: stopped early, with a valid result
    warnings: list[str]

    def __init__(self, held: _Held) -> None:
        self._held = held
        self.__dict__.update(held.about())

    def noise(self, motion: Tree | Mapping[str, Any] | str | os.PathLike[str] | None = None, set: Sequence[str] = ()) -> Noise:
        """Strain noise, with other motion or other inputs than those of the run.

        motion: a file, a `straytrace.Model` or a dict of its tables.
        set: "steel=x2", "steel.brdf=5e-3/sr", "tube.motion=x2", as `straytrace noise --set`."""
        name, text = _motion(motion)
        held = _Held("noise", _call("project", self._held.address, name, text, _texts(list(set))))
        about = held.about()
        arrays = {key: _array(held, key) for key in ("frequency", "edges", "asd", "sigma", "input_low", "input_high")}
        return Noise(**arrays, design={key: _array(held, key) for key in about["design"]}, unresolved=about["unresolved"],
                     warnings=about["warnings"], headline=about["headline"], held=held)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a run file, which `straytrace.open` and the commands read."""
        _call("save", self._held.address, os.fspath(path).encode())


def _motion(given: Any) -> tuple[bytes | None, bytes | None]:
    """Name and text of a motion file."""
    if given is None or isinstance(given, (str, os.PathLike)):
        return (os.fspath(given).encode() if given is not None else None), None
    name, text = _single(texts_of(given, "motion"))
    return name.encode(), text.encode()


def _single(texts: Mapping[str, str]) -> tuple[str, str]:
    if len(texts) > 1:
        raise InputError("the native engine reads included files from disk\n  save what was changed in model.included, and load the model again")
    found, = texts.items()
    return found


def _array(held: _Held, name: str) -> Array:
    size = c_size_t()
    data = _library().straytrace_array(held.address, name.encode(), byref(size))
    return np.ctypeslib.as_array(data, (size.value,)).copy() if size.value else np.empty(0)


def open_run(path: str | os.PathLike[str]) -> Run:
    """Reads a run file, or `run.h5` in a folder. Raises InputError."""
    place = pathlib.Path(path)
    return Run(_Held("run", _call("open", str(place / "run.h5" if place.is_dir() else place).encode())))


@dataclass
class Noise:
    """Strain noise of a native run, [n] over frequency; one-sided ASDs in 1/sqrt(Hz), averaged over each bin."""

    frequency: Array                  # [n] Hz, geometric centres of bins
    edges: Array                      # [n + 1] Hz
    asd: Array                        # [n] a lower bound where `unresolved` is not empty
    sigma: Array                      # [n] one standard error, Monte Carlo
    input_low: Array                  # [n] range due to stated inputs; empty: none stated
    input_high: Array
    design: dict[str, Array]          # name: ASD
    unresolved: list[str]             # routes that could matter, each with its reason
    warnings: list[str]
    headline: str                     # the sentence that the commands print
    held: _Held = field(repr=False, compare=False)

    def at(self, hz: npt.ArrayLike) -> Any:
        """Strain between the bins, as `straytrace paths` reads it; NaN outside the band."""
        return between_bins(hz, self.edges, self.asd)

    def paths(self, frequencies: Sequence[float] = (10.0, 30.0, 100.0), low: float = 0.0, high: float = 0.0) -> dict[str, Any]:
        """The ranked paths, one array per column: rank, port, sequence, coupling, upper_bound, resolved, why_not, share, strain,
        body, phase_sensitivity [rad/m], mean_length [m]. coupling and share have value and error in their last axis, strain
        has [paths, frequencies, 2].

        low, high: Hz, band of the shares; 0: all frequencies."""
        hz = (c_double * len(frequencies))(*frequencies)
        table = json.loads(_call("paths", self.held.address, hz, len(frequencies), float(low), float(high)))
        rows, shapes = len(table["rank"]), {"coupling": (2,), "share": (2,), "strain": (len(frequencies), 2)}
        for name in ("coupling", "share", "strain", "phase_sensitivity", "mean_length"):
            table[name] = np.array(table[name], dtype=float).reshape(rows, *shapes.get(name, ()))
        return {name: np.asarray(values) for name, values in table.items()}
