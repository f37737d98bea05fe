#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the network solver with FINESSE 3 on dual-recycled interferometers like Advanced Virgo.

Usage: test_finesse.py PROGRAM, the program dual_recycled_numbers. Power at every port and the answers of the power at
the dark port to DARM (with radiation pressure) must agree to 1e-6, those to amplitude and phase of the laser to 1e-5. FINESSE lives
in a virtual environment that `scripts/setup --test` makes; without it this test fails.
"""
import json
import math
import subprocess
import sys

from environment import require_finesse
from records import Records

# Light of the laser reaches the dark port by differences of arms alone: these cancel to some digits.
TOLERANCES = {"carrier powers": 1e-6, "DARM": 1e-6, "laser amplitude": 1e-5, "laser phase": 1e-5}

# Names of the same ports: mirrors front and back, splitters front in, front out of the reflection, back.
PORTS = {"PRM": ("p1", "p2"), "SRM": ("p1", "p2"), "BS": ("p1", "p2", "p3", "p4"), "ITMx": ("p1", "p2"),
         "ITMy": ("p1", "p2"), "ETMx": ("p1", "p2"), "ETMy": ("p1", "p2")}


def name_of(component):
    return component.replace(" ", "")


def model_of(p, toward=-1):
    """The same network. FINESSE: reflection 1, transmission i; tunings in degrees of one wavelength, positive where the
    path at p1 becomes shorter (`toward`: our displacements have the other sign)."""
    once = 1 - math.sqrt(1 - p["beam_splitter_loss"])
    lines = ["modes(off)", f"lambda({p['wavelength']!r})", f"l laser P={p['input_power']!r}"]
    beam = "laser.p1"
    for i, (hz, index) in enumerate(p["modulators"]):
        lines += [f"mod eom{i} f={hz!r} midx={index!r} order=1", f"s to_eom{i} {beam} eom{i}.p1"]
        beam = f"eom{i}.p2"
    lines += [
        f"m PRM T={p['power_recycling_transmission']!r} L=0",
        f"bs BS T={p['splitter_transmission'] * (1 - once)!r} L={once!r} alpha=45",
        f"m SRM T={p['signal_recycling_transmission']!r} L=0 "
        f"phi={toward * math.degrees(p['signal_recycling_tuning'])!r}",
        f"s input {beam} PRM.p1",
        f"s recycling PRM.p2 BS.p1 L={p['power_recycling_length']!r}",
        f"s signal BS.p4 SRM.p1 L={p['signal_recycling_length']!r}",
    ]
    for arm, sign, port in (("x", 1, "BS.p3"), ("y", -1, "BS.p2")):
        half = sign * 0.5
        loss = (p["round_trip_loss"] + half * p["loss_difference"]) * (1 - p["end_transmission"])
        transmission = p["input_transmission"] * (1 + half * p["transmission_difference"])
        dark = 0 if arm == "x" else 90  # makes the port of SRM dark
        offset = toward * half * p["dark_fringe_offset"] / p["wavelength"] * 360
        lines += [
            f"m ITM{arm} T={transmission!r} L=0 phi={dark}",
            f"m ETM{arm} T={p['end_transmission']!r} L={loss!r} phi={dark + offset!r}",
            f"s short{arm} {port} ITM{arm}.p1 L={p['short_arm'] + half * p['schnupp_asymmetry']!r}",
            f"s arm{arm} ITM{arm}.p2 ETM{arm}.p1 L={p['arm_length']!r}",
            f"free_mass m_itm{arm} ITM{arm}.mech mass={p['mirror_mass']!r}",
            f"free_mass m_etm{arm} ETM{arm}.mech mass={p['mirror_mass']!r}",
        ]
    lines += ["fsig(1)", "readout_dc AS SRM.p2.o"]
    lines += [f"pd P_{name_of(c)}_{port}_{way} {name_of(c)}.{port}.{way}"
              for c, ports in PORTS.items() for port in ports for way in "io"]
    model = finesse.Model()
    model.parse("\n".join(lines))
    return model


def powers_of(model):
    out = model.run()
    return {(c, i, way): float(out[f"P_{name_of(c)}_{port}_{way}"])
            for c, ports in PORTS.items() for i, port in enumerate(ports) for way in "io"}


def responses_of(model, frequencies):
    """Per m of DARM, per relative amplitude and per rad of the laser. FINESSE counts exp(+iwt): conjugates, and the
    phase of light grows the other way."""
    inputs = ["ETMx.mech.z", "ETMy.mech.z", "laser.amp.i", "laser.phs.i"]
    out = model.run(FrequencyResponse(numpy.array(frequencies), inputs, ["AS.DC.o"])).out
    x, y, amplitude, phase = (numpy.conj(out[:, 0, i]) for i in range(4))
    return {"DARM": (y - x) / 2, "laser amplitude": amplitude, "laser phase": -phase}


def worst_power(case, model):
    """Largest relative difference of the powers; 1e-20 W is the rounding of a dark port."""
    return max(abs(case["powers"][f"{c} {port}"]["io".index(way)] - value) / max(value, 1e-20)
               for (c, port, way), value in powers_of(model).items())


def both_responses(case, model):
    """{what: (ours, theirs)}, complex, by frequency."""
    theirs = responses_of(model, [r["hz"] for r in case["responses"]])
    return {key: (numpy.array([complex(*r[key]) for r in case["responses"]]), theirs[key]) for key in theirs}


def worst_of(responses):
    return {key: float(numpy.max(abs(ours - theirs) / abs(theirs))) for key, (ours, theirs) in responses.items()}


def main():
    cases = json.loads(subprocess.run([sys.argv[1]], check=True, capture_output=True, text=True).stdout)
    failures, records = 0, Records("tools.finesse", sys.argv[1])
    for name, case in cases.items():
        model = model_of(case["parameters"])
        responses = both_responses(case, model)
        records.curve(f"{name}: DARM [W/m]", [r["hz"] for r in case["responses"]], *map(abs, responses["DARM"]))
        found = {"carrier powers": worst_power(case, model), **worst_of(responses)}
        for what, worst in found.items():
            good = records.below(f"{name}: {what}: relative difference", worst, TOLERANCES[what])
            failures += not good
            print(f"{'ok  ' if good else 'FAIL'} {name}: {what}: differs by {worst:.1e}, allowed {TOLERANCES[what]:.0e}")
    # Controls: the offset and the tuning with the other sign, and 1e-5 more transmission, must not pass.
    case = cases["detuned, arms not equal"]
    changed = dict(case["parameters"], input_transmission=case["parameters"]["input_transmission"] * (1 + 1e-5))
    for what, model in (("signs", model_of(case["parameters"], +1)), ("transmissions", model_of(changed))):
        seen = worst_of(both_responses(case, model))["DARM"] > TOLERANCES["DARM"]
        failures += not seen
        print(f"{'ok  ' if seen else 'FAIL'} control: wrong {what} are noticed")
    if not failures:
        records.write()
    sys.exit(failures > 0)


require_finesse(sys.argv[1])
import finesse
import numpy
from finesse.analysis.actions import FrequencyResponse
main()
