# SPDX-License-Identifier: BSD-3-Clause
"""Mitsuba 3: --way VARIANT:INTEGRATOR, such as scalar_rgb:path or llvm_ad_mono:ptracer. Single precision."""
import math

import batches
import problems
import real
from problems import Ball, Disk, Mesh, Room, Tube

DIM = 0.1                                                # albedo of a receiver that a camera looks at
SEEN = 0.98                                              # of its width: brighter things beyond its edge must not be in the picture
FILM = {"sampler": {"type": "independent"},
        "film": {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}, "pixel_format": "luminance",
                 "component_format": "float32"}}


def bsdf(finish):
    if finish.mirror:
        return {"type": "twosided", "bsdf": {"type": "conductor", "material": "none"}}
    if finish.specular:
        return {"type": "twosided", "bsdf": blend(finish)}
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "spectrum", "value": finish.albedo}}}


def blend(finish):
    """A mirror and a diffuse surface of one reflectance: `blendbsdf` of 3.9 mixes both lobes in a mirror direction, which changes other pairs."""
    total = finish.albedo + finish.specular
    return {"type": "blendbsdf", "weight": finish.albedo / total,
            "first": {"type": "conductor", "material": "none", "specular_reflectance": {"type": "spectrum", "value": total}},
            "second": {"type": "diffuse", "reflectance": {"type": "spectrum", "value": total}}}


def glass(lens):
    """Both caps as fine triangles whose normals vary smoothly, which close at the edge."""
    rings, around, points, faces = 96, 192, [], []
    for side in (1, -1):
        first = len(points)
        points.append((0, 0, side * lens.sag))
        for i in range(1, rings + 1):
            r = lens.radius * i / rings
            z = side * (lens.sag - lens.curvature_radius + math.sqrt(lens.curvature_radius ** 2 - r * r))
            points += [(r * math.cos(2 * math.pi * j / around), r * math.sin(2 * math.pi * j / around), z) for j in range(around)]
        at = lambda i, j: first + 1 + (i - 1) * around + j % around          # noqa: E731,B023
        triangles = [(first, at(1, j), at(1, j + 1)) for j in range(around)]
        for i in range(1, rings):
            for j in range(around):
                triangles += [(at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1))]
        faces += triangles if side == 1 else [t[::-1] for t in triangles]
    return points, faces


def facing(mi, centre, normal, *size):
    up = (0, 0, 1) if abs(normal[2]) < 0.9 else (0, 1, 0)
    target = [c + n for c, n in zip(centre, normal)]
    return mi.ScalarTransform4f().look_at(origin=list(centre), target=target, up=list(up)).scale(list(size))


def annulus(d):
    """Mitsuba has no disc with a hole: triangles between two polygons of 256 corners whose areas are those of the circles."""
    n, points, faces = 256, [], []
    area = math.sqrt(2 * math.pi / n / math.sin(2 * math.pi / n))
    for radius in (d.inner, d.outer):
        points += [(radius * area * math.cos(2 * math.pi * i / n), radius * area * math.sin(2 * math.pi * i / n), 0) for i in range(n)]
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, n + i, n + j), (i, n + j, j)]
    return points, faces


def mesh_file(folder, name, points, faces, **more):
    problems.write_ply(f"{folder}/{name}.ply", points, faces)
    return {"type": "ply", "filename": f"{folder}/{name}.ply", "face_normals": True, **more}


def shapes(mi, surface, folder):
    if isinstance(surface, real.Cad):
        for name, points, faces, finish in surface.parts():
            yield name, mesh_file(folder, name, points, faces, bsdf=bsdf(finish))
        return
    if isinstance(surface, real.Lens):
        at = facing(mi, surface.centre, surface.axis, 1, 1, 1)
        problems.write_ply(f"{folder}/{surface.name}.ply", *glass(surface))
        yield surface.name, {"type": "ply", "filename": f"{folder}/{surface.name}.ply", "to_world": at,
                             "bsdf": {"type": "dielectric", "int_ior": surface.index, "ext_ior": 1.0}}
        return
    finish = {"bsdf": bsdf(surface.finish)}
    if isinstance(surface, Disk) and surface.inner:
        at = facing(mi, surface.centre, surface.normal, 1, 1, 1)
        yield surface.name, mesh_file(folder, surface.name, *annulus(surface), to_world=at, **finish)
    elif isinstance(surface, Disk):
        at = facing(mi, surface.centre, surface.normal, surface.outer, surface.outer, 1)
        yield surface.name, {"type": "disk", "to_world": at, **finish}
    elif isinstance(surface, Tube):
        yield surface.name, {"type": "cylinder", "p0": [0, 0, surface.start], "p1": [0, 0, surface.end], "radius": surface.radius, **finish}
    elif isinstance(surface, Ball):
        yield surface.name, {"type": "sphere", "center": list(surface.centre), "radius": surface.radius, **finish}
    elif isinstance(surface, Mesh):
        yield surface.name, mesh_file(folder, surface.name, *problems.knobbly(surface.knobs), **finish)
    elif isinstance(surface, Room):
        middle = [(a + b) / 2 for a, b in zip(surface.low, surface.high)]
        half = [(b - a) / 2 for a, b in zip(surface.low, surface.high)]
        yield surface.name, {"type": "cube", "to_world": mi.ScalarTransform4f().translate(middle).scale(half), **finish}


def meter(problem):
    """The receiver as a sensor of irradiance."""
    return {"bsdf": bsdf(problems.BLACK), "sensor": {"type": "irradiancemeter", **FILM}}


def camera(mi, problem, albedo):
    """A camera that views only the receiver, which is then diffuse: the particle tracer has no irradiance sensor."""
    half, (centre, normal) = problem.receiver.side / 2, (problem.receiver.centre, problem.receiver.normal)
    away = 2 * half                                      # nearer, the wide angle costs the particle tracer 3 %
    return ({"bsdf": bsdf(problems.Finish(albedo))},
            {"type": "perspective", "fov": 2 * math.degrees(math.atan(SEEN * half / away)), "near_clip": away / 10, "far_clip": 10 * half,
             "to_world": facing(mi, [c + away * n for c, n in zip(centre, normal)], [-n for n in normal], 1, 1, 1), **FILM})


def scene(mi, problem, folder, integrator):
    lamp, receiver = problem.lamp, problem.receiver
    half = receiver.side / 2
    made = {"type": "scene", "integrator": {"type": integrator, "max_depth": 64, "rr_depth": 5},
            "lamp": {"type": "disk", "bsdf": bsdf(problems.BLACK),
                     "to_world": facing(mi, lamp.centre, lamp.normal, lamp.outer, lamp.outer, 1),
                     "light": {"type": "area", "radiance": {"type": "spectrum", "value": 1.0}}}}
    taken = meter(problem)
    if integrator == "ptracer":
        taken, made["camera"] = camera(mi, problem, DIM)
    made["receiver"] = {"type": "rectangle", "to_world": facing(mi, receiver.centre, receiver.normal, half, half, 1), **taken}
    for surface in problem.surfaces:
        made.update(shapes(mi, surface, folder))
    return mi.load_dict(made)


def main():
    words = batches.words(__doc__)
    variant, integrator = words.way.split(":")
    import drjit
    import mitsuba as mi
    mi.set_variant(variant)
    drjit.set_thread_count(1)
    mi.logger().clear_appenders()
    problem = (problems.PROBLEMS | real.REAL)[words.problem]()
    world = scene(mi, problem, words.folder, integrator)
    share = problem.receiver.side ** 2 / (math.pi * math.pi * problem.lamp.outer ** 2)   # power on the receiver over that of the lamp
    if integrator == "ptracer":
        share *= math.pi / DIM                           # the camera sees the radiance albedo/pi times irradiance

    def batch(seed, size):
        image = mi.render(world, seed=seed % 2 ** 31, spp=size)
        return float(image.numpy().mean()) * share, None
    batches.run(batch, words.seconds, words.seed, 1 << 26 if variant.startswith("scalar") else 1 << 20)


if __name__ == "__main__":
    main()
