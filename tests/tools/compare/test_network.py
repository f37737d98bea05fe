#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares networks with FINESSE 3, from FINESSE models to scenes and back (eq. N.31; case T29).

Usage: test_network.py PROGRAM. Powers at all ports of twelve topologies and of twenty random networks must agree to 1e-10 in both
directions, of four with higher modes to 1e-9, demodulated signals and responses with radiation pressure to 1e-6 of the largest. FINESSE lives in a virtual
environment that `scripts/setup --test` makes; without it this test fails.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from environment import require_finesse
from records import Records

POWERS, SIGNALS = 1e-10, 1e-6
FREQUENCIES = (3.0, 90.0, 2700.0)    # Hz

INPUT = "l laser P=2 phase=20\n"
MODULATED = INPUT + "mod eom f=6270777 midx=-0.1 order=1\ns s0 laser.p1 eom.p1\n"
DUAL = """
mod eom1 f=6270777 midx=-0.1 order=1
mod eom2 f=56436993 midx=-0.1 order=1
s in0 laser.p1 eom1.p1
s in1 eom1.p2 eom2.p1
s in2 eom2.p2 PRM.p1
m PRM T=0.05 L=0
s prc PRM.p2 BS.p1 L=5.95
bs BS T=0.5 L=1e-4 alpha=45
s lx BS.p3 IX.p1 L=6.115
s ly BS.p2 IY.p1 L=5.885
m IX T=0.014 L=0
m EX T=4e-6 L=75e-6 phi=-7e-4
s ax IX.p2 EX.p1 L=2999.8
m IY T=0.0141 L=0 phi=90
m EY T=4e-6 L=80e-6 phi=90.0007
s ay IY.p2 EY.p1 L=2999.8
s src BS.p4 SRM.p1 L=5.95
m SRM T=0.2 L=0 phi=3
free_mass mx EX.mech mass=42
free_mass my EY.mech mass=42
readout_dc AS SRM.p2.o
readout_rf RF PRM.p1.o f=6270777 phase=20
dof LEN EX.dofs.z 0.5 EY.dofs.z -0.5
"""
# In each: read-outs AS (power) and RF (demodulated, where there are sidebands), degree of freedom LEN.
TOPOLOGIES = {
    "cavity": MODULATED + """
m M1 T=0.02 L=0
m M2 T=0.004 L=0 phi=0.1
s s1 eom.p2 M1.p1 L=1
s s2 M1.p2 M2.p1 L=3000
readout_dc AS M2.p2.o
readout_rf RF M1.p1.o f=6270777 phase=30
dof LEN M2.dofs.z 1""",
    "amplitude modulation, second order of phase": INPUT + """
mod eom1 f=9100000 midx=0.2 mod_type=am phase=25
mod eom2 f=6270777 midx=-0.8 order=2 phase=40
s s0 laser.p1 eom1.p1
s s1 eom1.p2 eom2.p1 L=0.3
s s2 eom2.p2 M1.p1 L=1
m M1 T=0.1 L=1e-4
m M2 T=0.02 L=0 phi=3
s s3 M1.p2 M2.p1 L=40
readout_dc AS M2.p2.o
readout_rf RF M1.p1.o f=9100000 phase=-70
dof LEN M1.dofs.z -1 M2.dofs.z 0.3""",
    "modulated Michelson": MODULATED + """
s s1 eom.p2 BS.p1 L=1
bs BS T=0.52 L=1e-4 alpha=45 phi=4
m X T=0.01 L=5e-5 phi=5
m Y T=0.012 L=5e-5 phi=90
s sx BS.p3 X.p1 L=6.115
s sy BS.p2 Y.p1 L=5.885
readout_dc AS BS.p4.o
readout_rf RF BS.p4.o f=6270777 phase=20
dof LEN X.dofs.z 0.5 Y.dofs.z -0.5""",
    "ring of three mirrors": MODULATED + """
s s1 eom.p2 M1.p1 L=1
bs M1 T=0.0025 L=0 alpha=44.96
bs M2 T=0.0025 L=0 alpha=44.96 phi=0.02
bs M3 T=5e-6 L=1e-4 alpha=0.08 phi=0.01
s a M1.p3 M2.p1 L=0.4
s b M2.p2 M3.p1 L=143.226
s c M3.p2 M1.p4 L=143.226
readout_dc AS M2.p3.o
readout_rf RF M1.p2.o f=6270777 phase=20
dof LEN M3.dofs.z 1""",
    "coupled cavities": INPUT + """
m PRM T=0.05 L=0
m ITM T=0.014 L=0 phi=90
m ETM T=4.4e-6 L=75e-6 phi=90.00002
s s0 laser.p1 PRM.p1
s s1 PRM.p2 ITM.p1 L=11.952
s s2 ITM.p2 ETM.p1 L=2999.8
free_mass fi ITM.mech mass=42
readout_dc AS PRM.p1.o
dof LEN ETM.dofs.z 1""",
    "power-recycled Michelson behind an isolator": MODULATED + """
isol FI S=27
s s1 eom.p2 FI.p1
s s2 FI.p2 PRM.p1 L=0.5
m PRM T=0.06 L=1e-5
s s3 PRM.p2 BS.p1 L=2
bs BS T=0.5 L=0 alpha=45
m X T=1e-3 L=0 phi=1
m Y T=1e-3 L=0 phi=92
s sx BS.p3 X.p1 L=6.1
s sy BS.p2 Y.p1 L=5.9
readout_dc AS BS.p4.o
readout_rf RF FI.p1.o f=6270777 phase=20
dof LEN X.dofs.z 0.5 Y.dofs.z -0.5""",
    "dual-recycled with two modulators": INPUT + DUAL,
    "Sagnac": INPUT + """
s s0 laser.p1 BS.p1
bs BS T=0.4 L=0 alpha=45
bs A T=0.01 L=0 alpha=30 phi=20
bs B T=0.02 L=1e-4 alpha=15
s s1 BS.p3 A.p1 L=3
s s2 A.p2 B.p1 L=4
s s3 B.p2 BS.p2 L=5
readout_dc AS BS.p4.o
dof LEN A.dofs.z 1""",
    "Mach-Zehnder": MODULATED + """
s s1 eom.p2 B1.p1 L=1
bs B1 T=0.5 L=0 alpha=45
bs M1 T=0 L=1e-3 alpha=45 phi=10
bs M2 T=1e-3 L=0 alpha=45
bs B2 T=0.45 L=0 alpha=45
s s2 B1.p3 M1.p1 L=2
s s3 B1.p2 M2.p1 L=3
s s4 M1.p2 B2.p1 L=2
s s5 M2.p2 B2.p4 L=3.4
readout_dc AS B2.p2.o
readout_rf RF B2.p3.o f=6270777 phase=20
dof LEN M1.dofs.z 1""",
    "folded cavity with two free mirrors": INPUT + """
s s0 laser.p1 M1.p1 L=1
m M1 T=0.03 L=0 phi=2
bs F T=1e-3 L=1e-4 alpha=12
m M2 T=1e-3 L=0 phi=1.6
s s1 M1.p2 F.p1 L=100
s s2 F.p2 M2.p1 L=50
free_mass f1 F.mech mass=1
free_mass f2 M2.mech mass=2
readout_dc AS M1.p1.o
dof LEN F.dofs.z 1""",
    "two lasers, lens and nothing": MODULATED + """
l other P=0.5 phase=-30
lens le f=3
nothing no
s s1 eom.p2 le.p1 L=1
s s2 le.p2 M1.p1 L=1
m M1 T=0.2 L=0.01 phi=11
s s3 M1.p2 no.p1 L=2
s s4 no.p2 M2.p1 L=2
m M2 T=0.1 L=0 phi=2
s s5 M2.p2 other.p1 L=0.2
readout_dc AS M1.p1.o
readout_rf RF M1.p1.o f=6270777 phase=20
dof LEN M2.dofs.z 1""",
    "optical spring": """l laser P=10000
m M1 T=0.014 L=0
m M2 T=1e-6 L=75e-6 phi=-0.0001
s s0 laser.p1 M1.p1
s s1 M1.p2 M2.p1 L=3000
free_mass f2 M2.mech mass=42
readout_dc AS M1.p1.o
dof LEN M2.dofs.z 1""",
}

# With higher modes: what reflections, tilts, mismatch, two bases and turned axes do.
MODAL = {
    "tilted cavity": "modes(maxtem=4)\n" + INPUT + """
m M1 T=0.02 L=0 Rc=-1420 xbeta=7e-8 ybeta=-4e-8
m M2 T=0.004 L=0 Rc=1683 xbeta=5e-8 ybeta=1e-7
s s0 laser.p1 M1.p1
s s1 M1.p2 M2.p1 L=3000
cav arm M1.p2.o
free_mass f2 M2.mech mass=42
readout_dc AS M1.p1.o
dof LEN M2.dofs.z 1""",
    "mismatched cavity behind a lens": "modes(even, maxtem=4)\n" + MODULATED + """
gauss input laser.p1.o w=2.4m Rc=inf priority=5
lens le f=30
s s1 eom.p2 le.p1 L=1
s s2 le.p2 M1.p1 L=1
m M1 T=0.02 L=0 Rc=-20
m M2 T=0.01 L=0 Rc=30 phi=0.2
s s3 M1.p2 M2.p1 L=12
cav arm M1.p2.o
readout_dc AS M1.p1.o
readout_rf RF M1.p1.o f=6270777 phase=30
dof LEN M2.dofs.z 1""",
    "arm and signal cavity of two modes": "modes(maxtem=4)\n" + INPUT + """
m ETM T=0.01 L=0 Rc=-1683
m ITM T=0.014 L=0 Rc=1420 xbeta=1e-8 ybeta=2e-8
m SRM T=0.2 L=0 Rc=1425 xbeta=5e-7 ybeta=-3e-7
s s0 laser.p1 ETM.p1
s s1 ETM.p2 ITM.p1 L=2999.8
s s2 ITM.p2 SRM.p1 L=11.95
cav arm ETM.p2.o
readout_dc AS SRM.p2.o
dof LEN ETM.dofs.z 1""",
    "triangular mode cleaner": "modes(maxtem=4)\n" + INPUT + """
bs M1 T=0.0025 L=0 alpha=44.95 xbeta=3e-7 ybeta=2e-7
bs M2 T=0.003 L=0 alpha=44.95 phi=0.01
bs M3 T=5e-6 L=1e-4 alpha=0.08 Rc=185 xbeta=5e-7 ybeta=-7e-7
s s0 laser.p1 M1.p1
s a M1.p3 M2.p1 L=0.4
s b M2.p2 M3.p1 L=143.226
s c M3.p2 M1.p4 L=143.226
cav ring M1.p3.o
readout_dc AS M2.p3.o
dof LEN M3.dofs.z 1""",
}
MODAL_POWERS = 1e-9


def random_model(seed):
    """Twelve components: a laser, a modulator, four mirrors, six splitters, joined at random."""
    draw = numpy.random.default_rng(seed)
    lines = ["l laser P=1", f"mod eom f=6270777 midx={draw.uniform(0.05, 0.3)!r} order=1 phase={draw.uniform(-180, 180)!r}"]
    free = []
    for i in range(10):
        values = f"T={draw.uniform(0.1, 0.8)!r} L={draw.uniform(0, 0.1)!r} phi={draw.uniform(-180, 180)!r}"
        lines.append(f"m x{i} {values}" if i < 4 else f"bs x{i} {values} alpha={draw.uniform(0, 60)!r}")
        free += [f"x{i}.p{p}" for p in range(1, 3 if i < 4 else 5)]
    draw.shuffle(free)
    ends = ["laser.p1", "eom.p1", "eom.p2", *free]
    lines += [f"s s{i} {ends[2 * i]} {ends[2 * i + 1]} L={draw.uniform(0, 30)!r}" for i in range((len(ends) - 4) // 2)]
    return "\n".join([*lines, "readout_dc AS x5.p2.o", "readout_rf RF x6.p3.o f=6270777 phase=10", "dof LEN x7.dofs.z 1"])


def model_of(text):
    model = finesse.Model()
    model.parse(text if "fsig(1)" in text else f"{'' if 'modes(' in text else 'modes(off)'}\n{text}\nfsig(1)")
    if model.is_modal:
        model.phase_config(zero_k00=False, zero_tem00_gouy=True)
    return model


def ask(*words):
    return json.loads(subprocess.run([PROGRAM, "ifo", *words, "--format", "json"], check=True, capture_output=True, text=True).stdout)


def signals_of(model):
    """Steady values of the demodulated read-outs, W."""
    copy = model.deepcopy()
    copy.fsig.f = None
    rf = [r for r in copy.elements.values() if type(r).__name__ == "ReadoutRF"]
    for r in rf:
        for suffix, turn in (("I", 0), ("Q", 90)):
            copy.add(finesse.detectors.PowerDetectorDemod1(f"{r.name}_{suffix}_now", r.optical_node, r.f.value, r.phase.value + turn))
    if not rf:
        return {}
    out = copy.run()
    return {f"{r.name}_{s}": float(out[f"{r.name}_{s}_now"]) for r in rf for s in "IQ"}


def worst_signal(scene, model, power):
    ours = {row["readout"]: row["value"] or 0 for row in ask(scene)["readouts"]}
    return max((abs(ours[name] - value) / power for name, value in signals_of(model).items()), default=0)


def worst_response(scene, model, power):
    """Relative to the response, or to 1e-9 of what the power allows: that of a Sagnac vanishes in first order."""
    rows = ask(scene, "--show", "transfer", "LEN", "AS", "--band", f"{FREQUENCIES[0]} Hz, {FREQUENCIES[-1]} Hz", "--points", "3")
    ours = numpy.array([complex(row["re"], row["im"]) for row in rows["transfer"]])
    theirs = model.run(FrequencyResponse(numpy.array(FREQUENCIES), ["LEN.AC.i"], ["AS.DC.o"])).out[:, 0, 0]
    allowed = 2 * numpy.pi / model.lambda0 * power
    return float(numpy.max(abs(ours - theirs)) / max(numpy.max(abs(theirs)), 1e-9 * allowed))


class Checks:
    def __init__(self):
        self.failures, self.records = 0, Records("tools.network", PROGRAM)

    def __call__(self, name, what, worst, allowed):
        good = self.records.below(f"{what}: relative difference", worst, allowed)
        self.failures += not good
        print(f"{'ok  ' if good else 'FAIL'} {name}: {what}: differs by {worst:.1e}, allowed {allowed:.0e}")

    def control(self, what, seen):
        self.failures += not seen
        print(f"{'ok  ' if seen else 'FAIL'} control: {what}")


def compare(name, text, folder, check, powers=POWERS):
    """To a scene and back, with the powers of both; signals and responses of the scene."""
    model = model_of(text)
    scene = os.path.join(folder, "network.yaml")
    pathlib.Path(scene).write_text(networks.Reader(model).text(), encoding="utf-8")
    ours, theirs = networks.powers_of_scene(scene), networks.powers_of_model(model)
    check(name, "powers", networks.worst_difference(ours, theirs)[0], powers)
    back = model_of(networks.model_of_scene(scene))
    check(name, "powers of the model made of the scene", networks.worst_difference(ours, networks.powers_of_model(back))[0], powers)
    power = max(max(pair) for pair in theirs.values())
    if "readout_rf" in text:
        check(name, "signals", worst_signal(scene, model, power), SIGNALS)
    check(name, "responses", worst_response(scene, model, power), SIGNALS)
    return scene, model


def controls(folder, check):
    scene, model = compare("control", TOPOLOGIES["modulated Michelson"], folder, check)
    text = pathlib.Path(scene).read_text(encoding="utf-8")
    for what, wrong in (("index with the other sign", text.replace("index: 0.1", "index: -0.1")),
                        ("a space without its -pi/4", text.replace("phase: -90 deg", "phase: -45 deg", 1))):
        pathlib.Path(scene).write_text(wrong, encoding="utf-8")
        signals = worst_signal(scene, model, 1)
        powers = networks.worst_difference(networks.powers_of_scene(scene), networks.powers_of_model(model))[0]
        check.control(f"{what} is noticed", max(signals, powers) > SIGNALS)
    for name, old, new in (("tilted cavity", "tilt: [5e-08", "tilt: [-5e-08"), ("triangular mode cleaner", "tilt: [5e-07", "tilt: [-5e-07"),
                           ("mismatched cavity behind a lens", "focal_length: 30", "focal_length: -30"),
                           ("arm and signal cavity of two modes", "curvature: 0.0007017", "curvature: 0.0007117")):
        scene, model = compare(name, MODAL[name], folder, check, MODAL_POWERS)
        text = pathlib.Path(scene).read_text(encoding="utf-8")
        pathlib.Path(scene).write_text(text.replace(old, new), encoding="utf-8")
        powers = networks.worst_difference(networks.powers_of_scene(scene), networks.powers_of_model(model))[0]
        check.control(f"{name}: {new} is noticed", old in text and powers > 1e-4)


def command(folder, check):
    """python3 -m straytrace.finesse, and its refusals."""
    kat, scene = os.path.join(folder, "model.kat"), os.path.join(folder, "scene.yaml")
    environment = os.environ | {"PYTHONPATH": str(PYTHON), "STRAYTRACE_PROGRAM": PROGRAM}

    def run(*words):
        return subprocess.run([sys.executable, "-m", "straytrace.finesse", *words], capture_output=True, text=True, env=environment)

    pathlib.Path(kat).write_text(TOPOLOGIES["cavity"], encoding="utf-8")
    done = run(kat, "-o", scene)
    check.control(f"the command reads a model {done.stderr}", done.returncode == 0 and len(ask(scene)["readouts"]) == 3)
    check.control("the command writes a model", run(scene, "--export", "-o", kat).returncode == 0 and
                  "bs" not in pathlib.Path(kat).read_text(encoding="utf-8"))
    pathlib.Path(kat).write_text(INPUT + "dbs D\ns s0 laser.p1 D.p1", encoding="utf-8")
    done = run(kat, "-o", scene)
    check.control("the name of a component without a counterpart is reported", done.returncode == 2 and "'D'" in done.stderr)


def main():
    check = Checks()
    with tempfile.TemporaryDirectory() as folder:
        for name, text in TOPOLOGIES.items():
            compare(name, text, folder, check)
        for seed in range(20):
            compare(f"random network {seed}", random_model(seed), folder, check)
        for name, text in MODAL.items():
            compare(name, text, folder, check, MODAL_POWERS)
        controls(folder, check)
        command(folder, check)
    if not check.failures:
        check.records.write()
    sys.exit(check.failures > 0)


require_finesse(sys.argv[1])
PROGRAM = os.path.abspath(sys.argv[1])
PYTHON = pathlib.Path(__file__).resolve().parents[3] / "python"
os.environ["STRAYTRACE_PROGRAM"] = PROGRAM
sys.path.insert(0, str(PYTHON))
import finesse
import finesse.detectors
import numpy
from finesse.analysis.actions import FrequencyResponse
from straytrace import finesse_network as networks
main()
