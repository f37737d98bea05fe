# SPDX-License-Identifier: BSD-3-Clause
"""straytrace, as benchmarks of whole problems run it."""
from agreement import Turn
from record import QUIET, child

BLOCK = 4096


class Ours:
    """A turn of straytrace with its defaults, each with another seed. Sampling time is what more histories take; the rest is set-up.

    The value is that of the first receiver over `power`, which the lamp emits.
    """

    def __init__(self, words, scene, core, power):
        self.words, self.scene, self.core, self.power, self.seed, self.histories = words, scene, core, power, 0, 0

    def trace(self, histories):
        run = self.scene.with_suffix(".h5")
        run.unlink(missing_ok=True)
        self.seed += 1
        done = child([self.words.program, "trace", self.scene, "-o", run, "--threads", 1, "--seed", self.seed,
                      "--histories", histories], core=self.core, env=QUIET)
        return done, run

    def __call__(self):
        import h5py
        short, _ = self.trace(BLOCK)
        if not self.histories:
            pilot, _ = self.trace(17 * BLOCK)
            each = max(1e-3, pilot.cpu - short.cpu) / 16
            self.histories = BLOCK * (1 + max(32, round(self.words.seconds / each)))
        done, run = self.trace(self.histories)
        with h5py.File(run) as file:
            value, error = (float(file["receivers"][key][0]) / self.power for key in ("mean", "std_error"))
        rays = int(next(line for line in done.output.splitlines() if " rays, " in line).split(" surface events, ")[1].split()[0])
        seconds = (done.cpu - short.cpu) * self.histories / (self.histories - BLOCK)
        return Turn(value, error, seconds, done.cpu - seconds, self.histories, rays, done.peak_memory)
