"""Light of a lamp on receivers of three scenes (bench/peers/real.py) against Mitsuba 3 and Raysect, with the errors of both."""
import concurrent.futures
import dataclasses
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
from scipy import stats

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "bench/peers"))
import real  # noqa: E402
import straytrace_scene  # noqa: E402
from problems import Finish, Tube  # noqa: E402

CODES = {"Mitsuba 3": ["run_mitsuba.py", "--way", "scalar_rgb:path"], "Raysect": ["run_raysect.py"]}
TRACER = "tracer of this case"                           # for the receiver whose other values have been in doubt
WRONG = {  # what a wrong scene has in place of a surface
    "bench_behind": (real.Lens, {"index": 1.5}),
    "baffles_wall": (Tube, {"finish": Finish(0.4)}),
    "trap_wall": (Tube, {"finish": Finish(0.247, specular=0.6)}),
}


def ours(program, problem, histories):
    """(value, error) per W of the lamp."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.yaml"
        file.write_text(straytrace_scene.scene(problem, Path(folder)), encoding="utf-8")
        run = file.with_suffix(".h5")
        subprocess.run([program, "trace", file, "-o", run, "--histories", str(histories), "--threads", "1", "--quiet"], check=True, capture_output=True)
        with h5py.File(run) as found:
            return tuple(float(found["receivers"][key][0]) / straytrace_scene.DIM for key in ("mean", "std_error"))


def theirs(name, words, seconds):
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, SOURCE / "bench/peers" / words[0], name, *words[1:], "--folder", folder, "--seconds", str(seconds)],
                              check=True, capture_output=True, text=True)
        found = json.loads(done.stdout.splitlines()[-1])
        return found["value"], found["error"]


def traced(paths):
    """(value, error) of trap_wall by tools/codes/trap.cpp."""
    with tempfile.TemporaryDirectory() as folder:
        binary = Path(folder) / "trap"
        subprocess.run(["c++", "-std=c++20", "-O3", "-o", binary, Path(__file__).parent / "trap.cpp"], check=True, capture_output=True)
        return tuple(map(float, subprocess.run([binary, "1", str(paths)], check=True, capture_output=True, text=True).stdout.split()))


def wrong(name):
    """The scene with the first surface of a kind changed; of a trap the wall, which its finish names."""
    kind, change = WRONG[name]
    problem = real.REAL[name]()
    def fits(s):
        return isinstance(s, kind) and s.name in ("wall", "lens")
    return dataclasses.replace(problem, surfaces=tuple(dataclasses.replace(s, **change) if fits(s) else s for s in problem.surfaces))


def pull(one, other):
    return (one[0] - other[0]) / math.hypot(one[1], other[1])


def measure(program, d):
    """{receiver: {code: (value, error)}}; "straytrace" and "wrong" are ours."""
    tasks = {}
    with concurrent.futures.ThreadPoolExecutor(d["jobs"]) as pool:
        for name, make in real.REAL.items():
            tasks[name, "straytrace"] = pool.submit(ours, program, make(), d["histories"])
            if name in WRONG:
                tasks[name, "wrong"] = pool.submit(ours, program, wrong(name), d["histories"])
            for code, words in CODES.items():
                tasks[name, code] = pool.submit(theirs, name, words, d["seconds"])
        tasks["trap_wall", TRACER] = pool.submit(traced, d["tracer_paths"])
        found = {}
        for (name, code), task in tasks.items():
            found.setdefault(name, {})[code] = task.result()
            print(f"{name}, {code}: {found[name][code][0]:.4g} ± {found[name][code][1]:.1g}", file=sys.stderr, flush=True)
    return found


def draw(axis, found):
    for i, code in enumerate((*CODES, TRACER)):
        for k, values in enumerate(found.values()):
            if code not in values:
                continue
            mean, error = values["straytrace"]
            other, theirs_error = values[code]
            axis.errorbar(k + 0.16 * i - 0.16, mean / other, math.hypot(error / other, mean * theirs_error / other ** 2), fmt="o", color=f"C{i}", capsize=3,
                          label=code if not k or code == TRACER else None)
    axis.axhline(1, color="#444444", linewidth=0.8)
    axis.set_xticks(range(len(found)), [name.replace("_", "\n") for name in found])
    axis.set_ylabel("straytrace / other code")
    axis.legend(fontsize=8)


def run(program, d):
    """(lines of the page, function that draws, whether all agree, controls)."""
    found = measure(program, d)
    lines = ["| receiver | straytrace, share of the lamp | code | its value | ratio | pull | verdict |", "| --- | --- | --- | --- | --- | --- | --- |"]
    pulls, controls = [], {}
    for name, values in found.items():
        mean, error = values["straytrace"]
        for code in (c for c in (*CODES, TRACER) if c in values):
            other, theirs_error = values[code]
            pulls.append(pull(values["straytrace"], values[code]))
            lines.append(f"| `{name}` | {mean:.4g} ± {error:.1g} | {code} | {other:.4g} ± {theirs_error:.1g} | {mean / other:.3f} ± "
                         f"{math.hypot(error / other, mean * theirs_error / other ** 2):.3f} | {pulls[-1]:+.2f} | "
                         f"{'agrees' if abs(pulls[-1]) < d['pull'] else '**disagrees**'} |")
        if "wrong" in values:
            controls[f"`{name}`: {d['wrong'][name]}"] = any(abs(pull(values["wrong"], values[code])) > d["pull"] for code in CODES)
    chi2 = sum(p * p for p in pulls)
    probability = stats.chi2.sf(chi2, len(pulls))
    lines += ["", f"Sum of squared pulls {chi2:.1f} for {len(pulls)}, p = {probability:.2f}."]
    return lines, lambda axis: draw(axis, found), bool(max(map(abs, pulls)) < d["pull"] and probability > d["probability"]), controls
