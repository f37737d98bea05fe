# SPDX-License-Identifier: BSD-3-Clause
"""Draws a search: python3 -m straytrace.plots.optimise optimise.json -o optimise.png"""

import sys

import matplotlib.pyplot as plt
import numpy as np

from .style import GREY, LIGHT, ROUTE_COLOURS, draw_file


def number(x):
    return np.nan if x is None else x


def deciding(candidate):
    """Ratio, its error and upper limit, of the limit with the least room."""
    limits = [limit for limit in candidate["limits"] if limit["upper"] is not None]
    if not limits:
        return np.nan, np.nan, np.nan
    worst = max(limits, key=lambda limit: limit["upper"])
    return number(worst["ratio"]["value"]), number(worst["ratio"]["sigma"]), worst["upper"]


def draw(found):
    traced = [c for c in found["candidates"] if c["traced"] and c["objective"] is not None]
    cost = np.array([c["objective"] for c in traced])
    ratio, sigma, upper = (np.array(column) for column in zip(*map(deciding, traced))) if traced else (np.array([]),) * 3
    met, front = (np.array([c[key] for c in traced], dtype=bool) for key in ("met", "front"))
    figure, axes = plt.subplots(figsize=(9, 6), dpi=100)
    for chosen, face, label in ((met, ROUTE_COLOURS[0], "meets the limits"), (~met, "white", "does not")):
        axes.errorbar(cost[chosen], ratio[chosen], yerr=[np.zeros(chosen.sum()), (upper - ratio)[chosen]], fmt="o",
                      color=ROUTE_COLOURS[0], mfc=face, capsize=3, label=label)
    order = np.argsort(cost[front])
    axes.step(cost[front][order], ratio[front][order], where="post", color=GREY, lw=1, label="front")
    for k, final in enumerate(found["finalists"]):
        value, _, top = deciding(final)
        best = k == found["best"]
        axes.errorbar([final["objective"]], [value], yerr=[[0], [top - value]], fmt="D", capsize=3,
                      color=ROUTE_COLOURS[1 if best else 2], label="best, fresh seed" if best else "fresh seed")
    if found["limits"]:
        axes.axhline(1, color=GREY, lw=1.5, ls=(0, (6, 2)))
    axes.set_xlabel("h over the line" if found["minimise"] == "h_total" else f"cost: {found['minimise']}")
    axes.set_ylabel("largest h over its limit")
    if len(ratio) and np.nanmin(ratio) > 0 and np.nanmax(ratio) > 8 * np.nanmin(ratio):
        axes.set_yscale("log")
    axes.grid(True, which="major", color=LIGHT, lw=0.7)
    title = f"{found['model']}: {len(traced)} candidates; bars: up to the upper limit with the stated confidence"
    axes.set_title(title if found["complete"] else title + " (stopped)", fontsize=10)
    axes.legend(fontsize=9)
    figure.tight_layout()
    return figure


def main(arguments=None):
    return draw_file(arguments, "optimise", "Draws a search.", "optimise.json of straytrace optimise", draw)


if __name__ == "__main__":
    sys.exit(main())
