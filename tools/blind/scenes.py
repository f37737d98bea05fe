"""Random scenes, for the program as YAML and for the oracle as objects. A scene depends only on its seed."""
import json
import math

import numpy as np

from surfaces import Material, Surface, unit

AXES = "xyz"


class Group:
    def __init__(self, surfaces, material, body, entry):
        self.surfaces, self.material, self.body, self.entry = surfaces, material, body, entry


class Body:
    """terms: {coordinate: [term]}; joins: [(other body, chain)], with the word of the scene language for them."""

    def __init__(self, pivot, terms=None, joins=(), word="follows"):
        self.pivot, self.terms, self.joins, self.word = np.asarray(pivot, float), terms or {}, list(joins), word


class Scene:
    """A cavity of two mirrors and objects between them, turned and shifted as a whole."""

    def __init__(self, seed):
        self.seed, self.rng = seed, np.random.default_rng([2718, seed])
        self.wavelength = float(self.rng.choice([1.064e-6, 1.55e-6]))
        self.place()
        self.mirrors, self.groups, self.bodies, self.materials = ["A", "B"], {}, {}, {}
        self.make_mirrors()
        self.make_objects()
        self.make_motion()
        self.power = float(self.log(1e3, 1e6))
        self.mirror_mass, self.arm_length = float(self.log(5, 200)), self.length
        self.input_transmission = float(self.log(3e-3, 3e-2))
        self.signal_transmission = float(self.rng.choice([1.0, self.uniform(0.2, 0.6)]))

    def uniform(self, low, high):
        return float(self.rng.uniform(low, high))

    def log(self, low, high):
        return float(math.exp(self.rng.uniform(math.log(low), math.log(high))))

    def chance(self, share):
        return self.rng.random() < share

    # ---- place: an arbitrary frame, or the arm along an axis of the scene, where entries can be repeated
    def place(self):
        self.along = None
        if self.chance(0.6):
            q = unit(self.rng.standard_normal(4))
            w, x, y, z = q
            self.turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                                  [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                                  [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
        else:
            first = int(self.rng.integers(3))
            self.along = AXES[first]
            self.turn = np.roll(np.eye(3), first + 1, axis=0)
        self.shift = self.rng.uniform(-100, 100, 3) if self.chance(0.7) else np.zeros(3)

    def point(self, local):
        return self.turn @ np.asarray(local, float) + self.shift

    def direction(self, local):
        return self.turn @ unit(np.asarray(local, float))

    # ---- materials
    def material(self, name, reflect, models):
        self.materials[name] = Material(reflect, models)
        return name

    def mirror_material(self, name):
        models = [{"model": "power-law", "kappa": self.log(1e-10, 1e-7), "exponent": self.uniform(1.2, 2.8),
                   "above": self.log(1e-5, 1e-4)}]
        if self.chance(0.8):
            models.append({"model": "lambertian", "brdf": self.log(1e-7, 1e-5)})
        if self.chance(0.3):
            models = [{"model": "lambertian", "brdf": self.log(1e-7, 1e-4)}]
        elif self.chance(0.2):
            models[0] = {"model": "harvey", "b0": self.log(1e-3, 1e-1), "l": self.log(1e-4, 1e-2), "s": self.uniform(-2.6, -1)}
        elif self.chance(0.25):
            offsets = np.geomspace(1e-5, 1, 9)
            slope = self.uniform(1.3, 2.4)
            brdf = self.log(1e-9, 1e-7) * offsets**-slope * np.exp(0.5 * self.rng.standard_normal(9))
            models[0] = {"model": "table", "offset": offsets.tolist(), "brdf": brdf.tolist()}
        return self.material(name, self.uniform(0.8, 0.96), models)

    def object_material(self, name):
        kind = self.rng.choice(["lambertian", "abg", "harvey", "table", "both"], p=[0.4, 0.15, 0.15, 0.15, 0.15])
        models = []
        if kind in ("lambertian", "both"):
            models.append({"model": "lambertian", "brdf": self.log(1e-3, 0.1)})
        if kind in ("abg", "both"):
            models.append({"model": "abg", "a": self.log(1e-3, 2e-2), "b": self.log(3e-2, 0.3), "g": self.uniform(1, 2.5)})
        if kind == "harvey":
            models.append({"model": "harvey", "b0": self.log(3e-2, 0.5), "l": self.log(0.05, 0.3), "s": self.uniform(-2.5, -1)})
        if kind == "table":
            offsets = np.array([0.02, 0.1, 0.3, 0.6, 1, 1.4, 1.9])
            models.append({"model": "table", "offset": offsets.tolist(),
                           "brdf": (self.log(1e-3, 5e-2) * (0.1 + offsets)**-self.uniform(0, 1)).tolist()})
        return self.material(name, self.uniform(0.05, 0.5) if self.chance(0.35) else 0.0, models)

    # ---- geometry
    def make_mirrors(self):
        self.length = self.log(50, 4000)
        sign = 1 if self.chance(0.5) else -1
        for _ in iter(int, 1):
            g = [sign * self.uniform(0.2, 0.95) for _ in "AB"]
            if 0.08 < g[0] * g[1] < 0.85:
                break
        size = math.sqrt(self.wavelength * self.length / math.pi)
        w = [size * (g[1 - i] / (g[i] * (1 - g[0] * g[1])))**0.25 for i in (0, 1)]
        self.spot = max(w)
        shared = self.chance(0.3)
        common = self.mirror_material("coating") if self.chance(0.4) else None
        for i, name in enumerate(self.mirrors):
            radius, roc = w[i] * self.uniform(2.8, 4.5), self.length / (1 - g[i])
            local, facing = ([0, 0, 0], [0, 0, 1]) if i == 0 else ([0, 0, self.length], [0, 0, -1])
            body = "mirrors" if shared else "body_" + name
            if body not in self.bodies:
                self.bodies[body] = Body(self.point(local))
            surface = Surface("cap", self.point(local), self.direction(facing), "front", outer=radius, roc=roc)
            material = common or self.mirror_material("coating_" + name)
            self.groups[name] = Group([surface], self.materials[material], body, {"material": material})

    def make_objects(self):
        count = int(self.rng.integers(1, 5))
        edges = np.linspace(0.06, 0.94, count + 1) * self.length
        rim = max(self.groups[m].surfaces[0].outer for m in self.mirrors)
        self.tube = self.chance(0.5)
        for i in range(count):
            room = edges[i + 1] - edges[i]
            middle = edges[i] + room * self.uniform(0.3, 0.7)
            self.make_object(f"object_{i + 1}", middle, 0.25 * room, rim)

    def make_object(self, name, z, reach, rim):
        kind = self.rng.choice(["annulus", "cone", "cylinder", "plate", "ball", "rings"])
        if kind == "rings" and self.along is None:
            kind = "annulus"
        hole = max(rim * self.uniform(1.05, 3), 4 * self.spot) + self.log(1e-3, 0.3)
        wide = hole * self.uniform(1.15, 2)
        off = self.rng.uniform(-0.2, 0.2, 2) * (hole - rim)
        towards = 1 if self.chance(0.5) else -1
        lean = [*(self.rng.normal(0, 0.12, 2)), towards]
        at, side = [*off, z], "both" if self.chance(0.6) else "front"
        if kind in ("annulus", "rings"):
            shape = dict(kind="disk", inner=hole, outer=wide)
        elif kind == "cone":
            shape = dict(kind="cone", inner=hole, outer=wide, half_angle=math.radians(self.uniform(25, 75)))
            lean, side = [0.02 * lean[0], 0.02 * lean[1], towards], {"front": "inner"}.get(side, side)
        elif kind == "cylinder":
            half = min(reach, hole * self.log(2, 60))
            shape = dict(kind="cylinder", radius=hole, start=-half, end=half)
            tilt = 0.2 * (hole - rim) / half
            lean, side = [tilt * self.uniform(-1, 1), tilt * self.uniform(-1, 1), 1], {"front": "inner"}.get(side, side)
        else:
            size = (wide - hole) * self.uniform(0.3, 0.9)
            turn, away = self.uniform(0, 2 * math.pi), hole + size
            at = [away * math.cos(turn), away * math.sin(turn), z]
            if kind == "plate":
                shape, lean = dict(kind="disk", inner=0.0, outer=size), [*self.rng.normal(0, 0.6, 2), towards]
            else:
                shape, lean, side = dict(kind="sphere", radius=size), [0, 0, 1], "outer"
        kind_name = "repeat" if kind == "rings" else "single"
        body = "tube" if self.tube and self.chance(0.7) else "body_" + name
        if body not in self.bodies:
            self.bodies[body] = Body(self.point(at))
        material = self.object_material("surface_" + name)
        places = [np.zeros(3)] if kind_name == "single" else [np.array([0, 0, s * reach]) for s in sorted(self.rng.uniform(-1, 1, 3))]
        surfaces = [Surface(at=self.point(np.array(at) + p), axis=self.direction(lean), side=side, **shape) for p in places]
        entry = {"material": material}
        if kind_name == "repeat":
            entry["repeat"] = [float(p[2]) for p in places]
            entry["at"] = self.point(at)
        self.groups[name] = Group(surfaces, self.materials[material], body, entry)

    # ---- motion
    def term(self, strong, angle=False):
        scale = 0.3 if angle else 1.0
        pick = self.rng.random()
        if strong and pick < 0.6:
            at = self.uniform(0.35, 1.5)
            return {"line": (at, self.uniform(0.05, 0.1), scale * self.log(3e-8, 1.5e-6 / at))}
        if strong and pick < 0.8:
            at = float(self.rng.integers(32, 640)) / 64
            return {"sine": (scale * self.log(2e-8, 1.5e-6 / at), at, self.uniform(-3, 3))}
        if pick < 0.5:
            return {"line": (self.uniform(6, 150), self.uniform(0.3, 5), scale * self.log(1e-10, 2e-8))}
        return {"power-law": (scale * self.log(1e-11, 1e-8), 10.0, -self.uniform(1, 2.5), 2.0, 400.0)}

    def terms(self, strong, angle=False):
        found = [self.term(strong, angle)]
        if self.chance(0.5):
            found.append(self.term(False, angle))
        if self.chance(0.2):
            found[0]["scale"] = self.uniform(0.3, 2)
        return found

    def link(self):
        kind = "resonance" if self.chance(0.5) else "pendulum"
        return {kind: {"frequency": self.uniform(2, 40), "quality": self.uniform(3, 30)}}

    def make_motion(self):
        strong = self.chance(0.6)
        self.wraps = strong
        ground = self.chance(0.7)
        if ground:
            self.bodies["ground"] = Body(np.zeros(3), {c: self.terms(strong) for c in AXES})
        for name, body in self.bodies.items():
            if name == "ground" or name in ("mirrors", "body_A", "body_B") and self.chance(0.5):
                continue
            pick = self.rng.random()
            if ground and pick < 0.25:
                body.joins, body.word = [("ground", [self.link()] if self.chance(0.5) else None)], "follows"
            elif ground and pick < 0.5:
                body.joins, body.word = [("ground", None)], "relative_to"
                body.terms = {self.rng.choice(list(AXES)): self.terms(strong)}
            elif ground and pick < 0.65:
                body.terms = {c: [{"from": "ground", "axis": str(self.rng.choice(list(AXES))), "scale": self.uniform(-1, 1),
                                   "through": [self.link()] if self.chance(0.5) else None}] for c in AXES}
            else:
                body.terms = {c: self.terms(strong) for c in AXES if self.chance(0.6)}
            if name.startswith(("body_object", "tube")) and self.chance(0.3):
                body.terms["r" + str(self.rng.choice(list(AXES)))] = self.terms(strong, angle=True)

    # ---- YAML
    def yaml(self, folder):
        """Text of the scene; tables of BSDF are written into the folder."""
        out = {"straytrace": 1, "title": f"Random scene {self.seed}"}
        out["materials"] = {n: material_table(m, n, folder) for n, m in self.materials.items()}
        out["bodies"] = {n: body_table(b) for n, b in self.bodies.items()}
        out["scene"] = [self.entry(n, g) for n, g in self.groups.items()]
        out["beams"] = {"arm": {"cavity": self.mirrors, "wavelength": f"{self.wavelength!r} m", "power": f"{self.power!r} W"}}
        out["ports"] = {m: {"beam": "arm", "at": m} for m in self.mirrors}
        out["ghosts"] = "off"
        out["interferometer"] = {"preset": "fabry-perot-michelson", "arm_length": metres(self.arm_length),
                                 "mirror_mass": f"{self.mirror_mass!r} kg", "input_transmission": self.input_transmission,
                                 "signal_recycling_transmission": self.signal_transmission}
        out["noise"] = {"band": ["5 Hz", "200 Hz"], "points_per_decade": 20}
        return json.dumps(out, indent=1)        # JSON is YAML

    def entry(self, name, group):
        s = group.surfaces[0]
        entry = {"name": name, "at": lengths(group.entry.get("at", s.at)), "facing": s.axis.tolist(), "side": s.side,
                 "body": group.body, "material": group.entry["material"]}
        if s.kind == "cap":
            entry |= {"use": "mirror", "radius": metres(s.outer), "radius_of_curvature": metres(s.roc)}
        elif s.kind == "disk":
            entry["shape"] = {"disk": {"inner_radius": metres(s.inner), "outer_radius": metres(s.outer)}}
        elif s.kind == "cone":
            entry["shape"] = {"cone": {"inner_radius": metres(s.inner), "outer_radius": metres(s.outer),
                                       "half_angle": f"{s.half_angle!r} rad"}}
        elif s.kind == "cylinder":
            entry["shape"] = {"cylinder": {"radius": metres(s.radius), "from": metres(s.start), "to": metres(s.end)}}
        else:
            entry["shape"] = {"sphere": {"radius": metres(s.radius)}}
        if "repeat" in group.entry:
            entry["repeat"] = {"along": self.along, "at": [metres(z) for z in group.entry["repeat"]]}
        return entry


def metres(x):
    return f"{float(x)!r} m"


def lengths(v):
    return [metres(x) for x in v]


def material_table(material, name, folder):
    rows = []
    for i, m in enumerate(material.models):
        row = dict(m)
        for key in ("kappa", "brdf", "a", "b0"):
            if key in row and row["model"] != "table":
                row[key] = f"{row[key]!r} /sr"
        if "above" in row:
            row["above"] = f"{row['above']!r} rad"
        if row["model"] == "table":
            file = folder / f"{name}_{i}.csv"
            file.write_text("theta_i [rad],offset,brdf [1/sr]\n" +
                            "".join(f"0,{o!r},{b!r}\n" for o, b in zip(m["offset"], m["brdf"])))
            row = {"model": "table", "file": file.name, "beyond": "constant", "wavelength": "1064 nm"}
        rows.append(row)
    return {"scatter": rows} | ({"specular": {"reflect": material.reflect}} if material.reflect else {})


def term_table(term, unit_):
    table = {k: v for k, v in term.items() if k in ("scale", "from", "axis")}
    if term.get("through"):
        table["through"] = [{k: {"frequency": f"{v['frequency']!r} Hz", "quality": v["quality"]}} for k, v in link_items(term["through"])]
    if "line" in term:
        at, width, rms = term["line"]
        table["line"] = {"at": f"{at!r} Hz", "width": f"{width!r} Hz", "rms": f"{rms!r} {unit_} rms"}
    elif "sine" in term:
        peak, at, phase = term["sine"]
        table["sine"] = {"amplitude": f"{peak!r} {unit_} peak", "frequency": f"{at!r} Hz", "phase": f"{phase!r} rad"}
    elif "power-law" in term:
        asd, at, exponent, low, high = term["power-law"]
        table["power-law"] = {"asd": f"{asd!r} {unit_}/sqrt(Hz)", "at": f"{at!r} Hz", "exponent": exponent,
                              "from": f"{low!r} Hz", "to": f"{high!r} Hz"}
    return table


def link_items(links):
    return [item for link in links for item in link.items()]


def body_table(body):
    motion = {str(c): [term_table(t, "rad" if c.startswith("r") else "m") for t in terms] for c, terms in body.terms.items()}
    for other, links in body.joins:
        motion[body.word] = other
        if links:
            motion["through"] = [{k: {"frequency": f"{v['frequency']!r} Hz", "quality": v["quality"]}} for k, v in link_items(links)]
    if not motion:
        return {"motion": "still"}
    if body.word != "follows" or not body.joins:
        motion["others"] = "still"
    return {"pivot": lengths(body.pivot), "motion": motion}
