#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A few random scenes against the oracle of tools/blind, and changes of a scene that must not change its results."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from scipy import stats

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools/blind"))
from blind import summary  # noqa: E402
from compare import compare  # noqa: E402
from coverage import agrees, covered  # noqa: E402
from oracle import CONTROLS, Oracle  # noqa: E402
from scenes import Scene  # noqa: E402

PROGRAM = sys.argv[1]


def check_closed_forms():
    """The oracle itself: a Lambertian mirror that sees itself has lambda^2 beta^2 / 4R^2 (eq. 1.2, G of a sphere)."""
    scene = next(s for s in map(Scene, range(100)) if s.groups["A"].material.models[0]["model"] == "lambertian")
    (model,), surface = scene.groups["A"].material.models, scene.groups["A"].surfaces[0]
    expected = (scene.wavelength * model["brdf"] / (2 * surface.roc))**2
    obtained, _ = Oracle(scene).route([("A", "S"), ("A", "S")], [1]).coupling
    assert abs(obtained / expected - 1) < 1e-3, (obtained, expected)


def check_random_scenes():
    """chi^2 of all pulls; a missing cosine, a factor 2 and phase sensitivities 10 % too low are rejected."""
    pulls = {control: [] for control in (None, *CONTROLS)}
    for seed in SEEDS:
        found, _ = compare(PROGRAM, seed, 16384, CONTROLS)
        for control, values in found.items():
            pulls[control] += values
    result = summary(pulls, [], 0)
    squares = [p["pull"]**2 for p in pulls[None]]
    assert len(squares) > 8, squares
    assert stats.chi2.sf(sum(squares), len(squares)) > 1e-4, result["worst"]
    for control in CONTROLS:
        assert result["controls"][control]["rejected"], f"control {control}: {result['controls'][control]}"


SEEDS = (2,)
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def arm(turn=np.eye(3), shift=(0, 0, 0), unit=("m", 1), names="AB xyz", backwards=False):
    """An arm with three objects whose motion is the same along all axes."""
    name = dict(zip(("A", "B", "ring", "tube", "plate"), names.replace(" ", "")))
    length = [f"{x * unit[1]!r} {unit[0]}" for x in (0.125, 256.0, 192.0, 0.25, 0.5, 0.375, 16.0)]
    mirror, roc, span, hole, edge, tube, half = length

    def entry(key, at, facing, body, material, side, **more):
        place = turn @ np.array(at, float) + np.array(shift, float)
        return {"name": name[key], "at": [f"{float(x) * unit[1]!r} {unit[0]}" for x in place], "facing": (turn @ np.array(facing, float)).tolist(),
                "body": body, "material": material, "side": side, **more}

    scene = [entry("A", (0, 0, 0), (0, 0, 1), "mirrors", "hr", "front", use="mirror", radius=mirror, radius_of_curvature=roc),
             entry("B", (0, 0, 192), (0, 0, -1), "mirrors", "hr", "front", use="mirror", radius=mirror, radius_of_curvature=roc),
             entry("ring", (0.03125, 0, 48), (0.125, 0, -1), "shaken", "steel", "both", shape={"disk": {"inner_radius": hole, "outer_radius": edge}}),
             entry("tube", (0, 0, 96), (0, 0, 1), "shaken", "steel", "inner", shape={"cylinder": {"radius": tube, "from": "-" + half, "to": half}}),
             entry("plate", (0.5, 0.25, 150), (0.25, 0, 1), "shaken", "black", "both", shape={"disk": {"outer_radius": hole}})]
    motion = {"z": {"line": {"at": "0.8 Hz", "width": "0.1 Hz", "rms": "1 um rms"}}, "x": {"like": "z"}, "y": {"like": "z"}}
    tables = {"materials": {"hr": {"specular": {"reflect": 0.99}, "scatter": [{"model": "lambertian", "brdf": "1e-5 /sr"}]},
                            "steel": {"scatter": {"model": "lambertian", "brdf": "0.01 /sr"}},
                            "black": {"scatter": {"model": "harvey", "b0": "0.1 /sr", "l": 0.1, "s": -2}}},
              "bodies": {"mirrors": {"motion": "still"}, "shaken": {"motion": motion}}, "scene": scene,
              "beams": {"arm": {"cavity": [name["A"], name["B"]], "power": "1 kW"}},
              "ports": {name[m]: {"beam": "arm", "at": name[m]} for m in "AB"}, "ghosts": "off",
              "interferometer": {"preset": "fabry-perot-michelson", "arm_length": span, "mirror_mass": "10 kg", "input_transmission": 0.014},
              "noise": {"band": ["5 Hz", "50 Hz"], "points_per_decade": 4}}
    if backwards:
        tables = {k: v if not isinstance(v, (dict, list)) else v[::-1] if isinstance(v, list) else dict(reversed(v.items()))
                  for k, v in reversed(tables.items())}
    return json.dumps({"straytrace": 1, **tables})


def traced(folder, text, threads=1):
    """Couplings by route, with the names of the first drawing, and h."""
    file, result = folder / "arm.yaml", folder / "run.h5"
    file.write_text(text, encoding="utf-8")
    subprocess.run([PROGRAM, "run", str(file), "-o", str(result), "--quiet", "--force", "--threads", str(threads), "--histories", "8192"],
                   check=True, timeout=120, stdout=subprocess.DEVNULL)
    with h5py.File(result) as run:
        table = run["classes"]
        columns = (table[k][:] for k in ("name", "mean", "std_error", "trusted"))
        rows = {name.decode(): (mean, error) for name, mean, error, good in zip(*columns) if good and not name.startswith(b"other")}
        return rows, run["noise/total/mean"][:], run["noise/total/sigma"][:]


def check_invariance():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        rows, h, error = traced(folder, arm())
        assert len(rows) > 8 and (h > 0).all()
        others, other_h, _ = traced(folder, arm(unit=("mm", 1000), names="CD uvw"), threads=2)
        assert sorted(others.values()) == sorted(rows.values()) and (other_h == h).all(), "threads, units or names change bits"
        others, other_h, other_error = traced(folder, arm(TURN, (64, -32, 1024), backwards=True))
        far = [abs(v[0] - rows[k][0]) / math.hypot(v[1], rows[k][1]) for k, v in others.items() if k in rows]
        assert len(far) > 8 and max(far) < 5, f"frame or order of entries: {max(far):.2f} standard errors"
        assert (abs(other_h - h) < 5 * np.hypot(error, other_error)).all(), "frame or order of entries change h"
        wrong, wrong_h, _ = traced(folder, arm().replace("0.01 /sr", "0.0106 /sr"))      # control: 6 % of one surface
        assert max(abs(v[0] - rows[k][0]) / v[1] for k, v in wrong.items() if k in rows) > 5


def check_criterion_of_coverage():
    """Student pulls of 32 blocks hold, also where all of a few are within two errors; errors half as large again or a third
    too small do not."""
    draws = stats.t(31).rvs((40, 20), random_state=7)
    assert agrees(covered(draws)), covered(draws)
    few = np.full((4, 20), 0.5)
    few[0, :20], few[1, :20] = 1.5, 1.7                        # one error: 50 %; two errors: 100 %, without scatter
    few[:, ::3] = 0.5
    shares = covered(few)
    assert shares[1][0] == 1 and agrees(shares), shares
    assert not agrees(covered(draws / 1.5)) and not agrees(covered(draws * 1.5)), "control: wrong errors"
    assert not agrees(covered(np.full((40, 20), 0.5))), "control: errors far too large"


for check in (check_closed_forms, check_random_scenes, check_criterion_of_coverage, check_invariance):
    check()
print("ok")
