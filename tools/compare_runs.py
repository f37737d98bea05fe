#!/usr/bin/env python3
"""Compare what two builds of straytrace compute: every example is run by both with the same seed, and every dataset and
attribute of the run files must be equal, bit for bit, but for the time, the program and the seconds it took. Groups and
attributes that an old program does not write yet, and descriptions in words, are not compared.

Usage: compare_runs.py OLD_PROGRAM NEW_PROGRAM [--histories N] [SCENE.yaml ...]
Exit code 1 when a file differs; scenes that both programs reject with the same message and exit code are equal."""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
ADDED = {"projection", "members"}                # groups that old programs do not write
DESCRIPTIONS = {"meaning"}                       # attributes in words: missing in old files, or reworded
ADDED_DATASETS = {"records/member"}               # datasets of older groups
HASHES_OF_THE_BUILD = {"wave@key", "wave_ring@key"}               # they contain the commit
OF_THE_BUILD = {"created", "schema", "program", "version", "commit", "machine", "command"}     # attributes of the root


def contents(path):
    """All values of a run file by their path."""
    values = {}

    def keep(name, item):
        if name.split("/")[0] == "timing":
            return
        for key, value in item.attrs.items():
            if f"{name}@{key}" not in HASHES_OF_THE_BUILD:
                values[f"{name}@{key}"] = value
        if isinstance(item, h5py.Dataset):
            values[name] = item[()]

    with h5py.File(path) as file:
        for key, value in file.attrs.items():
            if key not in OF_THE_BUILD:
                values[f"@{key}"] = value
        file.visititems(keep)
    return values


def bits(value):
    array = np.asarray(value)
    return array.dtype.str, array.shape, array.tolist() if array.dtype == object else array.tobytes()    # texts are objects


def differences(old, new):
    for name in sorted(old.keys() | new.keys()):
        item, _, attribute = name.partition("@")
        added = re.split("[/@]", name)[0] in ADDED or item in ADDED_DATASETS
        if name not in old and (added or item in old and attribute in DESCRIPTIONS):
            continue
        if name not in old or name not in new:
            yield f"{name} is only in the {'new' if name in new else 'old'} file"
        elif attribute not in DESCRIPTIONS and bits(old[name]) != bits(new[name]):
            yield f"{name} differs"


def run(program, scene, histories, folder):
    done = subprocess.run([program, "run", scene, "--histories", str(histories), "--quiet", "-o", folder],
                          capture_output=True, text=True, cwd=ROOT)
    return folder / "run.h5", done.stderr, done.returncode


def compare(programs, scene, histories):
    with tempfile.TemporaryDirectory() as scratch:
        ran = [run(program, scene, histories, pathlib.Path(scratch) / side) for program, side in zip(programs, ("old", "new"))]
        there = [path.exists() for path, *_ in ran]
        if not any(there):
            return "no run file from either" if ran[0][1:] == ran[1][1:] else "exit codes or messages differ"
        if not all(there):
            return f"no run file from the {'new' if there[0] else 'old'} program: {ran[there[0]][1].strip()[:200]}"
        return list(differences(*(contents(path) for path, *_ in ran)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--histories", default="20000")
    options = parser.parse_intermixed_args()
    scenes = options.scenes or sorted(str(p) for p in (ROOT / "examples").rglob("*.yaml"))
    programs = [str(pathlib.Path(p).resolve()) for p in (options.old, options.new)]
    failed = 0
    for scene in scenes:
        found = compare(programs, str(pathlib.Path(scene).resolve()), options.histories)
        same = not found or found == "no run file from either"
        failed += not same
        name = pathlib.Path(scene).name
        shown = found if isinstance(found, str) else "equal" if same else "; ".join(found[:5])
        more = f"; and {len(found) - 5} more" if isinstance(found, list) and len(found) > 5 else ""
        print(f"{name}: {shown}{more}", flush=True)
    print(f"scenes: {len(scenes)}, different: {failed}")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
