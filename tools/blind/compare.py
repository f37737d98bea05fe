"""One random scene: run the program, ask the oracle, and return the differences in units of both errors (pulls)."""
import pathlib
import subprocess
import tempfile

import h5py
import numpy as np

from motion import strain
from oracle import Oracle, ratio_error
from scenes import Scene

HISTORIES, TIMEOUT = 65536, 600
ROUTES, SPECTRA = 8, 1         # per scene
VERTICES = 4                   # longest route
RESOLVED = 0.1                 # largest error of the oracle


def run(program, scene, folder, histories, options=()):
    """The run file of a scene."""
    file, result = folder / "scene.yaml", folder / "run.h5"
    file.write_text(scene.yaml(folder), encoding="utf-8")
    command = [program, "run", str(file), "-o", str(result), "--quiet", "--threads", "1", "--histories", str(histories),
               "--seed", str(scene.seed + 1), *options]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT)
    except subprocess.TimeoutExpired as late:
        raise RuntimeError(f"scene {scene.seed}: no end after {TIMEOUT} s") from late
    if done.returncode:
        raise RuntimeError(f"scene {scene.seed}: {done.stderr.strip()[:2000]}")
    return result


def steps_of(name):
    """[(group, event), ...] of 'A·S > x·R > B·S'; None for a row 'other'."""
    steps = [tuple(step.rsplit("·", 1)) for step in name.split(" > ")]
    return steps if all(len(s) == 2 for s in steps) else None


def rows(result):
    """Resolved routes of a run file that were sampled themselves."""
    with h5py.File(result) as file:
        table, noise, levers = file["classes"], file["noise"], file["phase_sensitivities"]
        bodies = [b.decode() for b in file["names/bodies"][:]]
        edges = noise["frequency_edges"][:]
        column = {k: table[k][:] for k in ("name", "mean", "std_error", "trusted", "by_reverse", "reverse", "kind")}
        light = table["replica_sum"][:] / file.attrs["histories"]
        mean, sigma = noise["routes/mean"][:], noise["routes/sigma"][:]
        moments = [levers[k][:] for k in ("class", "product_replica", "product_body", "product")]
    for i, name in enumerate(column["name"]):
        steps = steps_of(name.decode())
        if not column["trusted"][i] or column["by_reverse"][i] or column["kind"][i] or steps is None or len(steps) > VERTICES:
            continue
        of = moments[0] == i
        yield {"name": name.decode(), "steps": steps, "mean": column["mean"][i],
               "error": column["std_error"][i],
               "reverse": column["reverse"][i], "edges": edges, "h": mean[i], "h_error": sigma[i],
               "light": light[i], "moments": [m[of] for m in moments[1:]],
               "bodies": bodies}


def along(row, direction):
    """<(J . direction)^2>, the mean over the light, from the sums of a run file."""
    replicas = np.zeros(32)
    for replica, pair, product in zip(*row["moments"]):
        first, second = (direction[row["bodies"][b]] for b in pair)
        replicas[replica] += (1 if pair[0] == pair[1] else 2) * first @ product.reshape(6, 6) @ second
    return ratio_error(replicas, row["light"])


def through_objects(steps, scene):
    """Whether all vertices but the ends lie on objects: the phase of such a route against the mode is unambiguous."""
    return len(steps) > 2 and not any(group in scene.mirrors for group, _ in steps[1:-1])


def chosen(found, scene, rng):
    first = [r for r in found if len(r["steps"]) == 3 and through_objects(r["steps"], scene)]
    others = [r for r in found if r not in first]
    order = [first[i] for i in rng.permutation(len(first))] + [others[i] for i in rng.permutation(len(others))]
    return order[:ROUTES]


def pull(kind, route, found, error, expected, its_error, scene):
    return {"kind": kind, "scene": scene.seed, "route": route, "obtained": float(found), "error": float(error), "expected": float(expected),
            "oracle_error": float(its_error), "pull": float((found - expected) / np.hypot(error, its_error))}


def compare(program, seed, histories=HISTORIES, wrong=()):
    """{None: pulls of a scene, control: its pulls against a wrong oracle}, and how many routes the oracle left out."""
    scene, left_out = Scene(seed), 0
    rng = np.random.default_rng([3141, seed])
    with tempfile.TemporaryDirectory() as folder:
        found = chosen(list(rows(run(program, scene, pathlib.Path(folder), histories))), scene, rng)
    direction = {b: rng.standard_normal(6) * ([1, 1, 1, 0, 0, 0] if "object" not in b else 1) for b in scene.bodies}
    pulls = {control: [] for control in (None, *wrong)}
    for control, kept in pulls.items():
        oracle, spectra = Oracle(scene, wrong=control), SPECTRA if control is None else 0
        for number, row in enumerate(found if control is None else found[:3]):
            answer = oracle.route(row["steps"], [seed, number], row["error"] / 5)
            expected, its_error = answer.coupling
            if not its_error < RESOLVED * expected:
                left_out += control is None
                continue
            kept.append(pull("coupling", row["name"], row["mean"], row["error"], expected, its_error, scene))
            if not through_objects(row["steps"], scene) or not len(row["moments"][0]):
                continue
            levers, its_levers = along(row, direction), answer.second_moment(direction)
            if levers[1] + its_levers[1] > 1e-6 * its_levers[0]:     # else all paths have one lever, without error
                kept.append(pull("levers", row["name"], *levers, *its_levers, scene))
            if spectra > 0 and row["h"].any():
                spectra -= 1
                kept += spectrum(scene, row, answer, [seed, number, 1], rng)
    return pulls, left_out


def spectrum(scene, row, answer, seed, rng):
    """One pull of the PSD of h, in a bin drawn from those that can be compared."""
    expected, its_error, usable = strain(scene, answer, row["reverse"], row["edges"], seed)
    usable &= (its_error < RESOLVED * expected) & np.isfinite(row["h_error"])
    if not usable.any():
        return []
    i = rng.choice(np.flatnonzero(usable))
    part = its_error[i] / expected[i], answer.coupling[1] / answer.coupling[0]
    found = pull("strain", f"{row['name']}, {np.sqrt(row['edges'][i] * row['edges'][i + 1]):.3g} Hz", row["h"][i]**2,
                 2 * row["h"][i] * row["h_error"][i], expected[i], expected[i] * np.hypot(*part), scene)
    return [found]
