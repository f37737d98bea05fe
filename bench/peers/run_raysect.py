# SPDX-License-Identifier: BSD-3-Clause
"""Raysect: path tracing from the receiver, with its important-path sampling of the lamp. Double precision."""
import math

import batches
import problems
from problems import Ball, Disk, Mesh, Room, Tube

THIN = 1e-6                                              # of what has no thickness in the problem, m
DRAWN = 0.5                                              # share of directions that are aimed at the lamp


def main():
    words = batches.words(__doc__)
    from raysect.core import AffineMatrix3D, Point3D, Vector3D, rotate_basis, translate
    from raysect.core.workflow import SerialEngine
    from raysect.optical import ConstantSF, World
    from raysect.optical.material.absorber import AbsorbingSurface
    from raysect.optical.material.debug import PerfectReflectingSurface
    from raysect.optical.material.emitter import UniformSurfaceEmitter
    from raysect.optical.material.lambert import Lambert
    from raysect.optical.observer import Pixel, PowerPipeline0D
    from raysect.primitive import Box, Cylinder, Sphere, Subtract
    from raysect.primitive import Mesh as Triangles

    world = World()

    def facing(centre, normal):
        n = Vector3D(*normal).normalise()
        up = Vector3D(0, 0, 1) if abs(n.z) < 0.9 else Vector3D(0, 1, 0)
        return translate(*centre) * rotate_basis(n, up)

    def material(finish):
        if finish.mirror:
            return PerfectReflectingSurface()
        return Lambert(ConstantSF(finish.albedo)) if finish.albedo else AbsorbingSurface()

    def add(s):
        if isinstance(s, Disk) and s.inner:              # the tool for the hole is longer than the plate is thick
            at = facing(s.centre, s.normal) * translate(0, 0, -THIN / 2)
            Subtract(Cylinder(s.outer, THIN), Cylinder(s.inner, 3 * THIN, transform=translate(0, 0, -THIN)), world, at, material(s.finish))
        elif isinstance(s, Disk):
            Cylinder(s.outer, THIN, world, facing(s.centre, s.normal) * translate(0, 0, -THIN / 2), material(s.finish))
        elif isinstance(s, Tube):                        # a solid would have ends
            cut = Cylinder(s.radius, s.end - s.start, transform=translate(0, 0, s.start))
            pipe = Cylinder(s.radius + 0.01, s.end - s.start - 2 * THIN, transform=translate(0, 0, s.start + THIN))
            Subtract(pipe, cut, world, AffineMatrix3D(), material(s.finish))
        elif isinstance(s, Ball):
            Sphere(s.radius, world, translate(*s.centre), material(s.finish))
        elif isinstance(s, Room):
            Box(Point3D(*s.low), Point3D(*s.high), world, AffineMatrix3D(), material(s.finish))
        elif isinstance(s, Mesh):
            points, faces = problems.knobbly(s.knobs)
            Triangles(points, faces, smoothing=False, closed=True, parent=world, material=material(s.finish))

    problem = problems.PROBLEMS[words.problem]()
    for surface in problem.surfaces:
        add(surface)
    lamp, receiver = problem.lamp, problem.receiver
    behind = facing(lamp.centre, lamp.normal)
    light = UniformSurfaceEmitter(ConstantSF(1.0))
    light.importance = 1
    Cylinder(lamp.outer, THIN, world, behind * translate(0, 0, -THIN), light)
    Cylinder(lamp.outer * 1.0001, THIN, world, behind * translate(0, 0, -3 * THIN), AbsorbingSurface())    # it emits from its front only
    pipeline = PowerPipeline0D(accumulate=False)
    pixel = Pixel([pipeline], x_width=receiver.side, y_width=receiver.side, parent=world, transform=facing(receiver.centre, receiver.normal))
    pixel.render_engine, pixel.quiet = SerialEngine(), True
    pixel.min_wavelength, pixel.max_wavelength, pixel.spectral_bins = 500.0, 501.0, 1
    pixel.ray_extinction_prob, pixel.ray_extinction_min_depth, pixel.ray_max_depth = 0.3, 4, 64
    pixel.ray_importance_sampling, pixel.ray_important_path_weight = True, DRAWN
    power = math.pi * math.pi * lamp.outer ** 2          # of the lamp, W: radiance 1 W/(m^2 sr nm) over 1 nm

    def batch(seed, size):
        from raysect.core.math.random import seed as seed_of
        seed_of(seed)
        pixel.pixel_samples = pixel.samples_per_task = size
        pixel.observe()
        return pipeline.value.mean / power, None
    batches.run(batch, words.seconds, words.seed)


if __name__ == "__main__":
    main()
