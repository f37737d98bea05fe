# SPDX-License-Identifier: BSD-3-Clause
"""Raysect: path tracing from the receiver, with its important-path sampling of the lamp. Double precision."""
import math

from raysect.core import AffineMatrix3D, Point3D, Vector3D, rotate_basis, translate
from raysect.core.math.random import seed as set_seed
from raysect.core.workflow import SerialEngine
from raysect.optical import ConstantSF, World
from raysect.optical.material import Blend, Dielectric
from raysect.optical.material.absorber import AbsorbingSurface
from raysect.optical.material.debug import PerfectReflectingSurface
from raysect.optical.material.emitter import UniformSurfaceEmitter
from raysect.optical.material.lambert import Lambert
from raysect.optical.observer import Pixel, PowerPipeline0D
from raysect.primitive import Box, Cylinder, Intersect, Sphere, Subtract
from raysect.primitive import Mesh as Triangles

import batches
import problems
import real
from problems import Ball, Disk, Room, Tube

THIN = 1e-6                                              # of what has no thickness in the problem, m
AIMED = 0.5                                              # share of directions that are aimed at the lamp


def facing(centre, normal):
    n = Vector3D(*normal).normalise()
    return translate(*centre) * rotate_basis(n, Vector3D(0, 0, 1) if abs(n.z) < 0.9 else Vector3D(0, 1, 0))


def material(finish):
    if finish.mirror:
        return PerfectReflectingSurface()
    if finish.specular:
        return Blend(Lambert(ConstantSF(finish.albedo / (1 - finish.specular))), PerfectReflectingSurface(), finish.specular)
    return Lambert(ConstantSF(finish.albedo)) if finish.albedo else AbsorbingSurface()


def add_real(world, s):
    if isinstance(s, real.Cad):
        for _, points, faces, finish in s.parts():
            Triangles(points, faces, smoothing=False, closed=True, parent=world, material=material(finish))
    else:
        caps = [Sphere(s.curvature_radius, transform=translate(0, 0, side * (s.sag - s.curvature_radius))) for side in (1, -1)]
        Intersect(*caps, world, facing(s.centre, s.axis), Dielectric(ConstantSF(s.index), ConstantSF(1.0)))


def add(world, s):
    if isinstance(s, (real.Cad, real.Lens)):
        add_real(world, s)
        return
    finish = material(s.finish)
    if isinstance(s, Disk):
        at = facing(s.centre, s.normal) * translate(0, 0, -THIN / 2)
        if s.inner:                                      # the tool for the hole is longer than the plate is thick
            Subtract(Cylinder(s.outer, THIN), Cylinder(s.inner, 3 * THIN, transform=translate(0, 0, -THIN)), world, at, finish)
        else:
            Cylinder(s.outer, THIN, world, at, finish)
    elif isinstance(s, Tube):                            # a solid cylinder would have ends
        bore = Cylinder(s.radius, s.end - s.start, transform=translate(0, 0, s.start))
        pipe = Cylinder(s.radius + 0.01, s.end - s.start - 2 * THIN, transform=translate(0, 0, s.start + THIN))
        Subtract(pipe, bore, world, AffineMatrix3D(), finish)
    elif isinstance(s, Ball):
        Sphere(s.radius, world, translate(*s.centre), finish)
    elif isinstance(s, Room):
        Box(Point3D(*s.low), Point3D(*s.high), world, AffineMatrix3D(), finish)
    else:
        Triangles(*problems.knobbly(s.knobs), smoothing=False, closed=True, parent=world, material=finish)


def add_lamp(world, lamp):
    """A disc of radiance 1 W/(m^2 sr nm), with a black one behind it: it emits from its front only."""
    light, at = UniformSurfaceEmitter(ConstantSF(1.0)), facing(lamp.centre, lamp.normal)
    light.importance = 1
    Cylinder(lamp.outer, THIN, world, at * translate(0, 0, -THIN), light)
    Cylinder(lamp.outer * 1.0001, THIN, world, at * translate(0, 0, -3 * THIN), AbsorbingSurface())


def observer(world, receiver):
    pixel = Pixel([PowerPipeline0D(accumulate=False)], x_width=receiver.side, y_width=receiver.side, parent=world,
                  transform=facing(receiver.centre, receiver.normal))
    pixel.render_engine, pixel.quiet = SerialEngine(), True
    pixel.min_wavelength, pixel.max_wavelength, pixel.spectral_bins = 500.0, 501.0, 1
    pixel.ray_extinction_prob, pixel.ray_extinction_min_depth, pixel.ray_max_depth = 0.3, 4, 64
    pixel.ray_importance_sampling, pixel.ray_important_path_weight = True, AIMED
    return pixel


def main():
    words = batches.words(__doc__)
    problem, world = (problems.PROBLEMS | real.REAL)[words.problem](), World()
    for surface in problem.surfaces:
        add(world, surface)
    add_lamp(world, problem.lamp)
    pixel = observer(world, problem.receiver)
    power = math.pi * math.pi * problem.lamp.outer ** 2  # of the lamp over 1 nm, W

    def batch(seed, size):
        set_seed(seed)
        pixel.pixel_samples = pixel.samples_per_task = size
        pixel.observe()
        return pixel.pipelines[0].value.mean / power, None
    batches.run(batch, words.seconds, words.seed)


if __name__ == "__main__":
    main()
