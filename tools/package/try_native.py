#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the library inside Python with the command, in a package that is being tested. Usage: try_native.py MODEL RUN yes|no

RUN is what the command made of MODEL. "no": the C library of this system is too old, and the package says so."""
import sys

import numpy as np
import straytrace
from straytrace import native


def main(model, run, expected):
    if native.available() != (expected == "yes"):
        native._library()                              # says why
        sys.exit("try_native: the library can be loaded, although this system was taken to be too old")
    if expected == "no":
        try:
            native.Model(model)
        except straytrace.InputError as error:
            print("native: not here:", str(error).splitlines()[0])
        return
    wanted = straytrace.open(run)
    light = native.Model(model).trace(histories=wanted.histories)
    noise = light.noise()
    np.testing.assert_array_equal(noise.asd, wanted.noise.total.mean)
    np.testing.assert_array_equal(noise.sigma, wanted.noise.total.sigma)
    assert not np.array_equal(light.noise(set=["baffle=x2"]).asd, noise.asd)           # negative control
    print("native: the bits of the command in", noise.asd.size, "bins")


main(*sys.argv[1:])
