#!/usr/bin/python3
"""Draw the pictures of the pages of shapes and parts: section and front with dimensions, sketch. Usage: draw_shapes.py [ROOT]

Each shape is a list of patches (u, v) -> x, y, z; parts are given by their section. Dimensions bear the names of keys.
"""
import pathlib
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.patches import Arc  # noqa: E402

from pictures import ROUTE_COLOURS, small  # noqa: E402

BLUE, RED, GREEN = ROUTE_COLOURS[:3]
GREY = "#8a8f98"
U, V = np.meshgrid(np.linspace(0, 1, 61), np.linspace(0, 1, 121), indexing="ij")


def revolved(profile, turns=(0, 1)):
    """Patch of a profile s -> (height, radius)."""
    z, r = profile(U)
    angle = 2 * np.pi * (turns[0] + V * (turns[1] - turns[0]))
    return r * np.cos(angle), r * np.sin(angle), z + 0 * angle


def ring(r1, r2, z1=0, z2=0):
    return lambda s: (z1 + s * (z2 - z1), r1 + s * (r2 - r1))


def flat(outer, inner):
    """Plate between two outlines, angle -> radius."""
    angle = 2 * np.pi * V
    r = inner(angle) + U * (outer(angle) - inner(angle))
    return r * np.cos(angle), r * np.sin(angle), 0 * r


def regular(sides, radius, rotation=0):
    def outline(angle):
        part = 2 * np.pi / sides
        return radius * np.cos(part / 2) / np.cos((angle - rotation) % part - part / 2)
    return outline


def elliptic(a, b):
    return lambda angle: a * b / np.hypot(b * np.cos(angle), a * np.sin(angle))


def box(w, h, d):
    def face(fix, sign, size):
        patch = [None] * 3
        other = [i for i in range(3) if i != fix]
        patch[other[0]], patch[other[1]] = (U - 0.5) * size[other[0]], (V - 0.5) * size[other[1]]
        patch[fix] = sign * size[fix] / 2 + 0 * U
        return tuple(patch)
    return [face(i, s, (w, h, d)) for i in range(3) for s in (-1, 1)]


def pierced(radius, start, end, height, hole, count):
    x, y, z = revolved(lambda s: (start + s * (end - start), radius + 0 * s))
    angle = 2 * np.pi * V
    nearest = np.round(angle * count / (2 * np.pi)) * 2 * np.pi / count
    gone = (radius * np.sin(angle - nearest)) ** 2 + (z - height) ** 2 < hole ** 2
    return np.where(gone, np.nan, x), np.where(gone, np.nan, y), np.where(gone, np.nan, z)


def serrated(inner, outer, slope, depth, count):
    angle = 2 * np.pi * V
    part = angle * count / (2 * np.pi) % 1
    rim = inner + depth * (1 - np.abs(1 - 2 * part))
    r = rim + U * (outer - rim)
    return r * np.cos(angle), r * np.sin(angle), (r - inner) / slope


def teeth(inner, depth, count, phase=0):
    """Outline of the inner edge."""
    t = np.linspace(0, 2 * np.pi, 40 * count + 1)
    r = inner + depth * (1 - np.abs(1 - 2 * ((t - phase) * count / (2 * np.pi) % 1)))
    return r * np.cos(t), r * np.sin(t)


def cut(radius, start, end, slope):
    angle = 2 * np.pi * V
    z = start + U * (end + slope * radius * np.cos(angle) - start)
    return radius * np.cos(angle) + 0 * U, radius * np.sin(angle) + 0 * U, z


def sag(c, k, r):
    return c * r ** 2 / (1 + np.sqrt(1 - (1 + k) * c ** 2 * r ** 2))


def off_axis(c, centre, radius, hole):
    angle, r = 2 * np.pi * V, hole + (radius - hole) * U
    x, y = centre + r * np.cos(angle), r * np.sin(angle)
    return x, y, sag(c, -1, np.hypot(x, y))


def section(patch):
    """Points of a patch near the plane y = 0, as lines of the picture."""
    x, y, z = (np.asarray(a, float) for a in patch)
    scale = np.nanmax(np.abs([x, y, z]))
    return [(z[:, j], x[:, j]) for j in range(x.shape[1]) if np.nanmax(np.abs(y[:, j])) < 0.02 * scale] + \
           [(z[i, :], x[i, :]) for i in range(x.shape[0]) if np.nanmax(np.abs(y[i, :])) < 0.02 * scale]


def lines_of_box(w, d):
    return [([-d / 2, d / 2, d / 2, -d / 2, -d / 2], [-w / 2, -w / 2, w / 2, w / 2, -w / 2])]


SHAPES = {
    "disk": [revolved(ring(0.3, 1))],
    "cap": [revolved(lambda s: (sag(0.7, 0, 0.2 + 0.8 * s), 0.2 + 0.8 * s))],
    "cylinder": [revolved(lambda s: (0.6 + 2.4 * s, 0.6 + 0 * s))],
    "cone": [revolved(ring(0.5, 1, 0, 0.7))],
    "sphere": [revolved(lambda s: (-np.cos(np.pi * s), np.sin(np.pi * s)))],
    "conic": [off_axis(0.6, 0.9, 0.5, 0.15), revolved(lambda s: (sag(0.6, -1, 1.4 * s), 1.4 * s))],
    "rectangle": [flat(lambda a: 1 / np.maximum(np.abs(np.cos(a)), np.abs(np.sin(a)) / 0.6),
                       lambda a: 1 / np.maximum(np.abs(np.cos(a)) / 0.5, np.abs(np.sin(a)) / 0.3))],
    "ellipse": [flat(elliptic(1, 0.8), elliptic(0.7, 0.35))],
    "polygon": [flat(regular(6, 1, np.radians(21)), regular(4, 0.6, np.radians(51)))],
    "box": box(1, 0.7, 1.4),
    "torus": [revolved(lambda s: (0.3 * np.sin(2 * np.pi * s), 1 + 0.3 * np.cos(2 * np.pi * s)))],
    "pierced_cylinder": [pierced(0.6, 0.3, 2.3, 1.3, 0.25, 3)],
    "serrated_cone": [serrated(0.5, 1, 0.7, 0.16, 20)],
    "zone": [revolved(lambda s: (np.sin(-0.3 + 1.4 * s), np.cos(-0.3 + 1.4 * s)))],
    "cut_cylinder": [cut(0.6, 0.3, 1, 0.5)],
}


# Start, end and key of each dimension. In sections z runs to the right and x up; seen from the front, x to the right and y up.
IN_SECTION = {
    "disk": [((0.25, 0), (0.25, 0.3), "inner_radius"), ((0.12, 0), (0.12, 1), "outer_radius")],
    "cap": [((-0.15, 0), (-0.15, 0.2), "inner_radius"), ((0.6, 0), (0.6, 1), "outer_radius"), ((1 / 0.7, 0), (sag(0.7, 0, 0.75), -0.75), "1/curvature")],
    "cylinder": [((1.8, 0), (1.8, 0.6), "radius"), ((0, -0.85), (0.6, -0.85), "from"), ((0, -1.25), (3, -1.25), "to")],
    "cone": [((-0.15, 0), (-0.15, 0.5), "inner_radius"), ((0.9, 0), (0.9, 1), "outer_radius")],
    "sphere": [((0, 0), (0.71, 0.71), "radius")],
    "conic": [((1.05, 0), (1.05, 0.9), "decentre_x"), ((1.05, 0.9), (1.05, 1.4), "outer_radius"), ((0.1, 0.9), (0.1, 1.05), "inner_radius"),
              ((1 / 0.6, 0), (sag(0.6, -1, 0.75), -0.75), "1/curvature at the vertex")],
    "box": [((-0.7, -0.7), (0.7, -0.7), "depth")],
    "torus": [((0, 0), (0, 1), "major_radius"), ((0, 1), (0.3, 1), "minor_radius")],
    "pierced_cylinder": [((2, 0), (2, 0.6), "radius"), ((0, -0.85), (0.3, -0.85), "from"), ((0, -1.2), (1.3, -1.2), "hole_height"),
                         ((0, -1.55), (2.3, -1.55), "to"), ((1.3, 0.4), (1.55, 0.4), "hole_radius")],
    "serrated_cone": [((-0.15, 0), (-0.15, 0.5), "inner_radius"), ((0.9, 0), (0.9, 1), "outer_radius")],
    "zone": [((0, 0), (0.39, 0.92), "radius"), ((0, -1.1), (-0.296, -1.1), "from"), ((0, -1.3), (0.891, -1.3), "to")],
    "cut_cylinder": [((0.5, 0), (0.5, 0.6), "radius"), ((0, -0.8), (0.3, -0.8), "from"), ((0, -1.1), (1, -1.1), "to")],
}
IN_FRONT = {
    "rectangle": [((-1, -0.75), (1, -0.75), "width"), ((1.12, -0.6), (1.12, 0.6), "height"), ((-0.5, -0.12), (0.5, -0.12), "hole_width"),
                  ((0.38, -0.3), (0.38, 0.3), "hole_height")],
    "ellipse": [((0, -0.95), (1, -0.95), "semi_x"), ((1.12, 0), (1.12, 0.8), "semi_y"), ((0, 0), (0.7, 0), "hole_x"), ((0, 0), (0, 0.35), "hole_y")],
    "polygon": [((0, 0), (-np.cos(np.radians(21)), -np.sin(np.radians(21))), "radius"),
                ((0, 0), (0.6 * np.cos(np.radians(141)), 0.6 * np.sin(np.radians(141))), "hole_radius")],
    "conic": [((0, -0.15), (0.9, -0.15), "decentre_x"), ((0.9, 0), (0.9, 0.4), "decentre_y"), ((0.9, 0.4), (0.546, 0.754), "outer_radius"),
              ((0.9, 0.4), (0.9, 0.55), "inner_radius")],
    "pierced_cylinder": [],
    "box": [((-0.5, -0.5), (0.5, -0.5), "width"), ((0.65, -0.35), (0.65, 0.35), "height")],
    "serrated_cone": [((0, 0), (0.5, 0), "inner_radius"), ((0, 0), (-0.707, -0.707), "outer_radius"), ((0, 0.5), (0, 0.66), "tooth_depth")],
}
# Corner, first and last angle in deg, key, diameter of the arc.
ANGLES = {"cone": ((0, 0.5), 0, 35.5, "half_angle"), "serrated_cone": ((0, 0.5), 0, 35.5, "half_angle"), "cut_cylinder": ((1, 0), 63.4, 90, "tilt")}
FRONT_ANGLES = {"polygon": [((0, 0), 0, 21, "rotation", 2.4), ((0, 0), 0, 51, "hole_rotation", 0.8)],
                "serrated_cone": [((0, 0), 0, 10, "phase", 1.6)], "pierced_cylinder": [((0, 0), 0, 30, "hole_azimuth", 0.6)]}
# What no line shows.
NOTES = {"polygon": "sides: 6, hole_sides: 4", "serrated_cone": "teeth: 20", "pierced_cylinder": "holes: 3",
         "conic": "conic_constant, a4, a6, a8, a10: the curve"}


def circle(x, y, r, gaps=()):
    t = np.linspace(0, 2 * np.pi, 361)
    gone = [np.abs((np.degrees(t) - at + 180) % 360 - 180) < half for at, half in gaps]
    return x + np.where(np.any(gone, axis=0) if gone else False, np.nan, r * np.cos(t)), y + r * np.sin(t)


def outlines(name, patches):
    """Lines of a shape seen against its axis."""
    sizes = {"box": [(0.5, 0.35)], "rectangle": [(1, 0.6), (0.5, 0.3)]}.get(name)
    if name == "conic":
        return [circle(0.9, 0.4, 0.5), circle(0.9, 0.4, 0.15)]
    if name == "pierced_cylinder":
        return [circle(0, 0, 0.6, [(at, 24.6) for at in (30, 150, 270)])]
    if name == "serrated_cone":
        return [teeth(0.5, 0.16, 20, np.radians(10)), circle(0, 0, 1)]
    if sizes:
        return [([-x, x, x, -x, -x], [-y, -y, y, y, -y]) for x, y in sizes]
    return [(patches[0][0][i], patches[0][1][i]) for i in (0, -1)]


def draw_front(ax, name, patches):
    for x, y in outlines(name, patches):
        ax.plot(x, y, color=BLUE, lw=1.6)
    ax.plot(0, 0, "o", color=RED, ms=4)
    for given in IN_FRONT[name]:
        dimension(ax, *given)
    for given in FRONT_ANGLES.get(name, ()):
        angle(ax, *given)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title("from the front, x to the right, y up" + ("\n" + NOTES[name] if name in NOTES else ""), fontsize=10, loc="left")


def dimension(ax, start, end, name):
    """Arrow with both ends, and its key beside it."""
    ax.annotate("", end, start, annotation_clip=False, arrowprops={"arrowstyle": "<|-|>", "color": GREEN, "lw": 1, "shrinkA": 0, "shrinkB": 0})
    (a, b), (c, d) = start, end
    steep = abs(d - b) > abs(c - a)
    beside_axis = 0.3 * abs(d - b) * (steep and abs(b + d) < 1e-9)
    ax.text((a + c) / 2 + 0.03 * steep, (b + d) / 2 + 0.03 * (not steep) + beside_axis, name, color=GREEN, fontsize=8.5, family="monospace", va="center" if steep else "bottom",
            ha="left" if steep else "center", bbox={"fc": "white", "ec": "none", "alpha": 0.75, "pad": 0.4}, zorder=6)


def angle(ax, corner, first, last, name, size=0.9):
    for side in np.radians((first, last)):
        reach = max(0.75, 0.6 * size)
        ax.plot([corner[0], corner[0] + reach * np.cos(side)], [corner[1], corner[1] + reach * np.sin(side)], color=GREY, lw=0.8, ls="--")
    ax.add_patch(Arc(corner, size, size, theta1=first, theta2=last, color=GREEN, lw=1))
    middle = np.radians((first + last) / 2)
    ax.text(corner[0] + 0.55 * size * np.cos(middle), corner[1] + 0.55 * size * np.sin(middle), name, color=GREEN, fontsize=8.5, family="monospace",
            va="center", bbox={"fc": "white", "ec": "none", "alpha": 0.75, "pad": 0.4})


def leader(ax, tip, at, name):
    """Arrow from a key to the face that it is about."""
    ax.annotate(name, tip, at, color=GREEN, fontsize=8.5, family="monospace", ha="center", va="center", annotation_clip=False,
                arrowprops={"arrowstyle": "-|>", "color": GREEN, "lw": 1})


def arc(c, radius, z, sign=1, n=60):
    x = np.linspace(-radius, radius, n)
    return z + sign * (c * x ** 2 / (1 + np.sqrt(1 - (c * x) ** 2))), x


def glass(c1, c2, t, r=1.0):
    front, back = arc(c1, r, 0), arc(c2, r, -t, -1)
    return [front, back] + [([back[0][i], front[0][i]], [x, x]) for i, x in ((0, -r), (-1, r))]


def both(*points):
    z, x = zip(*points)
    return [(z, x), (z, [-a for a in x])]


BAFFLE = [((-0.25, 0), (-0.25, 0.6), "inner_radius"), ((0.8, 0), (0.8, 1), "outer_radius")]
CONE_ANGLE = [((0, 0.6), 0, 33.7, "half_angle", 1.0)]
WEDGE = {"thick_mirror": [((-0.55, -1), 90, 98.5, "wedge", 2.2)], "plate": [((-0.2, -1), 90, 98.5, "wedge", 2.2)]}
FRAME = [*both((0, 0.4), (0, 1)), *both((-0.4, 0.4), (-0.4, 1)), ([-0.4, 0], [0.4, 0.4]), ([-0.4, 0], [-0.4, -0.4]), ([-0.4, 0], [1, 1]),
         ([0.3, 0.3, -0.7, -0.7, 0.3], [-1, -1.25, -1.25, -1, -1])]
# Of each part: lines of its section, dimensions, leaders (tip, place, key), angles.
PARTS = {
    "mirror": ([arc(0.7, 1, 0)], [((0.6, 0), (0.6, 1), "radius"), ((1 / 0.7, 0), (sag(0.7, 0, 0.6), -0.6), "radius_of_curvature")], [], []),
    "lens": (glass(-0.5, -0.4, 0.8), [((0.4, -1), (0.4, 1), "diameter"), ((-0.8, -1.25), (0, -1.25), "thickness")],
             [((-0.09, 0.6), (0.7, 1.2), "radius_1"), ((-0.73, 0.6), (-1.4, 1.2), "radius_2")], []),
    "focal_lens": (glass(-0.9, 0, 0.9), [((0.4, -1), (0.4, 1), "diameter"), ((-0.9, -1.25), (0, -1.25), "thickness"),
                                          ((-2.47, -1.65), (0, -1.65), "focal_length")], [((-0.2, 0.65), (0.6, 1.25), "bending: 1")], []),
    "thick_mirror": ([arc(0.3, 1, 0), ([-0.55, -0.85], [-1, 1]), ([-0.55, 0.15], [-1, -1]), ([-0.85, 0.15], [1, 1])],
                     [((0.4, 0), (0.4, 1), "radius"), ((-0.7, -1.3), (0, -1.3), "thickness")], [((0.06, 0.65), (0.9, 1.2), "radius_of_curvature")],
                     WEDGE["thick_mirror"]),
    "flat_mirror": (glass(0, 0, 0.5), [((0.25, 0), (0.25, 1), "radius"), ((-0.5, -1.25), (0, -1.25), "thickness")], [], []),
    "plate": ([([0, 0], [-1, 1]), ([-0.2, -0.5], [-1, 1]), ([-0.2, 0], [-1, -1]), ([-0.5, 0], [1, 1])],
              [((0.25, 0), (0.25, 1), "radius"), ((-0.35, -1.3), (0, -1.3), "thickness")], [], WEDGE["plate"]),
    "conical_baffle": (both((0, 0.6), (0.6, 1), (0.5, 1), (-0.1, 0.6), (0, 0.6)), BAFFLE, [((0.3, -0.83), (0.2, -1.3), "thickness, along the axis")], CONE_ANGLE),
    "serrated_baffle": (both((0, 0.6), (0.6, 1)), BAFFLE, [], CONE_ANGLE),
    "chamber": ([*lines_of_box(1.6, 2), *lines_of_box(1.8, 2.2)], [((-0.55, -0.8), (-0.55, 0.8), "width"), ((-1, -0.45), (1, -0.45), "depth")],
                [((0.4, 0.85), (0.9, 1.25), "wall")], []),
    "tube_section": (both((0, 0.8), (0, 0.9), (-2, 0.9), (-2, 0.8), (0, 0.8)), [((-1.4, 0), (-1.4, 0.8), "radius"), ((-2, -1.15), (0, -1.15), "length")],
                     [((-0.6, 0.85), (-0.1, 1.25), "wall")], []),
    "dump": ([([0, -2, 0], [0.6, 0, -0.6])], [((0.25, -0.6), (0.25, 0.6), "height"), ((-2, -0.85), (0, -0.85), "depth")], [], []),
    "photodiode": ([*glass(0, 0, 0.15, 0.7), ([-0.5, -0.5], [-0.3, 0.3]), *both((-0.5, 0.3), (-0.5, 1), (0, 1), (0, 0.7))],
                   [((0.15, 0), (0.15, 0.7), "window_radius"), ((1.05, 0), (1.05, 1), "can_radius"), ((-0.15, -1.15), (0, -1.15), "window_thickness"),
                    ((-0.5, -1.4), (-0.15, -1.4), "gap")], [((-0.5, 0.2), (-1.1, 0.75), "sensor_radius")], []),
    "mount": (FRAME, [((0.5, -1), (0.5, 1), "size"), ((-0.4, 1.15), (0, 1.15), "thickness"), ((-0.2, 0), (-0.2, 0.4), "aperture"),
                      ((-0.85, -1.25), (-0.85, -1), "base_height"), ((-0.7, -1.5), (0.3, -1.5), "base_depth")], [], []),
    "motor_mount": (FRAME + both((-0.4, 0.5), (-1.9, 0.5), (-1.9, 1), (-0.4, 1)),
                    [((-1.9, 1.15), (-0.4, 1.15), "motor_length"), ((-2.05, 0.5), (-2.05, 1), "motor_width")], [], []),
}
UPWARDS = {"dump": "y", "mount": "y", "motor_mount": "y"}     # otherwise x
# From the front: lines, dimensions, words.
PART_FRONTS = {
    "serrated_baffle": ([teeth(0.6, 0.16, 20), circle(0, 0, 1)], [((0, 0), (-0.6, 0), "inner_radius"), ((0, 0.6), (0, 0.76), "tooth_depth")], "teeth: 20"),
    "chamber": (lines_of_box(1.6, 2)[:1] + lines_of_box(1.8, 2.2), [((-1, -0.45), (1, -0.45), "width"), ((-0.55, -0.8), (-0.55, 0.8), "height")], ""),
    "dump": ([*lines_of_box(1.2, 1.4), ([-0.7, 0.7], [0, 0])], [((-0.7, -0.85), (0.7, -0.85), "width"), ((0.85, -0.6), (0.85, 0.6), "height")], ""),
    "motor_mount": ([*lines_of_box(2, 2), circle(0, 0, 0.4), ([-1, -0.5, -0.5, -1, -1], [0.5, 0.5, 1, 1, 0.5]), ([1, 0.5, 0.5, 1, 1], [-0.5, -0.5, -1, -1, -0.5])],
                    [((-1, 1.15), (-0.5, 1.15), "motor_width"), ((1.15, -1), (1.15, 1), "size")], "hand: right"),
}


def draw_section(ax, lines, title):
    for z, x in lines:
        ax.plot(z, x, color=BLUE, lw=1.6)
    ax.plot(0, 0, "o", color=RED, ms=4)
    z = np.concatenate([np.asarray(l[0], float) for l in lines] + [[0]])
    span = max(np.nanmax(z) - np.nanmin(z), 1)
    ax.annotate("", (np.nanmax(z) + 0.35 * span, 0), (np.nanmin(z) - 0.15 * span, 0), annotation_clip=False,
                arrowprops={"arrowstyle": "->", "color": GREY, "lw": 0.8})
    ax.text(np.nanmax(z) + 0.36 * span, 0, "facing", color=GREY, va="center")
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title(title, fontsize=10, loc="left")


def draw_sketch(ax, name, patches):
    for i, patch in enumerate(patches):
        thin = name == "conic" and i == 1                # the parent surface
        colour = GREY if thin else ROUTE_COLOURS[i // 2 % 3] if name == "box" else BLUE
        ax.plot_surface(patch[2], patch[0], patch[1], color=colour, alpha=0.12 if thin else 0.55, linewidth=0, antialiased=True,
                        rcount=2 if name == "box" else 40, ccount=2 if name == "box" else 120)
    points = np.concatenate([np.stack([np.ravel(p[2]), np.ravel(p[0]), np.ravel(p[1])]) for p in patches], axis=1)
    ax.set_box_aspect(np.maximum(np.nanmax(points, 1) - np.nanmin(points, 1), 0.05))
    ax.view_init(22, -60)
    ax.set_axis_off()


def draw_shape(name, patches, folder):
    front, dimensioned = name in IN_FRONT, name in IN_SECTION
    count = 1 + front + (dimensioned or not front)
    fig = plt.figure(figsize=(4 * count if count == 2 else 10.5, 3.4), dpi=96)
    place = 1
    if dimensioned or not front:
        ax = fig.add_subplot(1, count, place)
        draw_section(ax, [line for p in patches for line in section(p)], f"{name}: section y = 0")
        for given in IN_SECTION.get(name, ()):
            dimension(ax, *given)
        if name in ANGLES:
            angle(ax, *ANGLES[name])
        place += 1
    if front:
        draw_front(fig.add_subplot(1, count, place), name, patches)
        place += 1
    draw_sketch(fig.add_subplot(1, count, place, projection="3d"), name, patches)
    fig.tight_layout()
    with tempfile.TemporaryDirectory() as whole:
        fig.savefig(f"{whole}/shape.png")
        small(f"{whole}/shape.png", folder / f"{name}.png", colours=64)
    plt.close(fig)


def draw_part(ax, name):
    lines, dimensions, leaders, angles = PARTS[name]
    if name == "focal_lens":
        for x in (-0.7, 0.7):
            ax.plot([0.9, -0.25, -2.47], [x, x, 0], color=GREY, lw=0.8)
    draw_section(ax, lines, "")
    ax.set_title(f"{name} ({UPWARDS.get(name, 'x')} up)", fontsize=10, loc="left", pad=26)
    for given in dimensions:
        dimension(ax, *given)
    for given in leaders:
        leader(ax, *given)
    for given in angles:
        angle(ax, *given)


def draw_part_front(ax, name):
    lines, dimensions, words = PART_FRONTS[name]
    for x, y in lines:
        ax.plot(x, y, color=BLUE, lw=1.6)
    ax.plot(0, 0, "o", color=RED, ms=4)
    for given in dimensions:
        dimension(ax, *given)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_title("from the front" + (f", {words}" if words else ""), fontsize=10, loc="left", pad=26)


def draw_parts(path):
    panels = [(draw, name) for name in PARTS for draw in [draw_part] + [draw_part_front] * (name in PART_FRONTS)]
    fig, axes = plt.subplots(-(-len(panels) // 3), 3, figsize=(10.5, 17), dpi=96)
    for ax in axes.flat[len(panels):]:
        ax.set_axis_off()
    for ax, (draw, name) in zip(axes.flat, panels):
        draw(ax, name)
    fig.tight_layout()
    with tempfile.TemporaryDirectory() as whole:
        fig.savefig(f"{whole}/parts.png")
        small(f"{whole}/parts.png", path, colours=64)
    plt.close(fig)


def main(root):
    folder = root / "docs" / "reference" / "shapes"
    for name, patches in SHAPES.items():
        draw_shape(name, patches, folder)
    draw_parts(root / "docs" / "reference" / "parts.png")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve())
