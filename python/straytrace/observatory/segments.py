# SPDX-License-Identifier: BSD-3-Clause
"""Segments of data quality in LIGO_LW, HDF5 of gwpy and JSON of DQSegDB, as columns of text."""

from __future__ import annotations

import csv
import gzip
import json
import xml.etree.ElementTree
from typing import Any

from .common import DataError, gps, package

Flags = dict[str, list[tuple[float, float]]]               # active segments by IFO:NAME:VERSION


def table_rows(table: Any) -> list[dict[str, str]]:
    """Rows of a table of LIGO_LW by the last part of the names of its columns."""
    names = [column.get("Name", "").split(":")[-1] for column in table.findall("Column")]
    stream = table.find("Stream")
    text = "".join((stream.text or "").split("\n")) if stream is not None else ""
    cells = [cell.strip() for line in csv.reader([text], skipinitialspace=True, escapechar="\\") for cell in line]
    while cells and not cells[-1]:
        cells.pop()
    return [dict(zip(names, cells[i:i + len(names)])) for i in range(0, len(cells), max(len(names), 1))]


def flags_of_ligolw(path: str) -> Flags:
    with (gzip.open if path.lower().endswith(".gz") else open)(path, "rb") as file:
        tree = xml.etree.ElementTree.parse(file)
    tables = {t.get("Name", "").replace(":table", "").split(":")[-1]: table_rows(t) for t in tree.iter("Table")}
    names = {row["segment_def_id"]: f"{row['ifos']}:{row['name']}:{row['version']}" for row in tables["segment_definer"]}
    flags: Flags = {name: [] for name in names.values()}
    for row in tables["segment"]:
        start, end = (float(row[f"{edge}_time"]) + 1e-9 * float(row.get(f"{edge}_time_ns") or 0) for edge in ("start", "end"))
        flags[names[row["segment_def_id"]]].append((start, end))
    return flags


def flags_of_json(path: str) -> Flags:
    with open(path, encoding="utf-8") as file:
        flag = json.load(file)
    return {f"{flag['ifo']}:{flag['name']}:{flag['version']}": [(float(a), float(b)) for a, b in flag["active"]]}


def flags_of_hdf5(path: str) -> Flags:
    """As gwpy writes them: a group for each flag, with a table `active`."""
    flags: Flags = {}
    with package("h5py", "segments in HDF5").File(path) as file:
        groups = {name: group for name, group in file.items() if "active" in group}
        if "active" in file:
            groups = {str(file.attrs.get("name", "active")): file}
        for name, group in groups.items():
            rows = group["active"][:]
            edges = [rows[f"{edge}_time"] + 1e-9 * rows[f"{edge}_time_ns"] for edge in ("start", "end")]
            flags[name] = [(float(a), float(b)) for a, b in zip(*edges)]
    return flags


def write_segments(path: str, file: str, flag: str) -> None:
    readers = {".xml": flags_of_ligolw, ".xml.gz": flags_of_ligolw, ".json": flags_of_json}
    reader = next((r for ending, r in readers.items() if file.lower().endswith(ending)), flags_of_hdf5)
    try:
        flags = reader(file)
    except DataError:
        raise
    except Exception as why:                            # of a file that is not what its name says
        first = (str(why).strip() or type(why).__name__).split("\n")[0]
        raise DataError(f"it cannot be read as segments: {first}",
                        "give LIGO_LW, HDF5 of gwpy or JSON of DQSegDB, or two columns of text: GPS start, GPS end") from None
    known = ", ".join(sorted(flags)) or "no flags"
    found = [name for name in flags if flag in (name, name.rsplit(":", 1)[0]) or (not flag and len(flags) == 1)]
    if len(found) != 1:
        what = f"it has no flag '{flag}'" if flag and not found else f"it has {len(found or flags)} flags{f' {flag!r}' if flag else ''}"
        raise DataError(what, f"name one, for example {file}::{min(flags, default='V1:NAME:1')}; there are {known}")
    with open(path, "w", encoding="utf-8") as out:
        out.writelines(f"{gps(a)} {gps(b)}\n" for a, b in flags[found[0]])
