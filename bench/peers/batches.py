# SPDX-License-Identifier: BSD-3-Clause
"""Shared by all programs that run in Python: independent batches until the processor time is spent, and their mean and error."""
import argparse
import json
import math
import time

FEWEST = 16                                              # batches; with fewer the error itself is not known


def words(doc):
    parser = argparse.ArgumentParser(description=doc)
    parser.add_argument("problem")
    parser.add_argument("--seconds", type=float, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", default=".", help="for files of the problem")
    parser.add_argument("--way", default="")
    return parser.parse_args()


def mean_and_error(values):
    mean = math.fsum(values) / len(values)
    square = math.fsum((v - mean) ** 2 for v in values) / (len(values) - 1)
    return mean, math.sqrt(square / len(values))


def size_for(batch, seconds, seed, most):
    """Paths per batch, so that twice the fewest batches fill the time. Each size runs twice: the first run may compile."""
    size = 1
    while True:
        batch(seed, size)
        start = time.process_time()
        batch(seed + 1, size)
        spent = time.process_time() - start
        if spent > 0.02 * seconds or size >= most:
            return min(most, max(1, int(size * seconds / (2 * FEWEST) / spent)))
        size *= 2


def run(batch, seconds, seed, most=1 << 26):
    """batch(seed, paths) -> (value, rays or None). What comes before the batches that are used counts as set-up."""
    first = seed * 1000003
    size = size_for(batch, seconds, first, most)
    batch(first + 2, size)
    start, values, rays = time.process_time(), [], 0
    while len(values) < FEWEST or time.process_time() - start < seconds:
        value, n = batch(first + 3 + len(values), size)
        values.append(value)
        rays += n or 0
    mean, error = mean_and_error(values)
    print(json.dumps({"value": mean, "error": error, "seconds": time.process_time() - start, "setup": start,
                      "paths": size * len(values), "rays": rays or None}))
