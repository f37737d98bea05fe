# SPDX-License-Identifier: BSD-3-Clause
"""Stray-light noise of interferometric gravitational-wave detectors.

Builds and checks models, runs them with the program of the same name, and reads their results as numpy arrays and
pandas tables::

    import straytrace
    run = straytrace.Model.load("arm.yaml").run()
    print(run.paths(where="share > 5 %").table())
    storm = run.noise(motion="storm.yaml")
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from .curves import Bands, Curve, Noise, Positions
from .engine import Progress
from .errors import InputError, NumericalError, Problem, RunError, StraytraceWarning
from .paths import Path, PathColumn, Paths
from .routes import EnergyBalance, Receiver, Receivers, Routes
from .run import Run, open_run
from .sensitivity import SensitiveInput, Sensitivity
from .wave import Irradiance, SeamCheck, Wave, WaveRing

if TYPE_CHECKING:
    from .ifo import Interferometer
    from .model import Check, Model
    from .scans import Candidate, Optimum, Scan, ScanPoint, optimise, scan
    from .tree import Items, Table, quantity

# Loaded on demand: the pictures of the program need neither these modules nor their packages.
_LATER = {"Check": "model", "Interferometer": "ifo", "Model": "model", "Scan": "scans", "ScanPoint": "scans", "scan": "scans", "Candidate": "scans", "Optimum": "scans", "optimise": "scans", "Items": "tree",
          "Table": "tree", "quantity": "tree"}

open = open_run


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            return version("straytrace")
        except PackageNotFoundError:            # used from the source tree
            return "unknown"
    if name not in _LATER:
        raise AttributeError(f"straytrace has no '{name}'; it has: {', '.join(__all__)}")
    return getattr(importlib.import_module("." + _LATER[name], __name__), name)


def _model(what: Model | Mapping[str, Any] | str | os.PathLike[str]) -> Model:
    from .model import Model

    return Model.of(what)


def check(model: Model | Mapping[str, Any] | str | os.PathLike[str], **options: Any) -> Check:
    """Model.check of a Model, a dict or a file."""
    return _model(model).check(**options)


def trace(model: Model | Mapping[str, Any] | str | os.PathLike[str], out: str | os.PathLike[str] | None = None,
          **options: Any) -> Run:
    """Model.trace of a Model, a dict or a file."""
    return _model(model).trace(out, **options)


def run(model: Model | Mapping[str, Any] | str | os.PathLike[str], out: str | os.PathLike[str] | None = None,
        **options: Any) -> Run:
    """Model.run of a Model, a dict or a file."""
    return _model(model).run(out, **options)


__all__ = ["Bands", "Candidate", "Check", "Curve", "InputError", "Interferometer", "Irradiance", "Items", "EnergyBalance", "Model", "Noise", "NumericalError", "Optimum", "Path", "PathColumn", "Paths", "Positions",
           "Problem", "Progress", "Receiver", "Receivers", "Routes", "Run", "RunError", "Scan", "ScanPoint",
           "SeamCheck", "SensitiveInput", "Sensitivity", "StraytraceWarning", "Table", "Wave", "WaveRing", "check", "open", "open_run", "optimise", "quantity", "run", "scan", "trace"]
