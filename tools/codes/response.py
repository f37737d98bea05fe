"""h per metre of a scatterer, traced and projected, against FINESSE 3 with a weak mirror or a pick-off that moves.

The scene holds one diffuse disk in a beam; its recoupled fraction is traced (eq. 1.4), placed at a port of Advanced Virgo and moved by white
noise. FINESSE solves the whole detector with the scatterer inside it, at static positions over a wave, and is calibrated by its own DARM.
"""
import math
import subprocess
import tempfile
from pathlib import Path

import finesse
import h5py
import numpy as np
from finesse.analysis.actions import FrequencyResponse

SCENE = """straytrace: 1
title: A weak scatterer at one place of Advanced Virgo
params: {{w: {w} m, fraction: {fraction}, pi: 3.141592653589793}}
materials: {{face: {{scatter: {{model: lambertian, brdf: fraction*pi*(w/{wavelength} m)^2*(1 /sr)}}}}}}
bodies: {{bench: {{motion: {{x: {{asd: flat.txt, columns: [Hz, m/sqrt(Hz)]}}, others: still}}}}}}
scene:
  - {{name: face, shape: {{disk: {{outer_radius: 5 mm}}}}, side: front, facing: [-1, 0, 0], body: bench, material: face}}
beams: {{out: {{on: face, radius: w, travel: [1, 0, 0]}}}}
ports: {{port: {{beam: out, at: face}}}}
interferometer: {{preset: adv, ports: {{port: {{at: {at}, copies: 1}}}}}}
trace: {{histories: {histories}, seed: {seed}}}
noise: {{band: [{low} Hz, {high} Hz], points_per_decade: {points}{phase}}}
"""
WAVE = 45                                                # deg of tuning: a quarter turn of the stray light, 2 x 45 deg


def traced(program, d, place, phase=None, seed=1):
    """(Hz, h per m, its error) of straytrace; without a phase the rms over all."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "flat.txt").write_text(f"0.1 {d['motion']}\n1e5 {d['motion']}\n", encoding="utf-8")
        (folder / "s.yaml").write_text(SCENE.format(
            w=d["beam_radius"], wavelength=d["detector"]["wavelength"], low=d["band"][0], high=d["band"][1], points=d["points_per_decade"], seed=seed,
            histories=d["histories"], phase="" if phase is None else f", static_phase: {{bench: {phase} deg}}", **place), encoding="utf-8")
        subprocess.run([program, "run", folder / "s.yaml", "-o", folder / "s.h5", "--quiet"], check=True, capture_output=True)
        with h5py.File(folder / "s.h5") as file:
            return file["noise/frequency"][:], file["noise/total/mean"][:] / d["motion"], file["noise/total/sigma"][:] / d["motion"]


def detector(d, at, fraction):
    """Advanced Virgo in FINESSE. A mirror of FINESSE at phi is displaced by -phi/360 of a wavelength; spaces are whole wavelengths."""
    end_loss = d["round_trip_loss"] * (1 - d["ETM"])
    turned = {"short-arm": "x", "signal-cavity": "SRM"}.get(at)      # what stands behind a pick-off, which transmits i t both ways
    lines = ["modes(off)", f"lambda({d['wavelength']})", f"l laser P={d['power']}",
             f"m PRM T={d['PRM']} L=0", "bs BS T=0.5 L=0 alpha=45", f"m SRM T={d['SRM']} L=0 phi={90 * (turned == 'SRM')}",
             "s input laser.p1 PRM.p1", f"s recycling PRM.p2 BS.p1 L={d['power_recycling']}"]
    for arm, sign, dark in (("x", 1, 0), ("y", -1, 90)):
        dark += 90 * (turned == arm)
        offset = -sign * d["offset"] / 2 / d["wavelength"] * 360
        lines += [f"m ITM{arm} T={d['ITM']} L=0 phi={dark}", f"m ETM{arm} T={d['ETM']} L={end_loss!r} phi={dark + offset!r}",
                  f"s arm{arm} ITM{arm}.p2 ETM{arm}.p1 L={d['arm']}",
                  f"free_mass mi{arm} ITM{arm}.mech mass={d['mass']}", f"free_mass me{arm} ETM{arm}.mech mass={d['mass']}"]
    short = {arm: d["short_arm"] + sign * d["schnupp"] / 2 for arm, sign in (("x", 1), ("y", -1))}
    lines.append(f"s shorty BS.p2 ITMy.p1 L={short['y']}")
    pick = math.sqrt(fraction)                           # of power: passed twice
    joined = {"short-arm": ("BS.p3", "ITMx.p1", short["x"]), "signal-cavity": ("BS.p4", "SRM.p1", d["signal_recycling"])}
    for place, (near, far, length) in joined.items():
        if place != at:
            lines.append(f"s to_{far[:3]} {near} {far} L={length}")
            continue
        # Light from the far side is reflected to p4 of the pick-off, returned there, and reflected back to the far side.
        lines += [f"bs pick R={pick!r} T={1 - pick!r} alpha=45", "m face R=1 T=0",
                  f"s to_pick {near} pick.p1 L={length}", f"s from_pick pick.p3 {far} L=0", "s aside pick.p4 face.p1 L=0"]
    out = "SRM.p2"
    if at in ("as-port", "end-bench"):
        lines.append(f"m face R={fraction!r} T={1 - fraction!r}")
        lines.append(f"s to_face {'SRM.p2' if at == 'as-port' else 'ETMx.p2'} face.p1 L=0")
        out = "face.p2" if at == "as-port" else out
    lines += ["fsig(1)", f"readout_dc AS {out}.o"]
    if at == "end-bench":
        lines += ["ad stray ETMx.p2.i f=0", "ad light ETMx.p1.o f=0"]
    model = finesse.Model()
    model.parse("\n".join(lines))
    return model


MOVED = ["ETMx", "ETMy", "ITMx", "ITMy", "PRM", "SRM"]
# CARM, MICH, PRCL, SRCL of docs/theory/interferometer.md, of motion mech.z, which grows against the light that meets the front
LENGTHS = np.array([[-0.5, -0.5, 0.5, 0.5, 0, 0], [0, 0, -1, 1, 0, 0], [0, 0, -0.5, -0.5, 1, 0], [0, 0, -0.5, -0.5, 0, -1]])
DARM = np.array([-0.5, 0.5, 0, 0, 0, 0])
# what a servo moves for each: both end mirrors, the arms with their mirrors, the recycling mirrors
ACTUATORS = np.array([[1, 1, 0, 0, 0, 0], [1, -1, 1, -1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]).T


def held(model, frequencies):
    """Read-out per m of the scatterer and per m of DARM, with the other lengths held as by ideal servos."""
    names = [f"{m}.mech.z" for m in MOVED]
    out = model.run(FrequencyResponse(frequencies, ["face.mech.z", *names], ["AS.DC.o", *names])).out
    found = []
    for told in out:
        read, places = told[0], told[1:]
        excitations = np.stack([np.eye(7)[0], np.concatenate([[0], DARM])], axis=1)
        servos = np.concatenate([np.zeros((1, 4)), ACTUATORS])
        push = np.linalg.solve(LENGTHS @ places @ servos, -LENGTHS @ places @ excitations)
        found.append(read @ (excitations + servos @ push))
    return np.array(found).T


def free(model, frequencies):
    out = model.run(FrequencyResponse(frequencies, ["face.mech.z", "ETMx.mech.z", "ETMy.mech.z"], ["AS.DC.o"])).out[:, 0, :]
    return out[:, 0], (out[:, 2] - out[:, 1]) / 2


def solved(d, place, frequencies, lengths=held):
    """{"rms": h per m over static phases, 0 and 90: at these phases, where the light joins the end mirror in phase with the carrier}."""
    model = detector(d["detector"], **place)
    count = d["static_phases"]
    told, angles = [], []
    for i in range(count):
        model.face.phi = 180 * i / count
        scatterer, darm = lengths(model, frequencies)
        told.append(scatterer / (darm * d["detector"]["arm"]))
        if place["at"] == "end-bench":
            fields = model.run()
            angles.append(np.angle(1j * fields["stray"] / fields["light"]))          # a mirror transmits i t
    told = np.array(told)
    found = {"rms": np.sqrt(np.mean(abs(told) ** 2, axis=0))}
    if angles:
        # y = A exp(i theta) + B exp(-i theta) of the static phase theta
        theta = np.array(angles)
        basis = np.stack([np.exp(1j * theta), np.exp(-1j * theta)], axis=1)
        (a, b), *_ = np.linalg.lstsq(basis, told, rcond=None)
        found |= {0: abs(a + b), 90: abs(a - b)}
    return found


def compare(program, d):
    """Rows of the table, whether all agree, and the controls {what: whether it is rejected}."""
    curves, controls = [], {}
    for name, place in d["places"].items():
        theirs = None
        for phase in (None, 0, 90) if place["at"] == "end-bench" else (None,):
            hz, h, sigma = traced(program, d, place, phase)
            theirs = theirs or solved(d, place, hz)
            curves.append((name, "all" if phase is None else f"{phase}°", hz, h, sigma, theirs["rms" if phase is None else phase], theirs["rms"]))
        if place["at"] == "end-bench":
            controls["CARM, MICH, PRCL, SRCL free instead of held"] = not agree(h, sigma, solved(d, place, hz, free)[90], theirs["rms"], d["allowed"])
            heavier = solved(dict(d, detector=dict(d["detector"], mass=d["detector"]["mass"] * 1.05)), place, hz)
            controls["mirrors 5 % heavier"] = not agree(h, sigma, heavier[90], heavier["rms"], d["allowed"])
            controls["phase and power exchanged"] = not agree(h, sigma, theirs[0], theirs["rms"], d["allowed"])
        if place["at"] == "short-arm":
            still = solved(dict(d, detector=dict(d["detector"], mass=1e9)), place, hz)["rms"]
            controls["short arm without radiation pressure"] = not agree(h, sigma, still, still, d["allowed"])
    return curves, controls


def deviation(h, theirs, rms):
    """Of a static phase relative to the rms over all: the smaller of both quadratures may nearly vanish."""
    return (h - theirs) / rms


def agree(h, sigma, theirs, rms, allowed):
    return bool(np.all(abs(deviation(h, theirs, rms)) < allowed + 4 * sigma / h))


def lines(curves, allowed):
    yield "| place | static phase | Hz | straytrace, h per m | error | FINESSE 3, h per m | deviation, largest of all bins | verdict |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for name, phase, hz, h, sigma, theirs, rms in curves:
        at = [int(np.argmin(abs(np.log(hz / f)))) for f in (10, 100, 1000)]
        off = deviation(h, theirs, rms)
        worst = int(np.argmax(abs(off)))
        yield (f"| {name} | {phase} | {', '.join(f'{hz[i]:.3g}' for i in at)} | {', '.join(f'{h[i]:.4g}' for i in at)} | {sigma[at[1]] / h[at[1]]:.2%} | "
               f"{', '.join(f'{theirs[i]:.4g}' for i in at)} | {off[worst]:+.2%} at {hz[worst]:.3g} Hz | "
               f"{'agrees' if agree(h, sigma, theirs, rms, allowed) else '**disagrees**'} |").replace("%", " %")


def draw(axis, curves):
    for i, (name, phase, hz, h, _, theirs, _) in enumerate(curves):
        label = name if phase == "all" else f"{name}, {phase}"
        axis.loglog(hz, theirs, color=f"C{i}", linewidth=1.2, label=label)
        axis.loglog(hz, h, "o", color=f"C{i}", markersize=3.5, markerfacecolor="white")
    axis.set_ylim(1e-17, 1e-9)
    axis.set_xlabel("Hz")
    axis.set_ylabel("h per m of motion")
    axis.legend(fontsize=7)
    axis.set_title("lines: FINESSE 3, circles: straytrace", fontsize=9)


def run(program, d):
    """(lines of the page, function that draws, whether all agree, controls)."""
    curves, controls = compare(program, d)
    good = all(agree(h, sigma, theirs, rms, d["allowed"]) for _, _, _, h, sigma, theirs, rms in curves)
    return list(lines(curves, d["allowed"])), lambda axis: draw(axis, curves), good, controls
