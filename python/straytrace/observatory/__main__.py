# SPDX-License-Identifier: BSD-3-Clause
"""Writes what the program reads. Usage: python3 -m straytrace.observatory record SOURCE -o OUT.hdf5 [--channel NAME] [--from GPS]
[--to GPS] [--gaps], or segments FILE -o OUT.txt [--flag NAME]"""

from __future__ import annotations

import argparse
import math
import sys

from .common import DataError
from .records import from_frames, from_nds2, write_record
from .segments import write_segments


def main() -> None:
    parser = argparse.ArgumentParser(prog="straytrace.observatory", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    record = commands.add_parser("record")
    record.add_argument("source")
    record.add_argument("--channel", default="")
    record.add_argument("--from", dest="start", type=float, default=-math.inf)
    record.add_argument("--to", dest="end", type=float, default=math.inf)
    record.add_argument("--gaps", action="store_true", help="NaN in gaps, which are an error otherwise")
    segments = commands.add_parser("segments")
    segments.add_argument("source")
    segments.add_argument("--flag", default="")
    for command in (record, segments):
        command.add_argument("-o", "--out", required=True)
    asked = parser.parse_args()
    try:
        if asked.command == "segments":
            write_segments(asked.out, asked.source, asked.flag)
            return
        span = asked.start, asked.end
        remote = asked.source.startswith("nds2://")
        found = from_nds2(asked.source, asked.channel, span) if remote else from_frames(asked.source, asked.channel, span, asked.gaps)
        write_record(asked.out, *found)
    except DataError as error:
        sys.exit(f"error: {error}\n  {error.remedy}")


if __name__ == "__main__":
    main()
