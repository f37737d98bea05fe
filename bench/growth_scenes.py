# SPDX-License-Identifier: BSD-3-Clause
"""Scenes of any size for the bench of growth. Each function lets one thing grow and keeps the rest."""
import numpy

TUBE = """straytrace: 1
materials:
  mirror: {{scatter: {{model: power-law, kappa: 3.2145e-9 /sr, exponent: 2.3986, above: 50 urad}}}}
  baffle: {{scatter: {{model: lambertian, brdf: 1e-4 /sr}}}}
bodies:
  mirror: {{motion: still}}
{bodies}
scene:
  - {{name: mirror, shape: {{disk: {{outer_radius: 10 cm}}}}, facing: [0, 0, 1], side: front, body: mirror, material: mirror}}
{baffles}
beams:
  spot: {{on: mirror, profile: gaussian, radius: 2 mm, wavelength: 1064 nm, power: 1 MW}}
ports:
  mirror: {{beam: spot, at: mirror}}
interferometer: {{preset: fabry-perot-michelson, arm_length: 10 km, mirror_mass: 200 kg, input_transmission: 0.7 %, arms: 1}}
trace: {{seed: 1, histories: 1000000, order_limit: 2, reverse_routes: off}}
noise: {{band: [10 Hz, 100 Hz], points_per_decade: 30}}
"""
MOTION = "{{motion: {{z: {{power-law: {{asd: {asd:.6g} m/sqrt(Hz), at: 1 Hz, exponent: -2, from: 1 Hz, to: 1 kHz}}}}, others: still}}}}"


def annuli(names, bodies, rings=1000):
    """Annuli behind each other, each as wide as the gap to the next that a mirror sees, divided among so many entries and so many
    bodies: the rays are the same however they are divided."""
    near, far, radius = 1000, 9000, 0.5
    step = (far / near) ** (1 / rings)
    shape = f"{{disk: {{inner_radius: {radius / step ** 0.5:.12g} m, outer_radius: {radius * step ** 0.5:.12g} m}}}}"
    rows = []
    for i in range(names):
        first, count = i * rings // names, (i + 1) * rings // names - i * rings // names
        rows.append(f"  - {{name: ring{i}, shape: {shape}, facing: [0, 0, -1], side: front, body: b{i * bodies // names}, material: "
                    f"baffle, repeat: {{count: {count}, along: z, from: {near * step ** (first + 0.5):.12g} m, ratio: {step:.15g}}}}}")
    motions = [f"  b{b}: " + MOTION.format(asd=1e-15 * (1 + b / 1000)) for b in range(bodies)]
    return TUBE.format(bodies="\n".join(motions), baffles="\n".join(rows))


ROOM = """straytrace: 1
materials:
  metal: {{scatter: {{model: lambertian, tis: 60 %}}}}
bodies:
  bench: {{motion: still}}
scene:
  - {{name: box, shape: {{box: {{width: 2 m, height: 2 m, depth: 1 m}}}}, side: inner, body: bench, material: metal}}
  - {{name: detector, shape: {{disk: {{outer_radius: 5 cm}}}}, at: [80 cm, 80 cm, 40 cm], facing: [0, 0, -1], side: front, body: bench,
     material: metal}}
  - {{name: bodies, file: {mesh}, units: m, body: bench, material: metal}}
beams:
  input: {{from: [0 m, 0 m, 45 cm], facing: [0.3, 0.2, -1], radius: 1 mm, wavelength: 1064 nm, power: 1 W}}
receivers:
  PD: {{on: detector, side: front}}
trace: {{seed: 1, histories: 1000000, order_limit: 6}}
"""


def knobbly_bodies(file, triangles):
    """Sixteen bodies of the same form with about so many triangles in all, a binary PLY; returns how many there are."""
    around = max(4, round((triangles / 16) ** 0.5))
    along = around // 2
    i, k = numpy.meshgrid(numpy.arange(around), numpy.arange(1, along), indexing="ij")
    a, b = 2 * numpy.pi * i / around, numpy.pi * k / along
    r = 0.12 * (1 + 0.15 * numpy.sin(5 * a) * numpy.sin(3 * b) * numpy.sin(b) ** 2)
    points = numpy.stack([r * numpy.sin(b) * numpy.cos(a), r * numpy.sin(b) * numpy.sin(a), -r * numpy.cos(b)], -1).reshape(-1, 3)
    points = numpy.concatenate([points, [[0, 0, -0.12], [0, 0, 0.12]]])
    south, north, rows = len(points) - 2, len(points) - 1, along - 1
    here = (i * rows + k - 1)
    beside = ((i + 1) % around) * rows + k - 1
    lower, upper = here[:, :-1], here[:, 1:]
    next_lower, next_upper = beside[:, :-1], beside[:, 1:]
    first = numpy.arange(around)
    faces = numpy.concatenate([
        numpy.stack([lower, next_lower, next_upper], -1).reshape(-1, 3), numpy.stack([lower, next_upper, upper], -1).reshape(-1, 3),
        numpy.stack([numpy.full(around, south), (first + 1) % around * rows, first * rows], -1),
        numpy.stack([numpy.full(around, north), first * rows + rows - 1, (first + 1) % around * rows + rows - 1], -1)])
    centres = [(x, y, 0) for x in (-0.6, -0.2, 0.2, 0.6) for y in (-0.6, -0.2, 0.2, 0.6)]
    with open(file, "wb") as out:
        out.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {16 * len(points)}\nproperty float x\nproperty float y\n"
                   f"property float z\nelement face {16 * len(faces)}\nproperty list uchar int vertex_indices\nend_header\n").encode())
        for centre in centres:
            out.write((points + centre).astype("<f4").tobytes())
        for n in range(16):
            rows_of_file = numpy.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
            rows_of_file["count"], rows_of_file["corners"] = 3, faces + n * len(points)
            out.write(rows_of_file.tobytes())
    return 16 * len(faces)


def room_with(mesh):
    return ROOM.format(mesh=mesh)
