# SPDX-License-Identifier: BSD-3-Clause
"""Turns specular layouts into scenes: theia .tia files, gtrace JSON and sequential lens files of Zemax, chosen by their content.

python3 -m straytrace.layouts bench.tia -o bench.yaml
python3 -m straytrace.layouts doublet.zmx --glass schott.agf -o doublet.yaml
python3 -m straytrace.layouts layout.json -o layout.yaml
"""

from __future__ import annotations

import argparse
import json
import pathlib
import sys

from .gtrace import read_gtrace
from .scene import Layout, LayoutError, scene_text
from .theia import read_theia
from .zemax import decoded, is_zemax, read_glasses, read_zemax


def read_layout(path, catalogues=()) -> Layout:
    """The layout in a file, with glass catalogues (.agf) for Zemax; LayoutError lists all its problems."""
    lens = decoded(path)
    if is_zemax(lens):
        return read_zemax(str(path), lens, read_glasses(catalogues))
    try:
        text = pathlib.Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise LayoutError([f"{path}: is not text; save the layout as .tia or as JSON of gtrace"]) from None
    if not text.lstrip().startswith("{"):
        return read_theia(str(path), text)
    try:
        content = json.loads(text)
    except json.JSONDecodeError as error:
        raise LayoutError([f"{path}:{error.lineno}:{error.colno}: error: {error.msg}; save it again"]) from None
    return read_gtrace(str(path), content)


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(prog="straytrace.layouts", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("layout", type=pathlib.Path, help="theia .tia, JSON that gtrace's OpticalLayout.save wrote, or Zemax .zmx")
    parser.add_argument("--glass", type=pathlib.Path, action="append", default=[], help="glass catalogue of Zemax (.agf); may be repeated")
    parser.add_argument("-o", "--out", type=pathlib.Path, required=True, help="scene to write (YAML)")
    options = parser.parse_args(arguments)
    try:
        layout = read_layout(options.layout, options.glass)
        temporary = options.out.with_name(options.out.name + ".part")
        temporary.write_text(scene_text(layout, options.layout.name), encoding="utf-8")
        temporary.replace(options.out)
    except LayoutError as error:
        print("\n".join(error.problems), file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: '{error.filename}': {error.strerror}; check the name and the folder", file=sys.stderr)
        return 2
    print(f"written: {options.out}: {len(layout.optics) + len(layout.shaped)} optics, {len(layout.beams)} beams")
    for note in layout.left_out:
        print(f"not translated: {note}")
    return 0
