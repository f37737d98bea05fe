"""A slow, independent answer for the coupling of a route: eq. 1.2 by quadrature, levers by eq. 2.3 and 2.5.

Written from docs/theory alone; it shares no code with the program. Points of each route are drawn from scrambled Sobol
sequences, evenly over the area of each surface and by |u|^2 on the mirrors; the error is the spread of independent
scramblings.
"""
import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from surfaces import dot, first_hit, unit, visible


CONTROLS = ("cosine", "factor 2", "lever")     # wrong oracles, which a comparison must reject


class Answer:
    """Coupling of a route with its error, and a sample of its paths: weights and levers by body [rad/m, rad/rad]."""

    def __init__(self, batches, weight, levers, length):
        self.batches, self.weight, self.levers, self.length = batches, weight, levers, length

    @property
    def coupling(self):
        return mean_error(self.batches)

    def second_moment(self, direction):
        """<(J . direction)^2>, the mean over the light; direction: {body: six numbers}."""
        along = sum(self.levers[b] @ direction[b] for b in self.levers)
        return ratio_error((self.weight * along**2).reshape(len(self.batches), -1).mean(1), self.batches)


def mean_error(batches):
    return batches.mean(), batches.std(ddof=1) / np.sqrt(len(batches))


def ratio_error(above, below):
    """Ratio of two sums over equal, independent parts, and its error."""
    ratio, n = above.sum() / below.sum(), len(below)
    return ratio, np.sqrt(n / (n - 1) * ((above - ratio * below)**2).sum()) / abs(below.sum())


class Oracle:
    """Routes of a scene; `wrong`: one of CONTROLS."""

    def __init__(self, scene, batches=16, powers=(9, 11, 13), wrong=None):
        self.scene, self.count, self.powers, self.wrong = scene, batches, powers, wrong
        self.k = 2 * np.pi / scene.wavelength
        self.surfaces = [s for group in scene.groups.values() for s in group.surfaces]
        self.owner = np.array([i for i, g in enumerate(scene.groups.values()) for _ in g.surfaces])
        self.number = {name: i for i, name in enumerate(scene.groups)}

    def radius(self, mirror):
        """1/e^2 intensity radius of the mode on a mirror (eq. 6.3)."""
        a, b = (self.scene.groups[m].surfaces[0] for m in self.scene.mirrors)
        length = np.linalg.norm(b.at - a.at)
        g1, g2 = 1 - length / a.roc, 1 - length / b.roc
        if mirror == self.scene.mirrors[1]:
            g1, g2 = g2, g1
        return (self.scene.wavelength * length / np.pi * np.sqrt(g2 / (g1 * (1 - g1 * g2))))**0.5

    def on_mode(self, mirror, u):
        """Points by |u|^2; 0 beyond the edge of the mirror."""
        surface, w = self.scene.groups[mirror].surfaces[0], self.radius(mirror)
        x, y = w / 2 * ndtri(u[:, 0]), w / 2 * ndtri(u[:, 1])
        inside = np.hypot(x, y) <= surface.outer
        return surface.on_cap(np.where(inside, x, 0), np.where(inside, y, 0)), inside

    def mode_density(self, mirror, points):
        """|u|^2 on the mirror, per area across the beam (eq. 0.6, 1.1)."""
        surface, w = self.scene.groups[mirror].surfaces[0], self.radius(mirror)
        local = (points - surface.at) @ surface.frame.T
        return 2 / (np.pi * w * w) * np.exp(-2 * (local[:, 0]**2 + local[:, 1]**2) / w**2)

    def on_group(self, name, u):
        """Points that are uniform in area over the surfaces of a group, their normals, and the area."""
        group = self.scene.groups[name].surfaces
        areas = np.array([s.area() for s in group])
        edges = np.concatenate([[0], np.cumsum(areas) / areas.sum()])
        pick = np.minimum(np.searchsorted(edges, u[:, 0], side="right") - 1, len(group) - 1)
        points, normals, sides = np.empty((len(u), 3)), np.empty((len(u), 3)), np.empty(len(u), int)
        for i, surface in enumerate(group):
            here = pick == i
            points[here] = surface.sample((u[here, 0] - edges[i]) / (edges[i + 1] - edges[i]), u[here, 1])
            normals[here], sides[here] = surface.normal(points[here]), i
        return points, normals, sides, areas.sum()

    def scatter(self, name, sides, incoming, outgoing, normal):
        """BSDF at points of a group; 0 through the surface and on a side without material."""
        group = self.scene.groups[name]
        towards = -np.sign(dot(incoming, normal))
        value = group.material.bsdf(incoming, outgoing, normal * towards[:, None])
        lit = np.choose(sides, [s.lit(towards) for s in group.surfaces])
        return np.where(lit & (dot(outgoing, normal) * towards > 0), value, 0)

    def route(self, steps, seed, within=0.0):
        """Answer for steps [(group, 'S' or 'R'), ...] that begin and end on a mirror, with more points until its error
        is below `within`."""
        for power in self.powers:
            answer = self.quadrature(steps, [*seed, power], power)
            if answer.coupling[1] < within:
                break
        return answer

    def quadrature(self, steps, seed, power):
        dimensions = 4 + 2 * sum(1 for before, step in zip(steps, steps[1:-1]) if before[1] == "S")
        children = np.random.SeedSequence(seed).spawn(self.count)
        parts = [self.batch(steps, qmc.Sobol(dimensions, seed=np.random.default_rng(c)).random_base2(power))
                 for c in children]
        weight = np.concatenate([p[0] for p in parts])
        levers = {b: np.concatenate([p[1][b] for p in parts]) for b in parts[0][1]}
        return Answer(np.array([p[0].mean() for p in parts]), weight, levers, np.concatenate([p[2] for p in parts]))

    def batch(self, steps, u):
        scene, (name, _) = self.scene, steps[0]
        u = np.clip(u, 1e-12, 1 - 1e-12)
        x, weight = self.on_mode(name, u[:, :2])
        weight, used = weight.astype(float), 2
        normal, sides = scene.groups[name].surfaces[0].normal(x), np.zeros(len(x), int)
        incoming, length = -normal, np.zeros(len(x))     # the wavefront of the mode fits the mirror
        path = Levers(self, len(x))
        for i, ((here, event), (there, _)) in enumerate(zip(steps, steps[1:])):
            last = i == len(steps) - 2
            if event == "S":
                if last:
                    y, inside = self.on_mode(there, u[:, used:used + 2])
                    next_normal, next_sides = scene.groups[there].surfaces[0].normal(y), np.zeros(len(y), int)
                    weight = weight * inside
                else:
                    y, next_normal, next_sides, area = self.on_group(there, u[:, used:used + 2])
                    weight = weight * area
                used += 2
                outgoing, distance = unit(y - x), np.linalg.norm(y - x, axis=1)
                cosines = np.abs(dot(outgoing, normal) * (1 if self.wrong == "cosine" else dot(outgoing, next_normal)))
                weight = weight * self.scatter(here, sides, incoming, outgoing, normal) * cosines / distance**2
                weight = weight * visible(self.surfaces, x, y, scene.groups[here].surfaces[0] if here == there in scene.mirrors else None)
            else:
                weight, outgoing, y, next_normal, next_sides, distance = self.reflect(here, there, sides, x, incoming, normal, weight)
            path.add(here, x, incoming, outgoing)
            length = length + distance
            x, incoming, normal, sides = y, outgoing, next_normal, next_sides
        name, before = steps[-1][0], steps[-2][1]
        weight = weight * self.scatter(name, sides, incoming, normal, normal) * scene.wavelength**2
        if before == "R":
            weight = weight * self.mode_density(name, x)
        path.add(name, x, incoming, normal)
        return weight * (2 if self.wrong == "factor 2" else 1), path.relative(steps), length

    def reflect(self, here, there, sides, x, incoming, normal, weight):
        group = self.scene.groups[here]
        towards = -np.sign(dot(incoming, normal))
        lit = np.choose(sides, [s.lit(towards) for s in group.surfaces])
        outgoing = incoming - 2 * dot(incoming, normal)[:, None] * normal
        hit, distance = first_hit(self.surfaces, x, outgoing)
        reached = lit & (hit >= 0) & (self.owner[hit] == self.number[there])
        distance = np.where(reached, distance, 1.0)
        y = x + distance[:, None] * outgoing
        next_normal, next_sides = np.tile([0.0, 0.0, 1.0], (len(y), 1)), np.zeros(len(y), int)
        for i, surface in enumerate(self.scene.groups[there].surfaces):
            on = reached & (hit == self.surfaces.index(surface))
            next_normal[on], next_sides[on] = surface.normal(y[on]), i
        return weight * group.material.reflect * reached, outgoing, y, next_normal, next_sides, distance


class Levers:
    """Sums of eq. 2.3 for the bodies of a scene, relative to the main mode (eq. 2.5)."""

    def __init__(self, oracle, n):
        self.scene, self.k, self.wrong = oracle.scene, oracle.k, oracle.wrong
        self.sums = {b: np.zeros((n, 6)) for b in self.scene.bodies}

    def add(self, group, point, incoming, outgoing):
        kappa = self.k * (incoming - outgoing) * (0.9 if self.wrong == "lever" else 1)
        body = self.scene.groups[group].body
        self.sums[body] += np.hstack([kappa, np.cross(point - self.scene.bodies[body].pivot, kappa)])

    def relative(self, steps):
        """Without the terms of the main mode on the mirror it leaves and on the one it joins."""
        for mirror in {steps[0][0], steps[-1][0]}:
            surface, body = self.scene.groups[mirror].surfaces[0], self.scene.groups[mirror].body
            kappa = -2 * self.k * surface.axis
            self.sums[body] -= np.concatenate([kappa, np.cross(surface.at - self.scene.bodies[body].pivot, kappa)])
        return self.sums
