# SPDX-License-Identifier: BSD-3-Clause
"""python3 -m straytrace: the program."""

from .engine import command

command()
