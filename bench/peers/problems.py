# SPDX-License-Identifier: BSD-3-Clause
"""The problems that all programs are given: what share of the light of a lamp reaches a receiver, in any number of bounces.

The lamp is a disc that emits by the cosine law from its front, the receiver a square that takes what reaches its front; both absorb
all light that meets them. Lengths in metres. Every other surface is `diffuse` (Lambertian on both sides, with its albedo) or a
`mirror` that reflects everything. Walls of a closed box face inwards.
"""
import dataclasses
import math
import pathlib


@dataclasses.dataclass(frozen=True)
class Finish:
    albedo: float = 0.0
    mirror: bool = False
    specular: float = 0.0                                # share that is reflected as by a mirror, beside the albedo


BLACK, MIRROR = Finish(), Finish(mirror=True)


@dataclasses.dataclass(frozen=True)
class Disk:
    """Flat, with a hole if `inner` is not 0."""
    name: str
    centre: tuple
    normal: tuple
    outer: float
    finish: Finish
    inner: float = 0.0


@dataclasses.dataclass(frozen=True)
class Tube:
    """Side wall of a cylinder about z, open at both ends."""
    name: str
    start: float
    end: float
    radius: float
    finish: Finish


@dataclasses.dataclass(frozen=True)
class Ball:
    name: str
    centre: tuple
    radius: float
    finish: Finish


@dataclasses.dataclass(frozen=True)
class Room:
    """Six walls of a box along the axes."""
    name: str
    low: tuple
    high: tuple
    finish: Finish


@dataclasses.dataclass(frozen=True)
class Mesh:
    """A closed body of triangles about the origin; `file` is a PLY in metres."""
    name: str
    knobs: int
    finish: Finish


@dataclasses.dataclass(frozen=True)
class Square:
    centre: tuple
    normal: tuple
    side: float


@dataclasses.dataclass(frozen=True)
class Problem:
    lamp: Disk
    receiver: Square
    surfaces: tuple
    bounces: int = 0                                     # at most so many between lamp and receiver; 0: any number


def lamp(centre, normal, radius):
    return Disk("lamp", centre, normal, radius, BLACK)


def tube(length=10.0, baffles=10):
    """A tube with baffles. A black disc half way hides the receiver from the lamp, so light has to scatter."""
    pitch = length / (baffles + 1)
    rings = [Disk(f"baffle{i}", (0, 0, pitch * (i + 1)), (0, 0, 1), 0.5, Finish(0.1), 0.42) for i in range(baffles)]
    wall = Tube("wall", 0.0, length, 0.5, Finish(0.4))
    stop = Disk("stop", (0, 0, length / 2), (0, 0, 1), 0.3, BLACK)
    return Problem(lamp((0, 0, 0.01), (0, 0, 1), 0.15), Square((0, 0, length - 0.01), (0, 0, -1), 0.2), (wall, stop, *rings))


def long_tube():
    return tube(1000.0, 50)


def bench():
    """A closed bench: balls and discs for optics and their mounts, and mirrors, all analytic. The lamp faces away from the receiver."""
    balls = [Ball(f"ball{i}_{j}", (0.1 * i + 0.1, 0.1 * j + 0.1, 0.06), 0.03, Finish(0.3)) for i in range(12) for j in range(8)]
    flats = []
    for i in range(11):
        for j in range(7):
            angle = 2.4 * (7 * i + j)
            flats.append(Disk(f"flat{i}_{j}", (0.1 * i + 0.15, 0.1 * j + 0.15, 0.12), (math.cos(angle), math.sin(angle), 0.0), 0.03,
                              MIRROR if (i + j) % 4 == 0 else Finish(0.3)))
    room = Room("room", (0.0, 0.0, 0.0), (1.3, 0.9, 0.5), Finish(0.4))
    return Problem(lamp((0.3, 0.45, 0.25), (-1, 0, 0), 0.02), Square((1.25, 0.85, 0.05), (0, 0, 1), 0.02), (room, *balls, *flats))


def two_bounces():
    """The bench for programs whose work grows with a power of the number of bounces; its mirrors are diffuse as well."""
    open_ended = bench()
    diffuse = tuple(dataclasses.replace(s, finish=Finish(0.3)) if s.finish.mirror else s for s in open_ended.surfaces)
    return dataclasses.replace(open_ended, surfaces=diffuse, bounces=2)


def mesh():
    """A knobbly body of triangles between lamp and receiver, in a box."""
    room = Room("room", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), Finish(0.3))
    return Problem(lamp((0, 0, -0.45), (0, 0, 1), 0.03), Square((0, 0, 0.45), (0, 0, -1), 0.03),
                   (room, Mesh("body", 280, Finish(0.5))))


def lit_square():
    """Nothing but a lamp that faces the receiver: the closed form that every adapter is tested with."""
    return Problem(lamp((0, 0, 0), (0, 0, 1), 0.1), Square((0, 0, 0.5), (0, 0, -1), 0.1), ())


PROBLEMS = {"tube": tube, "long_tube": long_tube, "bench": bench, "two_bounces": two_bounces, "mesh": mesh, "lit_square": lit_square}


def knobbly(knobs):
    """(points, triangles): a sphere of 0.3 m with bumps of 3 cm, by 2 knobs meridians and knobs parallels."""
    def point(theta, phi):
        r = 0.3 + 0.03 * math.sin(9 * theta) * math.cos(8 * phi)
        return (r * math.sin(theta) * math.cos(phi), r * math.sin(theta) * math.sin(phi), r * math.cos(theta))
    across = 2 * knobs
    points = [point(0, 0)] + [point(math.pi * i / knobs, math.pi * j / knobs) for i in range(1, knobs) for j in range(across)]
    points.append(point(math.pi, 0))
    at = lambda i, j: 1 + (i - 1) * across + j % across                     # noqa: E731
    triangles = [(0, at(1, j), at(1, j + 1)) for j in range(across)]
    for i in range(1, knobs - 1):
        for j in range(across):
            triangles += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
    triangles += [(at(knobs - 1, j), len(points) - 1, at(knobs - 1, j + 1)) for j in range(across)]
    return points, triangles


def write_ply(file, points, triangles):
    head = (f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    lines = ["%.8g %.8g %.8g" % p for p in points] + ["3 %d %d %d" % t for t in triangles]
    pathlib.Path(file).write_text(head + "\n".join(lines) + "\n", encoding="utf-8")


def write_obj(file, points, triangles):
    lines = ["v %.8g %.8g %.8g" % p for p in points] + ["f %d %d %d" % tuple(i + 1 for i in t) for t in triangles]
    pathlib.Path(file).write_text("\n".join(lines) + "\n", encoding="utf-8")


def walls(room):
    """(name, centre, normal, size along u, size along v) of the six walls; normals point into the room; u, v, normal are xyz in turn."""
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end, sign in ((room.low, 1), (room.high, -1)):
            centre = [(a + b) / 2 for a, b in zip(room.low, room.high)]
            centre[axis] = end[axis]
            normal = tuple(float(sign) if k == axis else 0.0 for k in range(3))
            yield (f"{room.name}_{'xyz'[axis]}{'+' if sign > 0 else '-'}", tuple(centre), normal,
                   room.high[u] - room.low[u], room.high[v] - room.low[v])
