#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes examples/data/bench.csv, by the formula of docs/reference/signal.md. Usage: make_bench_data.py FILE"""
import math
import random
import sys

RATE, SECONDS, START = 128, 32, 1234567890
RESONANCE, QUALITY, BURST_AT, BURST_HZ = 10.0, 5.0, 20.0, 28.0


def main(file):
    noise = random.Random(1)
    step = 1 / (16 * RATE)                     # the motion of the bench, in steps far below its period
    w = 2 * math.pi * RESONANCE
    x = v = 0.0
    rows = []
    ground = 0.0
    for i in range(RATE * SECONDS):
        t = i / RATE
        acceleration = 50 * noise.gauss(0, 1) + 30 * math.sin(2 * math.pi * 21.5 * t)
        burst = 400 * math.exp(-((t - BURST_AT) / 0.1) ** 2) * math.sin(2 * math.pi * BURST_HZ * t)
        ground = acceleration + burst          # um/s^2, held between samples
        rows.append((t, ground, x + 0.002 * noise.gauss(0, 1)))
        for _ in range(16):                    # x'' = -w^2 x - w/Q x' + a
            v += step * (ground - w * w * x - w / QUALITY * v)
            x += step * v
    with open(file, "w", encoding="utf-8") as out:
        out.write("# a bench on soft feet: accelerometer on the ground, displacement of the bench (made by a formula)\n")
        out.write("time [s],acc [um/s^2],bench [um]\n")
        for t, a, y in rows:
            out.write(f"{START + t:.7f},{a:.3f},{y:.5f}\n")


if __name__ == "__main__":
    sys.exit("usage: make_bench_data.py FILE") if len(sys.argv) != 2 else main(sys.argv[1])
