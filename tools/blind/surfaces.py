"""Surfaces and scatter of the oracle, from the definitions in docs/reference/shapes and docs/theory/surfaces.md.

Points and directions are arrays [n, 3] in the coordinates of the scene. The normal of a surface points to its front or
inner side, of a sphere to its outside.
"""
import numpy as np

EARLY = 1e-9   # share of a segment around its ends in which a surface does not block it


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a, b):
    return np.einsum("...i,...i", a, b)


class Surface:
    """A shape with its place: `kind` and sizes as in a scene."""

    def __init__(self, kind, at, axis, side="both", **sizes):
        self.kind, self.at, self.axis, self.side = kind, np.asarray(at, float), unit(np.asarray(axis, float)), side
        self.__dict__.update(sizes)
        other = np.eye(3)[np.argmin(np.abs(self.axis))]
        first = unit(np.cross(self.axis, other))
        self.frame = np.array([first, np.cross(self.axis, first), self.axis])

    def area(self):
        if self.kind == "disk":
            return np.pi * (self.outer**2 - self.inner**2)
        if self.kind == "cap":      # part of a sphere: 2 pi R times its height
            return 2 * np.pi * self.outer**2 / (1 + np.sqrt(1 - (self.outer / self.roc)**2))
        if self.kind == "cylinder":
            return 2 * np.pi * self.radius * (self.end - self.start)
        if self.kind == "cone":
            return np.pi * (self.outer**2 - self.inner**2) / np.sin(self.half_angle)
        return 4 * np.pi * self.radius**2

    def sample(self, u, v):
        """Points that are uniform in area, from two numbers between 0 and 1."""
        turn = 2 * np.pi * v
        if self.kind == "cylinder":
            rho, z = np.full_like(u, self.radius), self.start + u * (self.end - self.start)
        elif self.kind == "sphere":
            z = self.radius * (2 * u - 1)
            rho = np.sqrt(self.radius**2 - z**2)
        elif self.kind == "cap":    # equal areas have equal heights (Archimedes)
            z = u * self.outer**2 / self.roc / (1 + np.sqrt(1 - (self.outer / self.roc)**2))
            rho = np.sqrt(z * (2 * self.roc - z))
        else:
            rho = np.sqrt(self.inner**2 + u * (self.outer**2 - self.inner**2))
            z = (rho - self.inner) / np.tan(self.half_angle) if self.kind == "cone" else np.zeros_like(rho)
        return self.at + np.stack([rho * np.cos(turn), rho * np.sin(turn), z], -1) @ self.frame

    def on_cap(self, x, y):
        """Points of a cap at x, y across its axis."""
        rho2 = x**2 + y**2
        z = rho2 / self.roc / (1 + np.sqrt(1 - np.minimum(rho2 / self.roc**2, 1)))
        return self.at + np.stack([x, y, z], -1) @ self.frame

    def normal(self, points):
        local = (points - self.at) @ self.frame.T
        if self.kind == "disk":
            return np.broadcast_to(self.axis, points.shape)
        if self.kind == "cap":
            n = np.array([0, 0, self.roc]) - local
        elif self.kind == "sphere":
            n = local
        else:
            n = -unit(local * [1, 1, 0])
            if self.kind == "cone":
                n = n * np.cos(self.half_angle) + np.array([0, 0, np.sin(self.half_angle)])
        return unit(n) @ self.frame

    def crossings(self, start, step):
        """Both t at which start + t step meets the surface; nan where it does not."""
        p, d = (start - self.at) @ self.frame.T, step @ self.frame.T
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.kind == "disk":
                t = (-p[:, 2] / d[:, 2])[None]
                rho = np.hypot(p[:, 0] + t * d[:, 0], p[:, 1] + t * d[:, 1])
                return np.where((rho >= self.inner) & (rho <= self.outer), t, np.nan)
            if self.kind in ("cap", "sphere"):
                q = p - ([0, 0, self.roc] if self.kind == "cap" else [0, 0, 0])
                a, b, c = dot(d, d), dot(q, d), dot(q, q) - (self.roc if self.kind == "cap" else self.radius)**2
            else:
                slope = np.tan(self.half_angle) if self.kind == "cone" else 0.0
                base = self.inner if self.kind == "cone" else self.radius
                r, dr = base + p[:, 2] * slope, d[:, 2] * slope
                a = d[:, 0]**2 + d[:, 1]**2 - dr**2
                b = p[:, 0] * d[:, 0] + p[:, 1] * d[:, 1] - r * dr
                c = p[:, 0]**2 + p[:, 1]**2 - r**2
            root = np.sqrt(b * b - a * c)
            far = -(b + np.copysign(root, b))
            t = np.stack([far / a, c / far])
            z = p[:, 2] + t * d[:, 2]
            if self.kind == "sphere":
                return t
            if self.kind == "cap":
                rho = np.hypot(p[:, 0] + t * d[:, 0], p[:, 1] + t * d[:, 1])
                return np.where((rho <= self.outer) & (z < self.roc), t, np.nan)
            low, high = ((0, (self.outer - self.inner) / np.tan(self.half_angle)) if self.kind == "cone"
                         else (self.start, self.end))
            return np.where((z >= low) & (z <= high), t, np.nan)

    def lit(self, cosine):
        """Whether the side towards cosine = direction away from the surface . normal has the material."""
        front = {"front": 1, "inner": -1 if self.kind == "sphere" else 1, "outer": 1 if self.kind == "sphere" else -1,
                 "back": -1, "both": 0}[self.side]
        return cosine * front >= 0


def visible(surfaces, start, end, but=None):
    """Whether nothing lies between two points; `but`: a spherical surface that holds both, and meets the line nowhere else."""
    step, clear = end - start, np.ones(len(start), bool)
    for surface in surfaces:
        if surface is but:
            continue
        t = surface.crossings(start, step)
        clear &= ~((t > EARLY) & (t < 1 - EARLY)).any(0)
    return clear


def first_hit(surfaces, start, direction):
    """Index of the surface that each ray meets first (-1: none) and the distance."""
    index, nearest = np.full(len(start), -1), np.full(len(start), np.inf)
    for i, surface in enumerate(surfaces):
        t = surface.crossings(start, direction)
        t = np.nanmin(np.where(t > 1e-6, t, np.inf), 0, initial=np.inf)
        closer = t < nearest
        index[closer], nearest[closer] = i, t[closer]
    return index, nearest


class Material:
    """Power reflectance and the sum of BSDF models (eq. 3.3, 3.14, 3.16, 3.18; reference of 'table')."""

    def __init__(self, reflect, models):
        self.reflect, self.models = reflect, models

    def bsdf(self, incoming, outgoing, normal):
        """Both directions along the propagation; `normal` on the side of the light."""
        mirrored = incoming - 2 * dot(incoming, normal)[:, None] * normal
        change = outgoing - mirrored
        angle = 2 * np.arcsin(np.minimum(np.linalg.norm(change, axis=1) / 2, 1))
        across = change - dot(change, normal)[:, None] * normal
        offset = np.linalg.norm(across, axis=1)
        return sum((self.value(m, angle, offset) for m in self.models), np.zeros(len(angle)))

    @staticmethod
    def value(m, angle, offset):
        kind = m["model"]
        if kind == "lambertian":
            return np.full_like(angle, m["brdf"])
        if kind == "power-law":
            return np.where(angle >= m["above"], m["kappa"] * np.maximum(angle, m["above"])**-m["exponent"], 0)
        if kind == "abg":
            return m["a"] / (m["b"] + offset**m["g"])
        if kind == "harvey":
            return m["b0"] * (1 + (offset / m["l"])**2)**(m["s"] / 2)
        points = np.log(m["offset"])           # table: log of the BSDF linear in the log of the offset
        return np.exp(np.interp(np.log(np.maximum(offset, 1e-300)), points, np.log(m["brdf"])))
