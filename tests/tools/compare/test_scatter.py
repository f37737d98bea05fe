#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares stray light (eq. N.12) with full solutions of FINESSE 3 that contain the scatterer (cases T19 to T24).

Usage: test_scatter.py PROGRAM. A weak pick-off closed by a mirror, two pick-offs that send light on with the beam, or a weak mirror stand in Advanced Virgo
and move. The answer of the power at the dark port must be that of `ifo --show stray`, which knows no scatterer. FINESSE lives in a virtual environment that
`scripts/setup --test` makes; without it this test fails.
"""
import copy
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

from environment import require_finesse
from records import Records

FREQUENCIES = (10.0, 100.0, 1000.0)       # Hz
WAVELENGTH = 1064e-9                      # m
WAVE_NUMBER = 2 * math.pi / WAVELENGTH
PICK_OFF, MIRROR = 1e-8, 1e-10            # reflectivities of the scatterers, of power
ASIDE = 0.5                               # m from a pick-off to its mirror
DETECTOR = "straytrace: 1\ninterferometer:\n  preset: adv\n  network: {}\n"
MASSES = {"heavy": None, "42 kg": "42 kg"}

# Where light joins: the beam, m from its port. Tolerances: second order of the scatterer, larger where it detunes springs.
RETURNED = {
    "arm, to the end mirror": ("ITMx.back.in", 1000.0, {"heavy": 2e-4, "42 kg": 3e-4}),
    "arm, to the input mirror": ("ETMx.front.in", 1999.8, {"heavy": 2e-4, "42 kg": 3e-4}),
    "short arm, to the arm": ("BS.3.in", 3.0, {"heavy": 1e-4, "42 kg": 3e-4}),
    "short arm, from the arm": ("ITMx.front.in", 3.115, {"heavy": 1e-4, "42 kg": 3e-4}),
    "recycling cavity, to the splitter": ("PRM.back.in", 2.0, {"heavy": 1e-4}),
    "signal cavity, to the mirror": ("BS.4.in", 2.0, {"heavy": 1e-4, "42 kg": 3e-4}),
    "signal cavity, from the mirror": ("BS.4.out", 2.0, {"heavy": 1e-4}),
}
WITH_THE_LIGHT = ("BS.3.out", 3.0, 3.5, {"heavy": 1e-4, "42 kg": 3e-4})       # lit at 3 m, joins at 3.5 m
TWO_SIDED = {"arm": ("ITMx.back.in", 1000.0), "short arm": ("BS.3.in", 3.0), "recycling cavity": ("PRM.back.in", 2.0)}
TWO_SIDED_TOLERANCE = 2e-5


def ask(*words):
    return subprocess.run([PROGRAM, "ifo", *words, "--quiet"], check=True, capture_output=True, text=True).stdout


def opposite(beam):
    return beam[:-3] + ".out" if beam.endswith(".in") else beam[:-4] + ".in"


def entrances():
    """{name: beam it joins, m from its port, beam that lights it, m}; of a weak mirror each side, and both as one way (eq. N.20)."""
    ways = {name: (beam, at, opposite(beam), at) for name, (beam, at, _) in RETURNED.items()}
    beam, lit, fed, _ = WITH_THE_LIGHT
    ways["with the light"] = beam, fed, beam, lit
    for name, (beam, at) in TWO_SIDED.items():
        ways[f"front, {name}"] = beam, at, opposite(beam), at
        ways[f"back, {name}"] = opposite(beam), at, beam, at
        ways[f"both, {name}"] = beam, at, opposite(beam), at
    return ways


class Detector:
    """Advanced Virgo with mirrors of one mass, as a network without a preset: no length is held."""

    def __init__(self, folder, mass):
        self.scene = os.path.join(folder, "network.yaml")
        pathlib.Path(self.scene).write_text(DETECTOR, encoding="utf-8")
        self.network = ruamel.yaml.YAML(typ="safe").load(ask(self.scene, "--show", "network"))["interferometer"]["network"]
        for component in self.network["components"].values():
            if mass is None:
                component.get("mirror", {}).pop("mass", None)
        self.stray = self.responses()

    def write(self, network, **more):
        scene = {"straytrace": 1, "interferometer": {"preset": "none", "network": network, **more}}
        pathlib.Path(self.scene).write_text(json.dumps(scene), encoding="utf-8")

    def responses(self):
        """{entrance: its row of AS and (T+, T-) for exp(+2 pi i f t), by frequency} (eq. N.15)."""
        ports = {name: {"at": fed, "distance": f"{at} m"} for name, (fed, at, _, _) in entrances().items()}
        for name, (_, _, lit, lit_at) in entrances().items():
            ports[name] |= {"both_sides": "yes"} if name.startswith("both") else {"lit_by": lit, "lit_distance": f"{lit_at} m"}
        self.write(self.network, ports=ports)
        tables = json.loads(ask(self.scene, "--show", "stray", "--at", ", ".join(f"{f} Hz" for f in FREQUENCIES), "--format", "json"))
        found = {}
        for f in FREQUENCIES:
            for row in tables[f"stray_{f:g}Hz"]:
                if row["readout"] == "AS":
                    phase, amplitude = (part(row[key], row["arg_" + key]) for key in ("phase", "amplitude"))
                    pair = amplitude + 1j * phase, amplitude - 1j * phase
                    found.setdefault(row["entrance"], {"power": row["power"], "pairs": []})["pairs"].append(pair)
        return found

    def in_space(self, beam, places):
        """A copy of the network, the number of the space of the beam, and its ends with the m from the first at which
        these places stand."""
        network = copy.deepcopy(self.network)
        port = beam.rpartition(".")[0]
        i = next(i for i, s in enumerate(network["spaces"]) if port in (s["from"], s["to"]))
        s = network["spaces"].pop(i)
        length = float(s["length"].split()[0])
        first = s["from"] == port
        return network, s, [at if first else length - at for at in places], first

    def with_pick_off(self, beam, at):
        """Light against the beam is returned onto it by a mirror."""
        network, s, (at,), first = self.in_space(beam, [at])
        near, far = ("1", "3") if first == beam.endswith(".in") else ("3", "1")      # 1: where that light enters
        chain(network, s, [at], [(f"pick.{near}", f"pick.{far}")])
        network["components"]["pick"] = splitter(PICK_OFF)
        network["components"]["moved"] = {"mirror": {"transmission": 0}}
        # light that enters at 1 is reflected to 2; what comes from the other side goes to 4, which is open
        network["spaces"].append({"from": "pick.2", "to": "moved.front", "length": f"{ASIDE} m"})
        return network

    def with_two_pick_offs(self, beam, lit, fed):
        network, s, places, first = self.in_space(beam, [lit, fed])
        assert first
        chain(network, s, places, [("pick.1", "pick.3"), ("join.1", "join.3")])
        network["components"] |= {"pick": splitter(PICK_OFF), "join": splitter(PICK_OFF), "moved": splitter(1, "0 deg")}
        network["spaces"] += [{"from": "pick.2", "to": "moved.1", "length": f"{(fed - lit) / 2} m"},
                              {"from": "moved.2", "to": "join.4", "length": f"{(fed - lit) / 2} m"}]
        return network

    def with_mirror(self, beam, at):
        """The front looks to the port of the beam."""
        network, s, (at,), first = self.in_space(beam, [at])
        chain(network, s, [at], [("moved.front", "moved.back") if first else ("moved.back", "moved.front")])
        network["components"]["moved"] = {"mirror": {"transmission": 1 - MIRROR}}
        return network

    def halves(self, network):
        """AS per m of the scatterer, by FINESSE, for exp(+2 pi i f t): P e^{2ikx} + Q e^{-2ikx} of its place x. P and Q from four
        places, as static stray light adds e^{4ikx} and a constant."""
        self.write(network)
        model = finesse.Model()
        model.parse(networks.model_of_scene(self.scene))
        found = numpy.zeros((2, len(FREQUENCIES)), complex)
        for place in range(4):
            model.elements["moved"].phi = -45 * place                # x = -phi lambda/360 deg (eq. N.31)
            told = model.run(FrequencyResponse(numpy.array(FREQUENCIES), ["moved.mech.z"], ["AS.DC.o"])).out[:, 0, 0]
            turn = 1j ** place
            found += numpy.array([-told / turn, -told * turn]) / 4     # mech.z = -x
        return found


def part(magnitude, angle):
    """Not a number: below 1e-10 of the other quadrature."""
    return 0 if magnitude is None else magnitude * complex(math.cos(angle), math.sin(angle))


def splitter(reflectivity, incidence="45 deg"):
    return {"splitter": {"transmission": 1 - reflectivity, "incidence": incidence}}


def chain(network, space, places, ports):
    """Puts components into a space, with the ports (toward its first end, away from it) at these m."""
    begin, since = space["from"], 0.0
    for at, (near, far) in sorted(zip(places, ports)):
        network["spaces"].append({"from": begin, "to": near, "length": f"{at - since} m"})
        begin, since = far, at
    rest = {"from": begin, "to": space["to"], "length": f"{float(space['length'].split()[0]) - since} m"}
    network["spaces"].append(rest | ({"phase": space["phase"]} if "phase" in space else {}))


def of_pick_off(pair):
    """s = R e^{2ikx}, relative to the light that is scattered. Half of a real motion is at +f, half at -f, and the signs of i are those of
    exp(+2 pi i f t): conjugates of eq. N.13."""
    upper, lower = pair
    scale = 1j * WAVE_NUMBER * PICK_OFF
    return lower * scale, -upper * scale


def of_mirror(front, back):
    """s = i r e^{2ikx} in front and i r e^{-2ikx} behind."""
    scale = WAVE_NUMBER * math.sqrt(MIRROR)
    return scale * (back[0] - front[1]), scale * (back[1] - front[0])


def of_face(pair):
    """The same where the response holds both sides."""
    scale = -WAVE_NUMBER * math.sqrt(MIRROR)
    return scale * pair[1], scale * pair[0]


def worst(ours, theirs):
    """Of |P|, |Q| and of PQ, which does not depend on where the scatterer stands in its wave, relative to both together."""
    size = abs(theirs[0]) ** 2 + abs(theirs[1]) ** 2
    return max(abs(abs(ours[i]) - abs(theirs[i])) / math.sqrt(size) for i in (0, 1)), abs(ours[0] * ours[1] - theirs[0] * theirs[1]) / size


class Checks:
    def __init__(self):
        self.failures, self.records = 0, Records("tools.finesse_scatter", PROGRAM)

    def __call__(self, name, ours, theirs, allowed):
        sizes, products = zip(*(worst(o, [half[i] for half in theirs]) for i, o in enumerate(ours)))
        for what, found in (("size", max(sizes)), ("phase", max(products))):
            good = self.records.below(f"{name}, {what}: relative difference", found, allowed)
            self.failures += not good
            print(f"{'ok  ' if good else 'FAIL'} {name}, {what}: differs by {found:.1e}, allowed {allowed:.0e}")

    def control(self, what, ours, theirs, allowed):
        found = max(worst(o, [half[i] for half in theirs])[0] for i, o in enumerate(ours))
        self.failures += not found > 10 * allowed
        print(f"{'ok  ' if found > 10 * allowed else 'FAIL'} control: {what}: differs by {found:.1e}")


def pick_offs(detector, mass, check):
    found = {}
    for name, (beam, at, tolerances) in RETURNED.items():
        if mass not in tolerances:
            continue
        found[name] = detector.halves(detector.with_pick_off(beam, at))
        check(f"{name}, {mass}", [of_pick_off(pair) for pair in detector.stray[name]["pairs"]], found[name], tolerances[mass])
    beam, lit, fed, tolerances = WITH_THE_LIGHT
    both = detector.halves(detector.with_two_pick_offs(beam, lit, fed))
    check(f"with the light, {mass}", [of_pick_off(pair) for pair in detector.stray["with the light"]["pairs"]], both, tolerances[mass])
    one = [of_pick_off([z / 2 for z in pair]) for pair in detector.stray["with the light"]["pairs"]]
    check.control("with the light, one of two equal terms", one, both, tolerances[mass])
    one = [of_pick_off(pair) for pair in detector.stray["short arm, to the arm"]["pairs"]]
    check.control("with the light, light that returns instead", one, both, tolerances[mass])
    if mass == "heavy":
        to, back = (detector.stray[f"signal cavity, {way} the mirror"] for way in ("to", "from"))
        joined = math.sqrt(back["power"] / to["power"])
        check.control(f"relative to the light joined, {abs(1 - 1 / joined):.1%}", [of_pick_off([z / joined for z in pair]) for pair in back["pairs"]],
                      found["signal cavity, from the mirror"], 1e-4)


def mirrors(detector, check):
    for name, (beam, at) in TWO_SIDED.items():
        front, back = (detector.stray[f"{side}, {name}"]["pairs"] for side in ("front", "back"))
        theirs = detector.halves(detector.with_mirror(beam, at))
        check(f"mirror, {name}", [of_mirror(*pairs) for pairs in zip(front, back)], theirs, TWO_SIDED_TOLERANCE)
        check(f"mirror, {name}, one way", [of_face(pair) for pair in detector.stray[f"both, {name}"]["pairs"]], theirs, TWO_SIDED_TOLERANCE)
        check.control(f"mirror, {name}, without its back", [of_mirror(pair, (0, 0)) for pair in front], theirs, TWO_SIDED_TOLERANCE)


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        for name, mass in MASSES.items():
            detector = Detector(folder, mass)
            pick_offs(detector, name, check)
            if mass is None:
                mirrors(detector, check)
    if not check.failures:
        check.records.write()
    sys.exit(check.failures > 0)


require_finesse(sys.argv[1])
PROGRAM = os.path.abspath(sys.argv[1])
PYTHON = pathlib.Path(__file__).resolve().parents[3] / "python"
os.environ["STRAYTRACE_PROGRAM"] = PROGRAM
sys.path.insert(0, str(PYTHON))
import finesse
import numpy
import ruamel.yaml
from finesse.analysis.actions import FrequencyResponse
from straytrace import finesse_network as networks
main()
