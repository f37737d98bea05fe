# SPDX-License-Identifier: BSD-3-Clause
"""Which input decides the noise of a run: elasticities, shares of the input band, what to measure next."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas

Array = npt.NDArray[np.float64]


@dataclass
class SensitiveInput:
    """What h depends on, and how far."""

    name: str                     # "material steel", "motion of tube", "interferometer.mirror_mass", "rim"
    kind: str                     # "strength", "shape", "motion", "response", "traced"
    value: str                    # as in the scene
    method: str                   # in words
    elasticity: Array             # [n] d ln h/d ln p; NaN: not known
    sigma: Array                  # [n] of it, one standard error (Monte Carlo); 0: exact
    factor: float                 # stated uncertainty, one sigma of the logarithm as a factor; 1: none
    bracket: tuple[float, float]  # stated range, ratios to the value; (1, 1): none
    share: Array                  # [n] of the variance of ln h by all stated standard deviations; NaN: it states none
    narrowing: Array              # [n] of the band with half its standard deviation, relative; NaN: it states none
    step: float = float("nan")    # traced: of the logarithm, to either side
    # [n] Traced with a chosen step: Richardson's value from it and its double, a check of `elasticity`.
    extrapolated: Array | None = None


@dataclass
class Sensitivity:
    """The inputs of a run, largest elasticity first."""

    frequency: Array             # [n] Hz, geometric centres of bins
    inputs: list[SensitiveInput]
    without_effect: list[str]
    band: Array                  # [n] standard deviation of ln h by the stated ones
    sampled: npt.NDArray[np.bool_]  # [n] band and shares are sampled, because first order fails
    next: str                    # the sentence that follows
    warnings: list[str]

    def table(self, hz: float = 10.0) -> pandas.DataFrame:
        """One row per input at the bin nearest to `hz` [Hz]: class, value, elasticity, its error, stated factor, share."""
        import pandas
        i = int(np.argmin(np.abs(np.log(self.frequency / hz))))
        return pandas.DataFrame([{"input": s.name, "class": s.kind, "value": s.value, "elasticity": s.elasticity[i], "sigma": s.sigma[i],
                                  "one_sigma_factor": s.factor, "share": s.share[i]} for s in self.inputs]).set_index("input")


def sensitivity_from(answer: dict[str, Any]) -> Sensitivity:
    """From the JSON of `straytrace sensitivity`."""
    n = len(answer["frequency"])

    def curve(values: list[float | None]) -> Array:
        return np.array([np.nan if v is None else v for v in values] or [np.nan] * n)

    inputs = [SensitiveInput(s["name"], s["class"], s["value"], s["method"], curve(s["elasticity"]), curve(s["elasticity_sigma"]),
                             s["one_sigma_factor"], (s["bracket"][0], s["bracket"][1]), curve(s["share"]),
                             curve(s["narrowing"]), s.get("step", float("nan")), curve(s["extrapolated"]) if "extrapolated" in s else None)
              for s in answer["inputs"]]
    return Sensitivity(curve(answer["frequency"]), inputs, answer["without_effect"], curve(answer["band"]),
                       np.array(answer["sampled"]), answer["next"], answer["warnings"])
