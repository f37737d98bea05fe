#!/usr/bin/env python3
"""Write the synthetic records that the documents run `straytrace couple` on. Usage: couple_examples.py [--check] [FOLDER]

Records of strain H and a witness, from formulas with known truth (docs/reference/couple.md, "Example data"). --check: compare
with the files there and fail where they differ.
"""
import math
import pathlib
import random
import sys

FOLDER = pathlib.Path(__file__).parents[2] / "examples" / "data"
WAVELENGTH = 1064e-9


def resonant(drive, rate, hz, tau):
    """A mode that rings at hz and dies in tau, hit by the drive: amplitude 1 for one sample of 1."""
    radius, turn = math.exp(-1 / (tau * rate)), 2 * math.pi * hz / rate
    out = [0.0, 0.0]
    for x in drive:
        out.append(x + 2 * radius * math.cos(turn) * out[-1] - radius ** 2 * out[-2])
    return out[2:]


def record(rate, names, columns):
    rows = [f"{i / rate:g}," + ",".join(f"{column[i]:.3g}" for column in columns) for i in range(len(columns[0]))]
    return "\n".join(["time [s]," + names, *rows]) + "\n"


def noise(draw, count, rms):
    return [draw.gauss(0, rms) for _ in range(count)]


def added(*columns):
    return [sum(values) for values in zip(*columns)]


def shaken():
    """50 Hz, 24 s quiet and 24 s of band noise: ACC white, 1 and 40 um/s^2 rms; H = 4e-22 of a mode at 12 Hz."""
    draw, rate = random.Random(1), 50
    acc = noise(draw, 24 * rate, 1) + noise(draw, 24 * rate, 40)
    strain = added([4e-22 * y for y in resonant(acc, rate, 12, 0.15)], noise(draw, len(acc), 1e-20))
    return record(rate, "ACC [um/s^2],H [1]", [acc, strain])


TAPS = (("tower", 8, "soft", 20, 1), ("link", 14, "soft", 10, 2), ("bench", 20, "soft", 20, 0.2), ("link", 26, "hard", 25, 2))


def taps():
    """100 Hz, 8 s quiet, then 6 s at each place: an impulse each 2 s; a mode at 31 Hz that dies in 0.3 s; link couples most."""
    draw, rate = random.Random(2), 100
    force, heard = [0.0] * (32 * rate), [0.0] * (32 * rate)
    for _, start, _, newton, factor in TAPS:
        for impulse in range(3):
            at, strength = int((start + 0.3 + 1.9 * impulse) * rate), newton * draw.uniform(0.7, 1.4)
            force[at] = strength
            heard[at] = factor * strength
    strain = added([1e-21 * y for y in resonant(heard, rate, 31, 0.3)], noise(draw, len(heard), 1e-21))
    return record(rate, "HAMMER [N],H [1]", [added(force, noise(draw, len(force), 0.1)), strain])


def tap_list():
    return "place,start,duration,strength\n" + "".join(f"{name},{start},6,{how}\n" for name, start, how, _, _ in TAPS)


def shaker():
    """100 Hz: a line at 10 Hz, 20 to 200 nm in ten steps of 2 s, then 100 nm for 8 s, seen with 0.1 nm of noise; H = 1e-20 sin(0.5 + 4 pi x/lambda)."""
    draw, rate = random.Random(3), 100
    peak = [20e-9 * (1 + i // (2 * rate)) if i < 20 * rate else 100e-9 for i in range(28 * rate)]
    drive = [a * math.sin(2 * math.pi * 10 * i / rate) for i, a in enumerate(peak)]
    seen = added([1e9 * x for x in drive], noise(draw, len(drive), 0.1))
    strain = added([1e-20 * math.sin(0.5 + 4 * math.pi * x / WAVELENGTH) for x in drive], noise(draw, len(drive), 5e-22))
    return record(rate, "DRIVE [nm],H [1]", [seen, strain])


def sweep():
    """100 Hz, 16 s: sound from 10 to 42 Hz at 2 Hz/s, 0.05 Pa peak; H = 5e-20/Pa of a mode at 25 Hz that dies in 0.1 s."""
    draw, rate = random.Random(4), 100
    sound = [0.05 * math.sin(2 * math.pi * (10 * t + t * t)) for t in (i / rate for i in range(16 * rate))]
    strain = added([5e-20 * y for y in resonant(sound, rate, 25, 0.1)], noise(draw, len(sound), 1e-21))
    return record(rate, "MIC [Pa],H [1]", [added(sound, noise(draw, len(sound), 1e-4)), strain])


FILES = {"shaken.csv": shaken, "taps.csv": taps, "tap_list.csv": tap_list, "shaker.csv": shaker, "sweep.csv": sweep}


def main(words):
    check = "--check" in words
    places = [word for word in words if not word.startswith("--")]
    folder = pathlib.Path(places[0]) if places else FOLDER
    wrong = []
    for name, make in FILES.items():
        if check and (folder / name).read_text(encoding="utf-8") != make():
            wrong.append(name)
        elif not check:
            (folder / name).write_text(make(), encoding="utf-8")
    print(f"not what the formulas give: {', '.join(wrong)}" if wrong else f"{len(FILES)} example records")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
