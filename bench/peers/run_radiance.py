# SPDX-License-Identifier: BSD-3-Clause
"""Radiance's rtrace, of the package pyradiance: irradiance at random points of the receiver, nothing interpolated. Geometry in double."""
import json
import math
import pathlib
import random
import resource
import subprocess

import batches
import problems
from problems import Ball, Disk, Mesh, Room, Tube

# One direction per bounce, cosine-distributed; nothing cached; paths end by roulette alone; the lamp by one point of it per vertex.
OPTIONS = "-h -I+ -u+ -ab 64 -aa 0 -ad 1 -as 0 -lr -64 -lw 1e-6 -dt 0 -dc 1 -dj 1 -ds 0 -dr 0 -st 0 -ss 1 -faa".split()


def material_of(finish):
    return "mirror" if finish.mirror else f"diffuse{finish.albedo:g}"


def material(finish):
    a = 1 if finish.mirror else finish.albedo
    kind = "metal" if finish.mirror else "plastic"
    return f"void {kind} {material_of(finish)}\n0\n0\n5 {a} {a} {a} {1 if finish.mirror else 0} 0\n"


def numbers(*values):
    return f"0\n0\n{len(values)} " + " ".join(f"{v:.12g}" for v in values) + "\n"


def ring(d, name):
    return f"{name} ring {d.name}\n" + numbers(*d.centre, *d.normal, d.inner, d.outer)


def quad(name, label, centre, normal, width, height):
    u, v = [0, 0, 0], [0, 0, 0]
    axis = max(range(3), key=lambda k: abs(normal[k]))
    u[(axis + 1) % 3], v[(axis + 2) % 3] = width / 2, height / 2
    corners = [[c + a * p + b * q for c, p, q in zip(centre, u, v)] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    if normal[axis] < 0:
        corners.reverse()
    return f"{name} polygon {label}\n" + numbers(*(x for corner in corners for x in corner))


def shape(surface, folder, tools):
    name = material_of(surface.finish)
    if isinstance(surface, Disk):
        return ring(surface, name)
    if isinstance(surface, Tube):
        return f"{name} tube {surface.name}\n" + numbers(0, 0, surface.start, 0, 0, surface.end, surface.radius)
    if isinstance(surface, Ball):
        return f"{name} sphere {surface.name}\n" + numbers(*surface.centre, surface.radius)
    if isinstance(surface, Room):
        return "".join(quad(name, *wall) for wall in problems.walls(surface))
    problems.write_obj(folder / f"{surface.name}.obj", *problems.knobbly(surface.knobs))
    subprocess.run([tools / "obj2mesh", folder / f"{surface.name}.obj", folder / f"{surface.name}.rtm"], check=True)
    return f"{name} mesh {surface.name}\n1 {folder / surface.name}.rtm\n0\n0\n"


def scene(problem, folder, tools):
    finishes = {s.finish for s in problem.surfaces} | {problems.BLACK}
    radiance = 1 / (math.pi * math.pi * problem.lamp.outer ** 2)                         # of a lamp of 1 W
    text = "".join(material(f) for f in finishes) + f"void light lamp\n0\n0\n3 {radiance} {radiance} {radiance}\n" + ring(problem.lamp, "lamp")
    return text + "".join(shape(s, folder, tools) for s in problem.surfaces)


def points(problem, count, seed):
    """Lines of x y z nx ny nz, even over the receiver."""
    draw, (x, y, z), normal = random.Random(seed), problem.receiver.centre, problem.receiver.normal
    half, (nx, ny, nz) = problem.receiver.side / 2, normal                               # along z in every problem
    lines = (f"{x + draw.uniform(-half, half):.12g} {y + draw.uniform(-half, half):.12g} {z + 1e-6 * nz:.12g} {nx} {ny} {nz}" for _ in range(count))
    return "\n".join(lines) + "\n"


def used():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


def main():
    words = batches.words(__doc__)
    import pyradiance
    tools = pathlib.Path(pyradiance.__file__).parent / "bin"
    folder = pathlib.Path(words.folder).resolve()
    problem = problems.PROBLEMS[words.problem]()
    (folder / "scene.rad").write_text(scene(problem, folder, tools), encoding="utf-8")
    with open(folder / "scene.oct", "wb") as octree:
        subprocess.run([tools / "oconv", folder / "scene.rad"], check=True, stdout=octree)
    setup = used()

    def traced(count, seed):
        """(watts of each point, processor seconds)"""
        before, text = used(), points(problem, count, seed)
        done = subprocess.run([tools / "rtrace", *OPTIONS, "-n", "1", folder / "scene.oct"], input=text, capture_output=True, text=True, check=True)
        return [float(line.split()[0]) * problem.receiver.side ** 2 for line in done.stdout.splitlines()], used() - before
    count, load = 1000, traced(1, 7)[1]
    while (spent := traced(count, words.seed + 1000)[1] - load) < 0.1 * words.seconds:
        count *= 4
    count = max(100, int(count * words.seconds / spent))
    values, spent = traced(count, words.seed)
    mean, error = batches.mean_and_error(values)
    print(json.dumps({"value": mean, "error": error, "seconds": spent - load, "setup": setup + load, "paths": count, "rays": None}))


if __name__ == "__main__":
    main()
