#!/usr/bin/env python3
"""Write examples/data/swinging_baffle.hdf5: h(t) with fringe noise, and the motion behind it. Needs numpy and h5py.

Usage: make_fringe_example.py FILE

  x(t) = 4 um sin(2 pi 1.14 Hz t + 0.3) + 0.3 um sin(2 pi 0.31 Hz t + 1)          at 32 Hz, unit m
  h(t) = 2e-21 sin(1.1 + 1.3 (4 pi/1064 nm) x(t)) + noise                          at 256 Hz, strain
  noise: white, 2e-23 /sqrt(Hz), and 1/f below 30 Hz

t runs for 40 s from GPS 1187000000. The witness reads 4 um; what moves the light is 1.3 times that, 5.2 um: bump at 70 Hz.
"""
import sys

import h5py
import numpy as np

START, SECONDS = 1187000000, 40


def motion(t):
    return 4e-6 * np.sin(2 * np.pi * 1.14 * t + 0.3) + 0.3e-6 * np.sin(2 * np.pi * 0.31 * t + 1)


def noise(n, rate):
    rng = np.random.default_rng(20170811)
    lines = np.fft.rfft(rng.standard_normal(n))
    hz = np.fft.rfftfreq(n, 1 / rate)
    asd = 2e-23 * np.sqrt(1 + (30 / np.maximum(hz, 1)) ** 2)
    return np.fft.irfft(lines * asd * np.sqrt(rate / 2), n)


def main():
    t = np.arange(256 * SECONDS) / 256
    h = 2e-21 * np.sin(1.1 + 1.3 * 4 * np.pi / 1064e-9 * motion(t)) + noise(t.size, 256)
    with h5py.File(sys.argv[1], "w") as file:
        for name, unit, rate, samples in (("h", "strain", 256, h), ("x", "m", 32, motion(np.arange(32 * SECONDS) / 32))):
            data = file.create_dataset(name, data=samples)
            for key, value in (("name", name), ("unit", unit), ("x0", float(START)), ("dx", 1 / rate), ("xunit", "s")):
                data.attrs[key] = value


main()
