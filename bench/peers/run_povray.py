# SPDX-License-Identifier: BSD-3-Clause
"""POV-Ray: radiosity of single samples, nothing reused, seen by an orthographic camera that looks at the receiver. Double precision.

Each of its samples sends five rays, so the work grows as 5^bounces: for problems with few bounces. POV-Ray has no surfaces that emit and
are sampled: the lamp is a jittered grid of spotlights, each with the cosine law and 1/d^2.
"""
import json
import math
import pathlib
import re
import resource
import subprocess

import batches
import problems
from problems import Ball, Disk, Mesh, Room, Tube

NEAR = 1e-3                                              # POV-Ray's light fades as 2/(1 + (d/NEAR)^2)
WIDE = 7                                                 # pixels; files of less than 8 are not run-length encoded


def vector(v):
    return "<" + ", ".join(f"{x:.12g}" for x in v) + ">"


def texture(finish):
    if finish.mirror:
        return "texture { pigment { rgb 1 } finish { ambient 0 diffuse 0 reflection 1 } }"
    return f"texture {{ pigment {{ rgb 1 }} finish {{ ambient 0 diffuse {finish.albedo:g} }} }}"


def triangles(surface, skin):
    points, faces = problems.knobbly(surface.knobs)
    corners = ",\n".join(map(vector, points))
    return (f"mesh2 {{ vertex_vectors {{ {len(points)},\n{corners} }}\nface_indices {{ {len(faces)},\n"
            + ",\n".join(map(vector, faces)) + f" }} {skin} }}\n")


def shape(s):
    skin = texture(s.finish)
    if isinstance(s, Disk):
        return f"disc {{ {vector(s.centre)}, {vector(s.normal)}, {s.outer:g}, {s.inner:g} {skin} }}\n"
    if isinstance(s, Tube):
        return f"cylinder {{ <0, 0, {s.start:g}>, <0, 0, {s.end:g}>, {s.radius:g} open {skin} }}\n"
    if isinstance(s, Ball):
        return f"sphere {{ {vector(s.centre)}, {s.radius:g} {skin} }}\n"
    if isinstance(s, Room):
        return f"box {{ {vector(s.low)}, {vector(s.high)} {skin} }}\n"
    return triangles(s, skin)


def across(normal):
    u = (0, 0, 1) if abs(normal[2]) < 0.9 else (1, 0, 0)
    v = [normal[1] * u[2] - normal[2] * u[1], normal[2] * u[0] - normal[0] * u[2], normal[0] * u[1] - normal[1] * u[0]]
    return u, v


def scene(problem):
    lamp, receiver = problem.lamp, problem.receiver
    area = math.pi * lamp.outer ** 2
    strength = 1 / (math.pi * area) * area / (2 * math.pi * NEAR ** 2)       # a lamp of 1 W, radiance 1/(pi area)
    side = math.sqrt(area) / 2                           # of two by two points that are jittered over a square of the lamp's area
    (u, v), front = across(lamp.normal), [c + 1e-5 * n for c, n in zip(lamp.centre, lamp.normal)]
    at = [f + n for f, n in zip(front, lamp.normal)]
    a, b = across(receiver.normal)
    eye = [c + 1e-3 * n for c, n in zip(receiver.centre, receiver.normal)]
    size = receiver.side
    text = "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 200 adc_bailout 1e-12\n"
    text += "radiosity { pretrace_start 1 pretrace_end 1 count 1 nearest_count 1 error_bound 1e-5 low_error_factor 1\n"
    text += f"recursion_limit {problem.bounces or 1} minimum_reuse 1e-9 maximum_reuse 2e-9 always_sample on gray_threshold 0 brightness 1 adc_bailout 1e-12 }} }}\n"
    text += (f"camera {{ orthographic location {vector(eye)} direction {vector([-n for n in receiver.normal])} "
             f"right {vector([size * x for x in a])} up {vector([size * x for x in b])} }}\n")
    text += (f"light_source {{ {vector(front)} rgb {strength:.12g} spotlight point_at {vector(at)} radius 90 falloff 90 tightness 1 "
             f"area_light {vector([side * x for x in u])}, {vector([side * x for x in v])}, 2, 2 jitter area_illumination on "
             f"fade_distance {NEAR} fade_power 2 }}\n")
    text += shape(Disk("lamp", lamp.centre, lamp.normal, lamp.outer, problems.BLACK))
    half = [size / 2 * (abs(x) + abs(y)) for x, y in zip(a, b)]
    low, high = ([c + s * h - (1e-6 if n else 0) for c, h, n in zip(receiver.centre, half, receiver.normal)] for s in (-1, 1))
    high = [h + (1e-6 if n else 0) for h, n in zip(high, receiver.normal)]
    text += f"box {{ {vector(low)}, {vector(high)} {texture(problems.Finish(1.0))} }}\n"
    return text + "".join(map(shape, problem.surfaces))


def pixels(file):
    """Red of every pixel of a flat Radiance picture; a byte represents the middle of its step."""
    data = file.read_bytes()
    head = re.search(rb"\n\n-Y (\d+) \+X (\d+)\n", data)
    body = data[head.end():]
    count = int(head[1]) * int(head[2])
    if len(body) != 4 * count:
        raise SystemExit(f"{file}: {len(body)} bytes for {count} pixels")
    return [math.ldexp(body[i] + 0.5, body[i + 3] - 136) if body[i + 3] else 0.0 for i in range(0, 4 * count, 4)]


def used():
    r = resource.getrusage(resource.RUSAGE_CHILDREN)
    return r.ru_utime + r.ru_stime


def main():
    words = batches.words(__doc__)
    folder = pathlib.Path(words.folder).resolve()
    problem = problems.PROBLEMS[words.problem]()
    (folder / "scene.pov").write_text(scene(problem), encoding="utf-8")

    def traced(rows):
        """(share of the lamp's light per pixel, processor seconds, rays)"""
        before, picture = used(), folder / "scene.hdr"
        done = subprocess.run(["povray", f"+I{folder / 'scene.pov'}", f"+O{picture}", "+FH", f"+W{WIDE}", f"+H{rows}", "+WT1",
                               "-D", "-A", "-J", "-GA", "+GS"], capture_output=True, text=True, cwd=folder)
        if done.returncode:
            raise SystemExit(done.stderr[-2000:])
        rays = re.findall(r"^(?:Rays|Shadow Ray Tests):\s+(\d+)", done.stderr + done.stdout, re.MULTILINE)
        return [math.pi * x * problem.receiver.side ** 2 for x in pixels(picture)], used() - before, sum(map(int, rays))
    load, rows = traced(4)[1], 32
    while (spent := traced(rows)[1] - load) < 0.1 * words.seconds:
        rows *= 2
    rows = max(64, int(rows * math.sqrt(words.seconds / spent)))    # looking for samples to reuse costs the square of the pixels
    values, spent, rays = traced(rows)
    mean, error = batches.mean_and_error(values)
    print(json.dumps({"value": mean, "error": error, "seconds": spent - load, "setup": load, "paths": WIDE * rows, "rays": rays or None}))


if __name__ == "__main__":
    main()
