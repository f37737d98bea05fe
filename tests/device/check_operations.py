#!/usr/bin/env python3
"""Fail when the compiler of devices makes of the engine an operation on numbers that the host does not do alike:
contracted, approximate, flushed to zero, from a library, or an atomic one on numbers.
Usage: check_operations.py ARCHITECTURE NVCC FLAG... SOURCE"""
import collections
import pathlib
import re
import subprocess
import sys
import tempfile

OPERATION = re.compile(r"^\s+(?:@!?%\w+ )?([a-z]\w*(?:\.\w+)*\.f(?:32|64)(?:\.\w+)*)\s", re.MULTILINE)
MOVES = {"mov", "ld", "st", "ldu", "selp", "setp", "set", "slct", "abs", "neg", "testp", "copysign"}
ROUNDED = {"add", "sub", "mul", "div", "sqrt", "rcp"}          # to nearest: one operation of IEEE 754 each
CONTROL = "\tfma.rn.f64 \t%fd3, %fd1, %fd2, %fd0;\n\tatom.global.add.f64 \t%fd4, [%rd1], %fd3;\n\tsin.approx.f32 \t%f1, %f0;\n"


def rejected(operation):
    name, *parts = operation.split(".")
    if "approx" in parts or "ftz" in parts or "full" in parts:
        return True
    if name in ROUNDED:
        return "rn" not in parts and name not in ("add", "sub", "mul")
    return name not in MOVES | {"min", "max", "cvt"}


def complaints(ptx):
    counts = collections.Counter(OPERATION.findall(ptx))
    found = [f"{count} of {name}" for name, count in counts.items() if rejected(name)]
    libraries = sorted(set(re.findall(r"__(?:nv|internal)_\w+", ptx)))
    return counts, found + [f"calls {name}" for name in libraries]


def main(architecture, *compiler):
    assert len(complaints(CONTROL)[1]) == 3, "the check does not see what it has to refuse"
    with tempfile.TemporaryDirectory() as folder:
        ptx = pathlib.Path(folder) / "engine.ptx"
        subprocess.run([*compiler[:-1], f"-arch=compute_{architecture}", "-ptx", "-o", ptx, compiler[-1]], check=True)
        counts, found = complaints(ptx.read_text())
    walk = sum(counts.values())
    if walk < 1000:
        found.append(f"only {walk} operations were found: is this the engine?")
    print("\n".join(found) or f"{walk} operations on numbers, all of IEEE 754")
    return 1 if found else 0


sys.exit(main(*sys.argv[1:]))
