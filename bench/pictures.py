# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the page of benchmarks. Each knows the lines that it was drawn from: their sha256 is in its text chunk."""
import hashlib
import json
import struct

DRAWN = {}                                               # bench: function (lines, figure)


def mark(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def picture_of(pages, bench):
    return pages / f"benchmarks_{bench}.png"


def mark_in(png):
    """The text chunk "Source" of a PNG, None if there is none."""
    data, at = png.read_bytes(), 8
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"tEXt" and data[at + 8:].startswith(b"Source\0"):
            return data[at + 15:at + 8 + size].decode()
        at += 12 + size
    return None


def outdated(pages, folder):
    for bench in DRAWN:
        lines, png = folder / f"{bench}.jsonl", picture_of(pages, bench)
        if lines.exists() and (not png.exists() or mark_in(png) != mark(lines)):
            yield f"{png.name} is not drawn from {lines.name} as it is"


def draw(pages, folder):
    from matplotlib.figure import Figure                 # only here: the check needs no libraries
    for bench, function in DRAWN.items():
        file = folder / f"{bench}.jsonl"
        if file.exists():
            figure = Figure(layout="constrained")
            function([json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()], figure)
            figure.savefig(picture_of(pages, bench), dpi=110, metadata={"Source": mark(file)})
