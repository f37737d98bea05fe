# SPDX-License-Identifier: BSD-3-Clause
"""When a figure of merit may be compared: only where both ways give the same value, within their errors."""
import dataclasses
import math
import statistics

MOST_APART = 4                                           # standard errors of the difference
WORST = 0.5                                              # relative error above which a value is useless


@dataclasses.dataclass(frozen=True)
class Turn:
    """One run: mean and standard error of the requested quantity, processor seconds of sampling and before it, paths and rays per run."""
    value: float
    error: float
    seconds: float
    setup: float
    paths: int
    rays: int = None
    peak_memory: int = 0

    @property
    def merit(self):
        """1/(relative error^2 x seconds), 1/s; 0 where nothing was found."""
        return (self.value / self.error) ** 2 / self.seconds if self.error > 0 else 0.0


def together(turns):
    """(mean, standard error) of turns of equal effort."""
    return statistics.fmean(t.value for t in turns), math.sqrt(math.fsum(t.error ** 2 for t in turns)) / len(turns)


def variance(turns):
    """Relative variance of one path, from all turns."""
    paths = math.fsum(t.paths for t in turns)
    value = math.fsum(t.value * t.paths for t in turns) / paths
    return math.fsum((t.error * t.paths / value) ** 2 for t in turns) / paths


def merit_of_all(turns, of_method=()):
    """Figure of merit of all turns as one run, 1/s: their median would be too good for rare large scores, which most turns miss. The
    variance of a path is the same in other variants of the method, whose turns (`of_method`, these among them) find it too."""
    _, error = together(turns)
    rate = sum(t.paths for t in turns) / math.fsum(t.seconds for t in turns)
    return rate / variance(of_method or turns) if error > 0 else 0.0


def apart(ours, theirs):
    """Distance of two lists of turns in standard errors of the difference."""
    (a, da), (b, db) = together(ours), together(theirs)
    return abs(a - b) / math.hypot(da, db) if da or db else math.inf * (a != b) if a != b else 0.0


def why_void(ours, theirs):
    """Why the two cannot be compared; "" if they can."""
    for who, turns in (("ours", ours), ("theirs", theirs)):
        value, error = together(turns)
        if not value > 0:
            return f"{who} found nothing"
        if not 0 < error < WORST * value:
            return f"{who} is not resolved: error {100 * error / value:.0f} %"
    far = apart(ours, theirs)
    return f"void: values are {far:.1f} standard errors apart" if far > MOST_APART else ""


def seconds_to_percent(turns, of_method=()):
    """Set-up and sampling until the error is 1 %."""
    merit = merit_of_all(turns, of_method)
    return statistics.median(t.setup for t in turns) + 1e4 / merit if merit > 0 else math.inf
