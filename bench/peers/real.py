# SPDX-License-Identifier: BSD-3-Clause
"""Problems of the trade, for agreement rather than speed: a bench from CAD with a lens, a tube with baffles, a cryotrap. Two receivers each."""
import dataclasses
import pathlib

from problems import BLACK, Disk, Finish, MIRROR, Problem, Square, Tube, lamp

STEP = pathlib.Path(__file__).resolve().parents[2] / "examples/data/cad_bench.step"
FRONT, BACK = (0, 0, 1), (0, 0, -1)


@dataclasses.dataclass(frozen=True)
class Lens:
    """Glass between two equal spheres that meet at the edge; both faces reflect by Fresnel."""
    name: str
    centre: tuple
    axis: tuple
    radius: float
    curvature_radius: float
    index: float

    @property
    def sag(self):
        return self.curvature_radius - (self.curvature_radius ** 2 - self.radius ** 2) ** 0.5


@dataclasses.dataclass(frozen=True)
class Cad:
    """A file of CAD; finishes by names of parts."""
    name: str
    file: pathlib.Path
    finishes: tuple                                      # (name of a part, finish)

    def parts(self):
        """(name, points in m, triangles, finish), by cascadio: 20 um from the faces."""
        import tempfile
        import cascadio
        import trimesh
        with tempfile.TemporaryDirectory() as folder:
            cascadio.step_to_glb(str(self.file), f"{folder}/parts.glb", tol_linear=0.02, tol_angular=0.05)
            scene = trimesh.load(f"{folder}/parts.glb")
        for i, node in enumerate(scene.graph.nodes_geometry):
            place, name = scene.graph[node]
            body = scene.geometry[name].copy()
            body.apply_transform(place)
            finish = next(finish for part, finish in self.finishes if name.startswith(part))
            yield f"{self.name}_{i}", list(map(tuple, body.vertices.tolist())), list(map(tuple, body.faces.tolist())), finish


def bench(receiver):
    """The lamp stands on the bench and faces a lens in its mount, behind which a mirror folds the light."""
    finishes = (("breadboard", Finish(0.1)), ("mount", Finish(0.4)), ("post", Finish(0.4)), ("mirror", MIRROR), ("dump", Finish(0.05)))
    lens = Lens("lens", (0.05, 0.03, 0.1), (-1, 0, 0), 0.0254, 0.1, 1.45)
    mount = Disk("mount_lens", lens.centre, (-1, 0, 0), 0.04, Finish(0.4), 0.0255)
    return Problem(lamp((0.12, 0.04, 0.1), (-1, 0, 0), 0.01), receiver, (Cad("cad", STEP, finishes), lens, mount))


def bench_behind():
    return bench(Square((-0.1, 0.03, 0.1), (1, 0, 0), 0.03))


def bench_table():
    return bench(Square((-0.05, -0.1, 0.02), FRONT, 0.04))


def baffles(receiver):
    """20 m of tube with a baffle every 1.5 m; a mirror of 35 cm that scatters at one end."""
    rings = [Disk(f"baffle{i}", (0, 0, 1.5 * (i + 1)), FRONT, 0.6, Finish(0.02), 0.5) for i in range(12)]
    return Problem(lamp((0, 0, 0.01), FRONT, 0.175), receiver, (Tube("wall", 0.0, 20.0, 0.6, Finish(0.3)), *rings))


def baffles_mirror():
    return baffles(Square((0, 0, 19.99), BACK, 0.3))


def baffles_wall():
    return baffles(Square((0.58, 0, 5.25), (-1, 0, 0), 0.1))


def trap(receiver):
    """A cryotrap between two tubes, with the sizes of library/parts/vacuum.yaml: its wall is of aluminium, mostly specular."""
    aluminium = Finish(0.247, specular=0.71)
    steel = Finish(0.0094)
    return Problem(lamp((0, 0, 0.01), FRONT, 0.175), receiver, (
        Tube("before", 0.0, 3.0, 0.5, Finish(0.395)), Disk("first_ring", (0, 0, 3.0), FRONT, 0.75, steel, 0.5),
        Tube("wall", 3.0, 7.0, 0.75, aluminium), Disk("last_ring", (0, 0, 7.0), FRONT, 0.75, steel, 0.5),
        Tube("after", 7.0, 10.0, 0.5, Finish(0.395)), Disk("shade", (0, 0, 5.0), FRONT, 0.3, BLACK)))


def trap_mirror():
    return trap(Square((0, 0, 9.99), BACK, 0.3))


def trap_wall():
    return trap(Square((0.73, 0, 5.6), (-1, 0, 0), 0.1))


REAL = {f.__name__: f for f in (bench_behind, bench_table, baffles_mirror, baffles_wall, trap_mirror, trap_wall)}
