#!/usr/bin/python3
"""Draw the pictures of the pages of shapes and parts: meridional section and sketch. Usage: draw_shapes.py [ROOT]

Each shape is a list of patches (u, v) -> x, y, z; parts are given by their section.
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

BLUE, GREY, RED = "#1f5fa8", "#8a8f98", "#b8322a"
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


def pierced(radius, half, hole, count):
    x, y, z = revolved(lambda s: (half * (2 * s - 1), radius + 0 * s))
    angle = 2 * np.pi * V
    nearest = np.round(angle * count / (2 * np.pi)) * 2 * np.pi / count
    gone = (radius * np.sin(angle - nearest)) ** 2 + z ** 2 < hole ** 2
    return np.where(gone, np.nan, x), np.where(gone, np.nan, y), np.where(gone, np.nan, z)


def serrated(inner, outer, slope, depth, teeth):
    angle = 2 * np.pi * V
    part = angle * teeth / (2 * np.pi) % 1
    rim = inner + depth * (1 - np.abs(1 - 2 * part))
    r = rim + U * (outer - rim)
    return r * np.cos(angle), r * np.sin(angle), (r - inner) / slope


def cut(radius, start, end, slope):
    angle = 2 * np.pi * V
    z = start + U * (end + slope * radius * np.cos(angle) - start)
    return radius * np.cos(angle) + 0 * U, radius * np.sin(angle) + 0 * U, z


def sag(c, k, r):
    return c * r ** 2 / (1 + np.sqrt(1 - (1 + k) * c ** 2 * r ** 2))


def off_axis(c, centre, radius):
    angle = 2 * np.pi * V
    x, y = centre + radius * U * np.cos(angle), radius * U * np.sin(angle)
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
    "cap": [revolved(lambda s: (sag(0.7, 0, s), s))],
    "cylinder": [revolved(lambda s: (3 * s, 0.6 + 0 * s))],
    "cone": [revolved(ring(0.5, 1, 0, 0.7))],
    "sphere": [revolved(lambda s: (-np.cos(np.pi * s), np.sin(np.pi * s)))],
    "conic": [off_axis(0.6, 0.9, 0.5), revolved(lambda s: (sag(0.6, -1, 1.4 * s), 1.4 * s))],
    "rectangle": [flat(lambda a: 1 / np.maximum(np.abs(np.cos(a)), np.abs(np.sin(a)) / 0.6),
                       lambda a: 1 / np.maximum(np.abs(np.cos(a)) / 0.5, np.abs(np.sin(a)) / 0.3))],
    "ellipse": [flat(elliptic(1, 1), elliptic(0.7, 0.35))],
    "polygon": [flat(regular(6, 1), regular(6, 0.6))],
    "box": box(1, 0.7, 1.4),
    "torus": [revolved(lambda s: (0.3 * np.sin(2 * np.pi * s), 1 + 0.3 * np.cos(2 * np.pi * s)))],
    "pierced_cylinder": [pierced(0.6, 1, 0.25, 3)],
    "serrated_cone": [serrated(0.5, 1, 0.7, 0.12, 24)],
    "zone": [revolved(lambda s: (np.sin(-0.3 + 1.4 * s), np.cos(-0.3 + 1.4 * s)))],
    "cut_cylinder": [cut(0.6, 0, 1, 0.5)],
}


def arc(c, radius, z, sign=1, n=60):
    x = np.linspace(-radius, radius, n)
    return z + sign * (c * x ** 2 / (1 + np.sqrt(1 - (c * x) ** 2))), x


def glass(c1, c2, t, r=1.0):
    front, back = arc(c1, r, 0), arc(c2, r, -t, -1)
    return [front, back] + [([back[0][i], front[0][i]], [x, x]) for i, x in ((0, -r), (-1, r))]


def both(*points):
    z, x = zip(*points)
    return [(z, x), (z, [-a for a in x])]


PARTS = {
    "mirror": [arc(0.3, 1, 0)],
    "lens": glass(-0.5, -0.4, 0.8),
    "thick_mirror": [arc(0.3, 1, 0), ([-0.55, -0.85], [-1, 1]), ([-0.55, 0.15], [-1, -1]), ([-0.85, 0.15], [1, 1])],
    "flat_mirror": glass(0, 0, 0.5),
    "plate": [([0, 0], [-1, 1]), ([-0.2, -0.5], [-1, 1]), ([-0.2, 0], [-1, -1]), ([-0.5, 0], [1, 1])],
    "conical_baffle": both((0, 0.6), (0.6, 1), (0.5, 1), (-0.1, 0.6), (0, 0.6)),
    "serrated_baffle": both((0, 0.6), (0.6, 1)),
    "chamber": [*lines_of_box(1.6, 2), *lines_of_box(1.8, 2.2)],
    "tube_section": both((0, 0.8), (0, 0.9), (-2, 0.9), (-2, 0.8), (0, 0.8)),
    "dump": [([0, -2, 0], [0.6, 0, -0.6]), ([-2, -2], [-0.6, 0.6])],
    "photodiode": [*glass(0, 0, 0.15, 0.7), ([-0.5, -0.5], [-0.3, 0.3]), *both((-0.5, 0.3), (-0.5, 1), (0, 1), (0, 0.7))],
    "mount": [*both((0, 0.4), (0, 1)), *both((-0.4, 0.4), (-0.4, 1)), ([-0.4, 0], [0.4, 0.4]), ([-0.4, 0], [-0.4, -0.4]),
              ([-0.4, 0], [1, 1]), ([0.3, 0.3, -0.7, -0.7, 0.3], [-1, -1.25, -1.25, -1, -1])],
}
PARTS["motor_mount"] = PARTS["mount"] + both((-0.4, 0.5), (-1.9, 0.5), (-1.9, 1), (-0.4, 1))


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


def draw_shape(name, patches, folder):
    fig = plt.figure(figsize=(8, 3.4), dpi=96)
    draw_section(fig.add_subplot(1, 2, 1), [line for p in patches for line in section(p)], f"{name}: section y = 0")
    ax = fig.add_subplot(1, 2, 2, projection="3d")
    for i, patch in enumerate(patches):
        thin = name == "conic" and i == 1                # the parent surface
        ax.plot_surface(patch[2], patch[0], patch[1], color=GREY if thin else BLUE, alpha=0.12 if thin else 0.55,
                        linewidth=0, antialiased=True, rcount=2 if name == "box" else 40,
                        ccount=2 if name == "box" else 80)
    points = np.concatenate([np.stack([np.ravel(p[2]), np.ravel(p[0]), np.ravel(p[1])]) for p in patches], axis=1)
    ax.set_box_aspect(np.maximum(np.nanmax(points, 1) - np.nanmin(points, 1), 0.05))
    ax.view_init(22, -60)
    ax.set_axis_off()
    fig.tight_layout()
    fig.savefig(folder / f"{name}.png", pil_kwargs={"optimize": True})
    plt.close(fig)


def draw_parts(path):
    fig, axes = plt.subplots(3, 5, figsize=(9, 6), dpi=96)
    for ax in axes.flat[len(PARTS):]:
        ax.set_axis_off()
    for ax, (name, lines) in zip(axes.flat, PARTS.items()):
        draw_section(ax, lines, name)
    fig.tight_layout()
    fig.savefig(path, pil_kwargs={"optimize": True})
    plt.close(fig)


def main(root):
    folder = root / "docs" / "reference" / "shapes"
    for name, patches in SHAPES.items():
        draw_shape(name, patches, folder)
    draw_parts(root / "docs" / "reference" / "parts.png")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve())
