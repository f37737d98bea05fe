# SPDX-License-Identifier: BSD-3-Clause
"""Names next to their objects, where they hide the least."""

import numpy as np

FONT = 7.5       # points
COLOUR = "#404040"
AROUND = np.deg2rad(np.arange(0, 360, 22.5))
FAR = (4, 10, 18, 30, 46)     # pixels between an outline and its name
STEP = 3.0       # pixels between the points by which lines count


def along(line):
    """Points on a line in pixels, closer than STEP."""
    pieces = [line[:1]]
    for a, b in zip(line[:-1], line[1:]):
        count = int(np.clip(np.hypot(*(b - a)) / STEP, 1, 2000))
        pieces.append(a + (b - a) * np.linspace(0, 1, count + 1)[1:, None])
    return np.vstack(pieces)


def inside(points, box):
    return np.count_nonzero(((points > box[0]) & (points < box[1])).all(axis=1))


def best_box(ring, size, frame, lines, taken):
    """Lower left and upper right corner in pixels of a box of this size outside the outline: it covers few lines, no
    other name, and is near."""
    low, high = ring.min(axis=0), ring.max(axis=0)
    low, high = np.maximum(low, frame[0]), np.minimum(high, frame[1])   # of walls, what is in sight
    middle, half = (low + high) / 2, (high - low) / 2 + size / 2
    best = None
    for gap in FAR:
        for angle in AROUND:
            way = np.array([np.cos(angle), np.sin(angle)])
            centre = middle + way * np.min((half + gap) / np.maximum(np.abs(way), 1e-9))
            box = np.array([centre - size / 2, centre + size / 2])
            cost = gap + 6 * inside(lines, box + [[-2, -2], [2, 2]])
            cost += 2000 * sum((box[0] < o[1]).all() and (box[1] > o[0]).all() for o in taken)
            cost += 500 * ((box[0] < frame[0]).any() or (box[1] > frame[1]).any())
            if best is None or cost < best[0]:
                best = (cost, box)
    return best[1]


def place_labels(axes, outlines, lines):
    """Writes each name next to its outline, with a thin line to it when it is further away. Outlines and lines in data
    coordinates; the limits of the axes must be set."""
    figure = axes.figure
    figure.canvas.draw()
    to_pixels, frame = axes.transData.transform, axes.get_window_extent().get_points()
    rings = {name: to_pixels(ring) for name, ring in outlines.items()}
    covered = np.vstack([along(to_pixels(line)) for line in lines] + [along(ring) for ring in rings.values()])
    per_point, taken = figure.dpi / 72, []
    for name, ring in sorted(rings.items(), key=lambda item: np.ptp(item[1], axis=0).max()):
        if (ring.max(axis=0) < frame[0]).any() or (ring.min(axis=0) > frame[1]).any():
            continue
        size = np.array([0.58 * FONT * len(name), 1.25 * FONT]) * per_point
        box = best_box(ring, size, frame, covered, taken)
        taken.append(box)
        centre, nearest = box.mean(axis=0), np.clip(box.mean(axis=0), ring.min(axis=0), ring.max(axis=0))
        apart = np.max(np.abs(centre - nearest) - size / 2) > 8
        back = axes.transData.inverted().transform
        axes.annotate(name, back(nearest), xytext=back(centre), ha="center", va="center", fontsize=FONT, color=COLOUR,
                      zorder=6, arrowprops={"arrowstyle": "-", "color": "#909090", "lw": 0.6, "shrinkA": 1} if apart else None)
