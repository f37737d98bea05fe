# SPDX-License-Identifier: BSD-3-Clause
"""Models: the tree of a scene file, built or loaded, checked and run."""

from __future__ import annotations

import json
import math
import os
import pathlib
import tempfile
import warnings
from collections.abc import Iterator, Mapping, MutableMapping
from dataclasses import dataclass
from typing import Any, Union

from . import engine
from .errors import InputError, Problem, StraytraceWarning
from .progress import Shown, shown
from .run import Run, Scratch, open_run
from .tree import SCALARS, Table, YAMLError, dump, load, plain, scene_tree

Parameters = Mapping[str, Union[str, float]]


@dataclass(frozen=True)
class Check:
    """Results of a model that need no tracing."""

    surfaces: int
    groups: int
    bodies: int
    ports: int
    receivers: int
    lit: list[dict[str, Any]]         # surfaces lit by followed beams: docs/reference/commands.md
    model_hash: str                   # of everything that can change the trace
    wave: dict[str, Any] | None       # grid and crossover angle of the table wave; None without it
    warnings: tuple[Problem, ...]


def overrides(params: Parameters | None) -> list[str]:
    """Options -p of the command line."""
    words = []
    for name, value in (params or {}).items():
        value = plain(value, f"params[{name!r}]")
        if not isinstance(name, str) or isinstance(value, bool) or not isinstance(value, SCALARS):
            raise TypeError(f"params[{name!r}] is {value!r}; write a number or a text with a unit: {{'aperture': '60 cm'}}")
        words += ["-p", f"{name}={value}"]
    return words


def _count(value: int | float | None, name: str) -> int | None:
    """A whole number; 1e6 is one."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value != math.floor(value):
        raise TypeError(f"{name} is {value!r}; write a whole number such as 100000 or 1e6")
    return int(value)


def trace_words(histories: int | float | None = None, until: str | None = None, seed: int | None = None,
                threads: int | None = None, max_time: float | str | None = None, force: bool = False) -> list[str]:
    """Options of the command line for a trace."""
    if until is not None and not isinstance(until, str):
        raise TypeError(f"until is {until!r}; write a rule such as 'h_total < 5 %' or '10 min'")
    given = {"--histories": _count(histories, "histories"), "--until": until, "--seed": _count(seed, "seed"),
             "--threads": _count(threads, "threads"),
             "--max-time": f"{max_time}s" if isinstance(max_time, (int, float)) else max_time}
    words = [f"{name}={value}" for name, value in given.items() if value is not None]
    return words + (["--force"] if force else [])


class Model(Table):
    """A model as a tree of tables, lists, numbers and strings, as in YAML (docs/reference/scene.md).

    Tables are dicts whose keys are also attributes; list entries can be accessed by name::

        model = Model.load("arm.yaml")
        model.params.aperture = "60 cm"
        model.scene["baffle"].at = ["0 m", "0 m", "400 m"]

    File names in the model are relative to `folder`; `name` is the name of the model in messages and run files.
    """

    def __init__(self, tree: Mapping[str, Any] | None = None, *, folder: str | os.PathLike[str] = ".",
                 name: str = "model.yaml", **tables: Any) -> None:
        if tree is not None and not isinstance(tree, Mapping):
            raise TypeError(f"a model is a dict of tables, not {type(tree).__name__}; for a file: Model.load({tree!r})")
        self._set(scene_tree({**(tree or {}), **tables}), pathlib.Path(folder) / name, None)

    def _set(self, data: Any, path: pathlib.Path, text: str | None) -> None:
        super().__init__(data, "model")
        object.__setattr__(self, "path", path)
        object.__setattr__(self, "_read", (text, dump(data)) if text is not None else None)
        object.__setattr__(self, "_included", {})

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """The model in a YAML file, with its comments. Raises InputError."""
        path = pathlib.Path(path)
        try:
            text = path.read_bytes().decode("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            engine.ask("check", str(path))                  # gives a better message
            raise InputError(f"cannot read '{path}': {error}") from None
        return cls.from_text(text, path)

    @classmethod
    def from_text(cls, text: str, path: str | os.PathLike[str] = "model.yaml") -> Model:
        """The model in a text, treated as if read from the file `path`. Raises InputError."""
        path = pathlib.Path(path)
        try:
            data = load(text)
        except YAMLError as error:
            engine.ask("check", str(path), unsaved={str(path): text})
            raise InputError(f"{path.name}: error: {error}") from None
        if not isinstance(data, MutableMapping):
            engine.ask("check", str(path), unsaved={str(path): text})
            raise InputError(f"{path.name}: error: this is not a YAML table")
        model = cls.__new__(cls)
        model._set(data, path, text)
        return model

    @classmethod
    def of(cls, what: Model | Mapping[str, Any] | str | os.PathLike[str]) -> Model:
        """A model from a Model (unchanged), a dict or a file."""
        if isinstance(what, Model):
            return what
        if isinstance(what, Mapping):
            return cls(what)
        if isinstance(what, (str, os.PathLike)):
            return cls.load(what)
        raise TypeError(f"{what!r} is not a model; give a Model, a dict of its tables, or the name of a YAML file")

    def text(self) -> str:
        """The YAML text; identical to the file until the model is changed."""
        now = dump(self.data)
        return self._read[0] if self._read and self._read[1] == now else now

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the YAML text to `path`; the file appears complete or not at all."""
        path = pathlib.Path(path)
        handle, part = tempfile.mkstemp(prefix=path.name + ".part-", dir=path.parent)
        try:
            with os.fdopen(handle, "w", encoding="utf-8", newline="") as file:
                file.write(self.text())
            os.chmod(part, 0o644)
            os.replace(part, path)
        finally:
            pathlib.Path(part).unlink(missing_ok=True)

    @property
    def included(self) -> dict[str, Model]:
        """The files that this model includes, by name, as models; their changes are checked and run with this one, and
        `save` writes each separately. Files of the library are not included."""
        for name in self._included_names():
            path = self.path.parent / name
            if name not in self._included and path.is_file():
                self._included[name] = Model.load(path)
        return {name: self._included[name] for name in self._included_names() if name in self._included}

    def _included_names(self) -> list[str]:
        names = self.data.get("include", [])
        return [str(name) for name in names] if isinstance(names, list) else [str(names)]

    def texts(self) -> dict[str, str]:
        """The texts read instead of files, by name: this model, and the included files that were accessed."""
        texts = {str(self.path): self.text()}
        for name in self._included_names():
            texts |= self._included[name].texts() if name in self._included else {}
        return texts

    def __iter__(self) -> Iterator[str]:
        return iter(self.data)

    def _ask(self, *words: str, **options: Any) -> engine.Answer:
        return engine.ask(words[0], str(self.path), *words[1:], unsaved=self.texts(), **options)

    def check(self, params: Parameters | None = None) -> Check:
        """All checks and results that need no tracing. Raises InputError with all problems at once."""
        answer = self._ask("check", "--format", "json", *overrides(params))
        about = {"surfaces": 0, "groups": 0, "ports": 0, "receivers": 0, "lit": [], "model_hash": "",
                 **json.loads(answer.output)}
        about.pop("ok")
        return Check(**about, warnings=answer.problems)

    def resolved(self, params: Parameters | None = None) -> str:
        """The YAML text in SI with every parameter evaluated, and includes, parts and repeats expanded."""
        return self._ask("check", "--resolved", *overrides(params)).output

    def run(self, out: str | os.PathLike[str] | None = None, *, params: Parameters | None = None,
            histories: int | float | None = None, until: str | None = None, seed: int | None = None,
            threads: int | None = None, max_time: float | str | None = None, force: bool = False,
            progress: bool | Shown | None = True) -> Run:
        """Check, trace and noise, as `straytrace run`, with bit-identical results.

        out: a folder for all results, or a run file (.h5); None: a temporary file, deleted with the result.
        params: overrides parameters of the model, as -p: ``{"aperture": "60 cm"}``.
        histories, until, seed: number of histories, stop rule such as ``"h_total < 5 %"``, random seed;
        default: as in the model.
        threads: all cores by default; the results do not depend on it.
        max_time: seconds, or "50min".
        force: overwrite the run of another model in `out`; otherwise a run of the same model is resumed.
        progress: True, False, or a function called with a `Progress` every half second.

        Ctrl-C returns the result so far, valid, with ``complete == False``."""
        words = [*overrides(params), *trace_words(histories, until, seed, threads, max_time, force)]
        return traced(self.texts(), "run", words, out, progress)

    def trace(self, out: str | os.PathLike[str] | None = None, *, params: Parameters | None = None,
              histories: int | float | None = None, until: str | None = None, seed: int | None = None,
              threads: int | None = None, max_time: float | str | None = None, force: bool = False,
              progress: bool | Shown | None = True) -> Run:
        """Traces only, as `straytrace trace`, into the run file `out`; arguments as for `run`."""
        words = [*overrides(params), *trace_words(histories, until, seed, threads, max_time, force)]
        return traced(self.texts(), "trace", words, out, progress)


def traced(texts: Mapping[str, str], command: str, words: list[str], out: str | os.PathLike[str] | None,
           progress: bool | Shown | None, warn: bool = True) -> Run:
    """What Model.run and Model.trace do, with options as the command line writes them. texts: by file name, the model
    first. warn: of what a reader must know."""
    scratch = Scratch() if out is None else None
    place = scratch.file("run.h5") if scratch else os.fspath(out)  # type: ignore[arg-type]
    with shown(progress) as listener:
        answer = engine.ask(command, next(iter(texts)), "-o", place, *words, unsaved=texts, progress=listener)
    run = open_run(place)
    run.scratch = scratch
    early = [] if run.complete else [f"stopped early, after {run.histories} histories, with a valid result"]
    for warning in answer.warnings + early if warn else []:
        warnings.warn(warning, StraytraceWarning, stacklevel=3)
    return run
