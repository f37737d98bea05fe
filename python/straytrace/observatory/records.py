# SPDX-License-Identifier: BSD-3-Clause
"""Records from frame files (GWF), lists of them and NDS2 servers."""

from __future__ import annotations

import importlib
import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .common import HERE, DataError, gps, has, package

LISTS = (".ffl", ".lcf", ".cache")
LONGEST = 2 * 86400.0                                # s, of a list that is read without a span
SLACK = 0.02                                            # share of a sample by which clocks of frames may disagree


@dataclass
class Piece:
    """Regular samples of a frame; NaN where the frame flags them as invalid."""

    start: float                                        # GPS s
    rate: float                                         # Hz
    samples: Any
    unit: str
    source: str
    raw: bool = False                                   # ADC counts, before slope and bias

    @property
    def end(self) -> float:
        return self.start + len(self.samples) / self.rate


@dataclass(frozen=True)
class Entry:
    """A frame file and its span in GPS s, as its list states it; of a single file all times."""

    path: str
    start: float = -math.inf
    end: float = math.inf


def line_of_list(words: list[str], place: str) -> Entry:
    """FFL: PATH START DURATION ...; LAL cache: OBSERVATORY DESCRIPTION START DURATION URL."""
    try:
        if len(words) == 5 and "/" in words[4] and not words[0].endswith(".gwf"):
            start, duration, path = float(words[2]), float(words[3]), words[4]
        else:
            start, duration, path = float(words[1]), float(words[2]), words[0]
    except (IndexError, ValueError):
        raise DataError(f"{place} is no entry of a list of frame files",
                        "an FFL has lines 'PATH GPS DURATION 0 0', a LAL cache 'V V1Online GPS DURATION URL'") from None
    scheme, found, rest = path.partition("://")
    local = rest.removeprefix("localhost") if found else path
    if found and (scheme != "file" or not local.startswith("/")):
        raise DataError(f"{place} names '{path}', which is no local file", "copy the frames, or give a list of local files")
    return Entry(local, start, start + duration)


def entries_of(source: str) -> list[Entry]:
    if not source.lower().endswith(LISTS):
        return [Entry(source)]
    folder = os.path.dirname(source)
    with open(source, encoding="utf-8", errors="replace") as file:
        lines = [(number, line.split()) for number, line in enumerate(file, 1)]
    found = [line_of_list(words, f"line {number}") for number, words in lines if words and not words[0].startswith("#")]
    if not found:
        raise DataError("the list names no frame file", "an FFL has lines 'PATH GPS DURATION 0 0'")
    entries = {Entry(os.path.join(folder, e.path), e.start, e.end) for e in found}
    return sorted(entries, key=lambda e: (e.start, e.path))


def chosen(channel: str, names: list[str], path: str) -> str:
    if channel in names:
        return channel
    if not channel and len(names) == 1:
        return names[0]
    shown = ", ".join(sorted(names)[:12]) + (f" and {len(names) - 12} more" if len(names) > 12 else "")
    what = f"'{path}' has no channel '{channel}'" if channel else f"'{path}' has {len(names)} channels"
    raise DataError(what, f"name one, for example {path}::{min(names, default='V1:CHANNEL')}; there are {shown}")


def overlaps(start: float, end: float, span: tuple[float, float]) -> bool:
    return start < span[1] and end > span[0]


def pieces_by_gwframe(entry: Entry, channel: str, span: tuple[float, float]) -> Iterator[Piece]:
    with importlib.import_module("gwframe").FrameReader(entry.path) as reader:
        name = chosen(channel, list(reader.channels), entry.path)
        for index, frame in enumerate(reader.frame_spans):
            if not overlaps(frame.start, frame.end, span):
                continue
            data = reader.read(name, frame_index=index, allow_invalid=True, aux_mask=True)
            samples = data.array
            if data.mask is not None and np.any(data.mask):
                samples = np.where(data.mask, np.nan, samples.astype(float))
            yield Piece(data.start, data.sample_rate, samples, data.unit, entry.path, data.type == "adc")


def pieces_by_gwpy(entry: Entry, channel: str, span: tuple[float, float]) -> Iterator[Piece]:
    gwf = package("gwpy.io.gwf", "reading frames without gwframe")
    name = chosen(channel, list(gwf.get_channel_names(entry.path)), entry.path)
    series = package("gwpy.timeseries", "reading frames").TimeSeries.read(entry.path, name, format="gwf")
    if overlaps(float(series.t0.value), float(series.span[1]), span):
        yield Piece(float(series.t0.value), float(series.sample_rate.value), series.value, str(series.unit), entry.path)


def pieces_of(entry: Entry, channel: str, span: tuple[float, float]) -> list[Piece]:
    if not os.path.isfile(entry.path):
        raise DataError(f"there is no frame file '{entry.path}'", "correct its path in the list, or mount the folder that it is in")
    with_gwframe = has("gwframe")
    if not with_gwframe and not has("gwpy"):
        package("gwframe", "reading frames")
    try:
        return list((pieces_by_gwframe if with_gwframe else pieces_by_gwpy)(entry, channel, span))
    except DataError:
        raise
    except Exception as why:                            # of the library, which may raise anything
        first = (str(why).strip() or type(why).__name__).split("\n")[0]
        raise DataError(f"'{entry.path}' cannot be read as frames: {first}", "copy the file again") from None


def joined(pieces: list[Piece], span: tuple[float, float], gaps: bool) -> tuple[Piece, str]:
    """All pieces as one record, NaN in gaps; the second value tells of the first gap."""
    pieces = sorted(pieces, key=lambda p: p.start)
    first, gap = pieces[0], ""
    samples, count = [], 0
    for piece in pieces:
        if abs(piece.rate / first.rate - 1) > 1e-9 or piece.unit != first.unit:
            raise DataError(f"{piece.rate:g} Hz in '{piece.unit}' from GPS {gps(piece.start)}, before {first.rate:g} Hz in '{first.unit}'",
                            f"choose a span on one side, for example {gps(first.start)}..{gps(piece.start)}")
        steps = (piece.start - first.start) * first.rate
        missing = round(steps) - count
        if abs(steps - round(steps)) > max(SLACK, 4e-7 * first.rate):
            raise DataError(f"the clock jumps by a part of a sample at GPS {gps(piece.start)}",
                            f"choose a span on one side, for example {gps(first.start)}..{gps(piece.start)}")
        if missing < 0:
            raise DataError(f"two frames hold GPS {gps(piece.start)}: '{piece.source}' and one before",
                            "remove one of them from the list of frames")
        if missing > 0:
            end = first.start + count / first.rate
            gap = gap or f"no frame from GPS {gps(end)} to {gps(piece.start)}"
            if not gaps:
                raise DataError(gap, f"choose a span without the gap, for example {gps(max(first.start, span[0]))}..{gps(end)}")
            samples.append(np.full(missing, np.nan))
        samples.append(piece.samples)
        count += missing + len(piece.samples)
    return Piece(first.start, first.rate, np.concatenate(samples), first.unit, first.source, any(p.raw for p in pieces)), gap


def from_frames(source: str, channel: str, span: tuple[float, float], gaps: bool) -> tuple[str, Piece]:
    entries = entries_of(source)
    inside = [e for e in entries if overlaps(e.start, e.end, span)]
    total = sum(e.end - e.start for e in inside)
    if math.isfinite(total) and total > LONGEST and not all(map(math.isfinite, span)):
        raise DataError(f"its files last {total / 86400:.1f} days together", f"choose a span, for example {gps(inside[0].start)}..{gps(inside[0].start + 4096)}")
    pieces = [piece for entry in inside for piece in pieces_of(entry, channel, span)]
    if not pieces:
        first, last = entries[0].start, max(e.end for e in entries)
        holds = f"; its files cover GPS {gps(first)} to {gps(last)}" if math.isfinite(first) else ""
        raise DataError(f"no frame of it lies in GPS {gps(span[0])}..{gps(span[1])}{holds}", "choose another span, or other frames")
    record, gap = joined(pieces, span, gaps)
    if gap:
        print(f"note: {gap}")
    name = channel or chosen("", [channel_of(inside[0].path)], inside[0].path)
    if record.raw:
        print(f"warning: '{name}' is an ADC channel; its samples are those stored, slope and bias of the frame are not applied")
    return name, record


def channel_of(path: str) -> str:
    """The only channel of a file, where none was named."""
    if has("gwframe"):
        with importlib.import_module("gwframe").FrameReader(path) as reader:
            return str(reader.channels[0])
    return str(package("gwpy.io.gwf", "reading frames").get_channel_names(path)[0])


def from_nds2(source: str, channel: str, span: tuple[float, float]) -> tuple[str, Piece]:
    """nds2://HOST or nds2://HOST:PORT. gwpy needs the client of NDS2, which conda has."""
    host, _, port = source.removeprefix("nds2://").partition(":")
    if not host or "/" in host or not (port or "31200").isdigit():
        raise DataError(f"'{source}' names no server", "write nds2://HOST:PORT::CHANNEL, for example nds2://nds.ligo.caltech.edu::H1:NAME")
    if not channel:
        raise DataError("a server has many channels", f"name one: {source}::V1:CHANNEL")
    if not all(map(math.isfinite, span)):
        raise DataError("a server needs both ends of the stretch", "choose a span A..B")
    series_class = package("gwpy.timeseries", "reading from NDS2").TimeSeries
    if not has("nds2"):
        raise DataError(f"NDS2 needs its client, which {HERE} does not have",
                        "conda install -c conda-forge python-nds2-client gwpy, and set STRAYTRACE_PYTHON to that Python")
    try:
        series = series_class.fetch(channel, span[0], span[1], host=host, port=int(port or 31200), verbose=False)
    except Exception as why:                            # of the client: no ticket, no channel, no data
        first = (str(why).strip() or type(why).__name__).split("\n")[0]
        raise DataError(f"{host} gives no '{channel}': {first}", "check channel, span and credentials (kinit, htgettoken)") from None
    return channel, Piece(float(series.t0.value), float(series.sample_rate.value), series.value, str(series.unit), source)


def write_record(path: str, name: str, record: Piece) -> None:
    h5py = package("h5py", "the record")
    with h5py.File(path, "w") as file:
        data = file.create_dataset(name.replace("/", "_"), data=record.samples)
        data.attrs.update(x0=record.start, dx=1 / record.rate, xunit="s", name=name, channel=name)
        if record.unit and record.unit not in ("dimensionless", "none", "None"):
            data.attrs["unit"] = record.unit
