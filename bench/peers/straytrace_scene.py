# SPDX-License-Identifier: BSD-3-Clause
"""A problem as a scene of straytrace."""
import json
import shutil

import problems
import real
from problems import Ball, Disk, Mesh, Room, Tube

DIM = 1e-6                                               # of the lamp's albedo, so that light that comes back to it is gone


def metres(x):
    return f"{x!r} m"


def place(p):
    return [metres(x) for x in p]


def material_of(finish):
    if finish.specular:
        return f"shiny_{finish.albedo:g}_{finish.specular:g}".replace(".", "_")
    return "mirror" if finish.mirror else f"diffuse_{finish.albedo:g}".replace(".", "_") if finish.albedo else "black"


def finishes(problem):
    for s in problem.surfaces:
        if isinstance(s, real.Cad):
            yield from (finish for _, finish in s.finishes)
        elif not isinstance(s, real.Lens):
            yield s.finish


def materials(problem):
    found = {"lamp": {"scatter": {"model": "lambertian", "tis": DIM}}, "black": {}}
    for finish in finishes(problem):
        made = {"specular": {"reflect": 1}} if finish.mirror else {"specular": {"reflect": finish.specular}} if finish.specular else {}
        if finish.albedo:
            made["scatter"] = {"model": "lambertian", "tis": finish.albedo}
        found[material_of(finish)] = made
    if any(isinstance(s, real.Lens) for s in problem.surfaces):
        found["polished"] = {"specular": "fresnel"}
    return found


def lens(s):
    """Thicker by 1 um than where both faces meet, as a barrel must be there."""
    half = s.sag + 5e-7
    return {"name": s.name, "use": "lens", "diameter": metres(2 * s.radius), "thickness": metres(2 * half), "radius_1": metres(s.curvature_radius),
            "radius_2": metres(s.curvature_radius), "medium": "glass", "at": place(c + half * a for c, a in zip(s.centre, s.axis)), "facing": list(s.axis),
            "material": "polished", "body": "all"}


def disk(d, material=None, **more):
    shape = {"outer_radius": metres(d.outer), **({"inner_radius": metres(d.inner)} if d.inner else {})}
    return {"name": d.name, "shape": {"disk": shape}, "at": place(d.centre), "facing": list(d.normal),
            "material": material or material_of(d.finish), "body": "all", **more}


def entries(surface, folder):
    if isinstance(surface, real.Cad):
        shutil.copy(surface.file, folder)
        yield {"name": surface.name, "file": surface.file.name, "units": "from_file", "at": place((0, 0, 0)), "body": "all",
               "surfaces": {part: material_of(finish) for part, finish in surface.finishes}}
        return
    if isinstance(surface, real.Lens):
        yield lens(surface)
        return
    common = {"body": "all", "material": material_of(surface.finish)}
    if isinstance(surface, Disk):
        yield disk(surface)
    elif isinstance(surface, Tube):
        shape = {"radius": metres(surface.radius), "from": metres(surface.start), "to": metres(surface.end)}
        yield {"name": surface.name, "shape": {"cylinder": shape}, **common}
    elif isinstance(surface, Ball):
        yield {"name": surface.name, "shape": {"sphere": {"radius": metres(surface.radius)}}, "at": place(surface.centre), **common}
    elif isinstance(surface, Mesh):
        problems.write_ply(folder / f"{surface.name}.ply", *problems.knobbly(surface.knobs))
        yield {"name": surface.name, "file": f"{surface.name}.ply", "units": "m", **common}
    elif isinstance(surface, Room):
        for name, centre, normal, width, height in problems.walls(surface):
            if not normal[2]:                            # there the shape's own x runs along what `walls` calls v
                width, height = height, width
            yield {"name": name.replace("+", "_low").replace("-", "_high"), "at": place(centre), "facing": list(normal),
                   "shape": {"rectangle": {"width": metres(width), "height": metres(height)}}, **common}


def media(problem):
    index = next((s.index for s in problem.surfaces if isinstance(s, real.Lens)), None)
    return {"media": {"glass": {"index": index}}} if index else {}


def scene(problem, folder):
    parts = [disk(problem.lamp, "lamp", side="front"),
             {"name": "receiver", "shape": {"rectangle": {"width": metres(problem.receiver.side), "height": metres(problem.receiver.side)}},
              "at": place(problem.receiver.centre), "facing": list(problem.receiver.normal), "body": "all", "material": "black"}]
    for s in problem.surfaces:
        parts += entries(s, folder)
    return json.dumps({"straytrace": 1, "title": "peer", "materials": materials(problem), "bodies": {"all": {"motion": "still"}},
                       **media(problem), "scene": parts, "beams": {"light": {"on": "lamp", "profile": "even", "radius": metres(problem.lamp.outer),
                                                           "travel": [-x for x in problem.lamp.normal], "power": "1 W"}},
                       "receivers": {"receiver": {"on": "receiver", "side": "front"}},
                       **({"trace": {"order_limit": problem.bounces + 1}} if problem.bounces else {})}, indent=1)
