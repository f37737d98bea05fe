#!/usr/bin/env python3
"""Write examples/data/bump_quiet.hdf5 and bump_shaken.hdf5: a bump at 70 Hz in h(t), its witnesses in counts, and a shaken stretch. Needs numpy, h5py.

Usage: make_bump_example.py FOLDER

  x(t) = slow(t) + ring(t), slow: microseism around 0.2 Hz, 2 um rms; ring: 4.2 nm rms around 70 Hz (2.8 Hz wide)
  h(t) = 4.5e-21 sin(0.7 + (4 pi/1064 nm) x(t)) + noise              at 256 Hz, strain
  noise: 4e-24 /sqrt(Hz), 1.2e-23 (30 Hz/f)^2 and 2e-22 (10 Hz/f)^6, in squares
  ACC_LINK: x'' in counts of 2 um/s^2, at 256 Hz; SEIS: slow' in counts of 2 nm/s, at 16 Hz
  ACC_BENCH: another bench, 2 nm rms around 83 Hz and a twentieth of ring(t), in counts of 2 um/s^2, at 256 Hz

Quiet: 192 s from GPS 1400000000. Shaken: 64 s from 1400001000, with ring(t) and 21 nm rms from 68 to
72 Hz, of which the bench again feels a twentieth.
"""
import sys

import h5py
import numpy as np

RATE, G, WAVELENGTH = 256, 4.5e-21, 1064e-9


def drawn(rng, n, shape, rms=None):
    """Gaussian series with the amplitude spectrum shape(f), of this rms, or with shape as its one-sided ASD."""
    hz = np.fft.rfftfreq(n, 1 / RATE)
    x = np.fft.irfft(np.fft.rfft(rng.standard_normal(n)) * shape(np.maximum(hz, hz[1])) * np.sqrt(RATE / 2), n)
    return x if rms is None else x * rms / x.std()


def peak(centre, width):
    return lambda f: np.exp(-((f - centre) / width) ** 2)


def derivative(x, times):
    hz = np.fft.rfftfreq(x.size, 1 / RATE)
    return np.fft.irfft(np.fft.rfft(x) * (2j * np.pi * hz) ** times, x.size)


def noise(f):
    f = np.maximum(f, 4)
    return np.sqrt(4e-24**2 + (1.2e-23 * (30 / f) ** 2) ** 2 + (2e-22 * (10 / f) ** 6) ** 2)


def stretch(group, rng, start, seconds, shaken):
    n = seconds * RATE
    slow = drawn(rng, n, peak(0.2, 0.06), 2e-6)
    fast = drawn(rng, n, peak(70, 1.4), 4.2e-9)
    if shaken:
        fast += drawn(rng, n, lambda f: (f >= 68) & (f <= 72), 21e-9)
    h = G * np.sin(0.7 + 4 * np.pi / WAVELENGTH * (slow + fast)) + drawn(rng, n, noise)
    bench = drawn(rng, n, peak(83, 1.0), 2e-9) + fast / 20
    counts = lambda x, unit, own: np.round(x / unit + own * rng.standard_normal(x.size))
    every = RATE // 16
    for name, unit, rate, x in (
        ("H", "strain", RATE, h.astype("f4")),
        ("ACC_LINK", "ct", RATE, counts(derivative(slow + fast, 2), 2e-6, 3).astype("i2")),
        ("ACC_BENCH", "ct", RATE, counts(derivative(bench, 2), 2e-6, 3).astype("i2")),
        ("SEIS", "ct", 16, counts(derivative(slow, 1)[::every], 2e-9, 2).astype("i2")),
    ):
        data = group.create_dataset(name, data=x, compression="gzip", shuffle=True)
        for key, value in (("name", name), ("unit", unit), ("x0", float(start)), ("dx", 1 / rate), ("xunit", "s")):
            data.attrs[key] = value


def main():
    rng = np.random.default_rng(70)
    for name, start, seconds in (("quiet", 1400000000, 192), ("shaken", 1400001000, 64)):
        with h5py.File(f"{sys.argv[1]}/bump_{name}.hdf5", "w") as file:
            stretch(file, rng, start, seconds, name == "shaken")


main()
