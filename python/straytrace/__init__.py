# SPDX-License-Identifier: BSD-3-Clause
"""Stray-light noise of interferometric gravitational-wave detectors.

Builds and checks models, runs them with the program of the same name, and reads their results as numpy arrays and
pandas tables::

    import straytrace
    run = straytrace.Model.load("arm.yaml").run()
    print(run.paths(where="share > 5 %").table())
    storm = run.noise(motion="storm.yaml")
"""

import os
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from .curves import Bands, Curve, Noise
from .engine import Progress
from .errors import InputError, NumericalError, Problem, RunError, StraytraceWarning
from .model import Check, Model
from .paths import Path, Paths
from .routes import Ledger, Receiver, Receivers, Routes
from .run import Run, open_run
from .scan import Scan, ScanPoint, scan
from .tree import Items, Table, quantity

try:
    __version__ = version("straytrace")
except PackageNotFoundError:                    # used from the source tree
    __version__ = "unknown"

open = open_run


def check(model: "Model | Mapping[str, Any] | str | os.PathLike[str]", **options: Any) -> Check:
    """Model.check of a Model, a dict or a file."""
    return Model.of(model).check(**options)


def trace(model: "Model | Mapping[str, Any] | str | os.PathLike[str]", out: "str | os.PathLike[str] | None" = None,
          **options: Any) -> Run:
    """Model.trace of a Model, a dict or a file."""
    return Model.of(model).trace(out, **options)


def run(model: "Model | Mapping[str, Any] | str | os.PathLike[str]", out: "str | os.PathLike[str] | None" = None,
        **options: Any) -> Run:
    """Model.run of a Model, a dict or a file."""
    return Model.of(model).run(out, **options)


__all__ = ["Bands", "Check", "Curve", "InputError", "Items", "Ledger", "Model", "Noise", "NumericalError", "Path", "Paths",
           "Problem", "Progress", "Receiver", "Receivers", "Routes", "Run", "RunError", "Scan", "ScanPoint",
           "StraytraceWarning", "Table", "check", "open", "open_run", "quantity", "run", "scan", "trace"]
