# SPDX-License-Identifier: BSD-3-Clause
"""Shared by the tests of distributed runs: a scene that is traced quickly, the program, and the bits of a run."""
import hashlib
import os
import pathlib
import subprocess
import sys

import h5py

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
SOURCE = pathlib.Path(__file__).resolve().parents[3]
SCENE = [str(SOURCE / "tests/scenes/et_hf_backscatter.yaml"), "-p", "rings=40"]
BLOCK = 4096
QUIET = dict(os.environ, STRAYTRACE_PYTHON="/bin/false")           # no pictures


def start(*words, **more):
    return subprocess.Popen([str(PROGRAM), *map(str, words)], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            env=QUIET, **more)


def ask(*words, code=0, **more):
    child = start(*words, **more)
    out, err = child.communicate(timeout=120)
    assert child.returncode == code, f"{words}: {child.returncode}\n{out}{err}"
    return out if code == 0 else err


def trace(out, *words, code=0, **more):
    return ask("trace", *SCENE, "-o", out, "--quiet", *words, code=code, **more)


def bits(file):
    """sha256 of all data and attributes except dates and times."""
    total = hashlib.sha256()

    def add(name, thing):
        if name.startswith("timing"):
            return
        total.update(name.encode())
        for key in sorted(thing.attrs):
            if key != "created":
                total.update(f"{key}={thing.attrs[key]!r}".encode())
        if isinstance(thing, h5py.Dataset):
            total.update(f"{thing.dtype}{thing.shape}".encode())
            total.update(thing[()].tobytes() if thing.shape != () else bytes(str(thing[()]), "utf8"))

    with h5py.File(file) as run:
        add("", run)
        run.visititems(add)
    return total.hexdigest()


def attributes(file):
    with h5py.File(file) as run:
        return dict(run.attrs)


def blocks(file):
    with h5py.File(file) as run:
        return int(run["energy_balance"].attrs["blocks"])
