# SPDX-License-Identifier: BSD-3-Clause
"""Reads straytrace run files: ``run = straytrace.open("run.h5")``."""

from .run import Run, RunError, open_run

open = open_run

__all__ = ["Run", "RunError", "open", "open_run"]
