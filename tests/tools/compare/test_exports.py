#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""VTK and GLB files of a run, read back with VTK and trimesh (scripts/setup --test). Usage: test_exports.py PROGRAM"""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PYTHON = SOURCE / "build/compare/bin/python"


def check(true, what):
    if not true:
        sys.exit(f"test_exports: {what}")


def straytrace(*words, folder):
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=folder, capture_output=True, text=True,
                          env=os.environ | {"STRAYTRACE_PYTHON": "/bin/false"})
    check(done.returncode == 0, f"{' '.join(map(str, words))}: {done.stderr}")


def polydata(file):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def check_vtk(folder):
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(folder / "vtk/straytrace.vtm"))
    reader.Update()
    scene = reader.GetOutput().GetBlock(0)
    names = [scene.GetMetaData(i).Get(vtk.vtkCompositeDataSet.NAME()) for i in range(scene.GetNumberOfBlocks())]
    check("baffles_in" in names and "ITM" in names, f"parts are called {names}")
    baffles = scene.GetBlock(names.index("baffles_in"))
    mass = vtk.vtkMassProperties()
    mass.SetInputData(baffles)
    area = 35 * np.pi * (0.6**2 - 0.495**2) / np.sin(np.radians(35))     # of 35 cones, as the example has them
    check(abs(mass.GetSurfaceArea() / area - 1) < 5e-3, f"35 baffles have {mass.GetSurfaceArea()} m^2, not {area}")
    check(abs(2 * mass.GetSurfaceArea() / area - 1) > 5e-3, "any area would do")                    # negative control
    paths = polydata(folder / "vtk/paths.vtp")
    points, cells = to_numpy(paths.GetPoints().GetData()), paths.GetCellData()
    check(points.dtype == np.float64, f"points are {points.dtype}")
    rows = {row["rank"]: row for row in csv.DictReader(
        line for line in (folder / "out/paths.csv").read_text().splitlines() if not line.startswith("#"))}
    route, h = to_numpy(cells.GetArray("route")), to_numpy(cells.GetArray("h 30 Hz"))
    check(len(route) > 50 and route[0] == 1, f"paths of routes {sorted(set(route))}")
    check(all(np.isclose(h[i], float(rows[str(r)]["h_30Hz"]), equal_nan=True) for i, r in enumerate(route)), "strain is not that of the table")
    mirror = points[to_numpy(paths.GetPointData().GetArray("event")) == 0]                  # where light leaves the mode
    sag = np.hypot(mirror[:, 0], mirror[:, 1])**2 / (2 * np.where(mirror[:, 2] < 1000, 1420, 1683))
    off = np.where(mirror[:, 2] < 1000, mirror[:, 2] - sag, 2999.8 - mirror[:, 2] - sag)
    check(np.abs(off).max() < 1e-6, f"paths begin {np.abs(off).max()} m off the mirrors")      # curved by 1420 and 1683 m


def check_glb(folder):
    scene = trimesh.load(folder / "scene.glb")
    low, high = scene.bounds
    check(np.allclose(low, [-0.6, -0.6, -1], atol=1e-3) and np.allclose(high, [0.6, 0.6, 3000.8], atol=1e-3), f"the box is {low} to {high}")
    nodes = list(scene.graph.nodes_geometry)
    check("baffles_in 35" in nodes and "ETM" in nodes, f"nodes are called {nodes[:5]}")
    _, name = scene.graph["ETM"]
    check(abs(scene.geometry[name].bounds).max() < 1, "the end mirror does not have an origin of its own")
    check(any("·S > " in n for n in nodes), "no paths")


NEAR = """straytrace: 1
materials: {grey: {scatter: {model: lambertian, tis: 1 %}}}
bodies: {b: {motion: still}}
beams: {probe: {from: [0 m, 0 m, -1 m], facing: [0, 0, 1], profile: point, power: 1 W}}
receivers: {far: {shape: {disk: {outer_radius: 1 m}}, at: [0 m, 0 m, 9 m], facing: [0, 0, -1]}}
scene:
  - {name: near, shape: {disk: {outer_radius: 10 mm}}, at: [3 mm, 0 m, 5 mm], body: b, material: grey}
"""


def check_places_near_the_origin(folder):
    """The writer of glTF leaves out translations of a few millimetres."""
    (folder / "near.yaml").write_text(NEAR, encoding="utf-8")
    straytrace("view", "near.yaml", "--glb", "near.glb", "--quiet", folder=folder)
    scene = trimesh.load(folder / "near.glb")
    place, name = scene.graph["near"]
    low, high = scene.geometry[name].bounds + place[:3, 3]
    check(np.allclose([low[0], high[0], low[2]], [-7e-3, 13e-3, 5e-3], atol=1e-4), f"a disc at [3, 0, 5] mm lies within {low} to {high}")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        straytrace("run", SOURCE / "examples/virgo_arm.yaml", "-o", "out", "--histories", 2**17, "--quiet", folder=folder)
        straytrace("view", "out/run.h5", "--vtk", "vtk", "--glb", "scene.glb", "--quiet", folder=folder)
        check(not (folder / "view.html").exists(), "a page was written without --html")
        check_vtk(folder)
        check_glb(folder)
        check_places_near_the_origin(folder)
    print("exports are in order")


if __name__ == "__main__":
    if not PYTHON.exists():
        sys.exit("test_exports: VTK and trimesh are not there: scripts/setup --test")
    if "STRAYTRACE_EXPORTS" not in os.environ:
        os.environ["STRAYTRACE_EXPORTS"] = "inside"
        os.execv(PYTHON, [str(PYTHON), *sys.argv])
    import numpy as np
    import trimesh
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy as to_numpy
    PROGRAM = pathlib.Path(sys.argv[1]).resolve()
    main()
