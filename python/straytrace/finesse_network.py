# SPDX-License-Identifier: BSD-3-Clause
"""Networks of FINESSE 3 models in the language of scenes, and back (docs/theory/interferometer.md, eq. N.31).

In plane waves and in Hermite-Gauss modes: laser, mirror, beamsplitter, space, lens, modulator, isolator, nothing, free_mass, pendulum; pd, pd1,
readout_dc, readout_rf, dof; modes, cav, and gauss at a laser. The model is read through FINESSE's own objects, and evaluated: references between parameters
become numbers. E of a scene = conj(E of FINESSE), with -pi/4 in a space for each of its ends at a mirror or splitter."""

from __future__ import annotations

import json
import math
import os
import pathlib
import tempfile
from collections.abc import Iterator
from typing import Any

from . import engine
from .errors import InputError

SAME = 1e-9           # relative difference of powers that is accepted
BEFORE_CAVITIES = 1000     # priority of the mode of a laser
SAME_MODES = 1e-4     # with modes, whose bases may differ outside cavities
SURFACES = {"Mirror": "mirror", "Beamsplitter": "splitter"}
IGNORED = {"Fsig", "ReadoutDetectorOutput", "Cavity", "Gauss"}
LEFT_OUT = {"Lock": "locks", "AmplitudeDetector": "amplitude detectors", "PowerDetectorDemod2": "twice demodulated detectors",
            "Amplifier": "amplifiers", "ZPKFilter": "filters", "Wire": "wires"}


def number(value: float) -> str:
    return repr(float(value))


def _value(parameter: Any) -> float:
    value = parameter.value if hasattr(parameter, "value") else parameter
    return float(value.eval() if hasattr(value, "eval") else value)


def _port(component: Any, name: str) -> str:
    """PRM.p1 of FINESSE as PRM.front."""
    kind, index = type(component).__name__, int(name[1:])
    if kind == "Beamsplitter":
        return f"{component.name}.{index}"
    if kind == "Mirror":
        return f"{component.name}." + ("front" if index == 1 else "back")
    return component.name if kind in ("Laser", "Squeezer") else f"{component.name}." + ("in" if index == 1 else "out")


def _beam(node: Any) -> str:
    """PRM.p1.o of FINESSE as PRM.front.out."""
    return _port(node.component, node.port.name) + (".out" if node.full_name.endswith(".o") else ".in")


def _masses(model: Any) -> dict[str, str]:
    masses = {}
    for element in model.elements.values():
        if type(element).__name__ not in ("FreeMass", "Pendulum"):
            continue
        hung = element._MechanicalConnector__connected_to     # FINESSE has no public name of it
        owner = getattr(hung, "component", hung).name
        text = f", mass: {number(_value(element.mass))} kg"
        if type(element).__name__ == "Pendulum":
            text += f", pendulum_frequency: {number(_value(element.fz))} Hz"
        masses[owner] = text
    return masses


class Reader:
    """A scene from a FINESSE model."""

    def __init__(self, model: Any) -> None:
        self.model, self.warnings = model, list[str]()
        self.wavelength = float(model.lambda0)
        self.masses = _masses(model)

    def component(self, element: Any) -> str | None:
        kind = type(element).__name__
        if kind in SURFACES:
            return self.surface(element, SURFACES[kind])
        if kind == "Laser":
            if _value(element.f) != 0:
                raise InputError(f"laser '{element.name}' has an offset frequency, which a network does not have: remove it")
            return f"laser: {{power: {number(_value(element.P))} W, phase: {number(-_value(element.phase))} deg{self.laser_mode(element)}}}"
        if kind == "Modulator":
            return self.modulator(element)
        if kind == "Isolator":
            return f"isolator: {{isolation: {number(10 ** (-_value(element.S) / 10))}}}"
        if kind == "Lens":
            focal = _value(element.f)
            return f"lens: {{focal_length: {number(focal if math.isfinite(focal) else 1e12)} m}}"
        if kind == "Nothing":
            return "isolator: {isolation: 1}"
        if kind == "Squeezer":
            self.warnings.append(f"squeezer '{element.name}': only a port for light, without squeezing")
            return "dump: {}"
        return None

    def laser_mode(self, laser: Any) -> str:
        for gauss in (e for e in self.model.elements.values() if type(e).__name__ == "Gauss" and self.model.is_modal):
            if gauss.node.component is not laser:
                raise InputError(f"gauss '{gauss.name}' is not at a laser: put it there, or remove it")
            if abs(gauss.qx.q - gauss.qy.q) > 1e-12 * abs(gauss.qx.q):
                raise InputError(f"gauss '{gauss.name}' is astigmatic, which the mode of a laser is not: give it one q")
            if abs(self.model.beam_trace()[gauss.node].qx.q - gauss.qx.q) > 1e-9 * abs(gauss.qx.q):
                self.warnings.append(f"gauss '{gauss.name}': without effect, as a cavity is traced before it; give it a priority")
                continue
            curvature = 1 / gauss.qx.Rc if math.isfinite(gauss.qx.Rc) else 0.0
            return f", mode: {{radius: {number(gauss.qx.w)} m, wavefront_curvature: {number(curvature)} /m}}"
        return ""

    def modes(self) -> str:
        """The line of the modes, empty in plane waves. Cavities in the order in which FINESSE traces them."""
        if not self.model.is_modal:
            return ""
        kept = {(int(n), int(m)) for n, m in self.model.homs}
        order = max(n + m for n, m in kept)
        whole = {(n, m) for n in range(order + 1) for m in range(order + 1 - n)}
        even = {(n, m) for n, m in whole if n % 2 == 0 and m % 2 == 0}
        if kept not in (whole, even):
            raise InputError("the modes of the model are neither all of an order nor the even ones: write modes(maxtem=N)")
        phases = self.model._settings.phase_config
        if phases.zero_k00 or not phases.zero_tem00_gouy:
            self.warnings.append("the phase of a mismatched beam is kept, as with phase_config(zero_k00=False, zero_tem00_gouy=True)")
        cavities = [f"[{', '.join(dict.fromkeys(c.name for c in cavity.path.components if type(c).__name__ in SURFACES))}]"
                    for cavity in self.model.trace_order if type(cavity).__name__ == "Cavity"]
        return (f"    modes: {{order: {max(order, 1)}{', parity: even' if kept == even != whole else ''}"
                f"{', cavities: [' + ', '.join(cavities) + ']' if cavities else ''}}}\n")

    def shape(self, element: Any) -> str:
        """Curvature and tilt of a surface."""
        radii = _value(element.Rcx), _value(element.Rcy)
        curvatures = [number(1 / radius) if math.isfinite(radius) and radius else "0" for radius in radii]
        tilt = _value(element.xbeta), _value(element.ybeta)
        text = ""
        if radii[0] != radii[1]:
            text = f", curvature: [{curvatures[0]} /m, {curvatures[1]} /m]"
        elif curvatures[0] != "0":
            text = f", curvature: {curvatures[0]} /m"
        return text + (f", tilt: [{number(tilt[0])} rad, {number(tilt[1])} rad]" if any(tilt) else "")

    def surface(self, element: Any, kind: str) -> str:
        angle = f", incidence: {number(_value(element.alpha))} deg" if kind == "splitter" else ""
        # rounding of R + T + L = 1
        loss = max(0.0, min(_value(element.L), 1 - _value(element.T)))
        return (f"{kind}: {{transmission: {number(_value(element.T))}, loss: {number(loss)}, "
                f"tuning: {number(-_value(element.phi))} deg{angle}{self.shape(element)}{self.masses.get(element.name, '')}}}")

    def modulator(self, element: Any) -> str:
        if bool(element.positive_only.value):
            raise InputError(f"modulator '{element.name}' makes upper sidebands only, which a network does not: remove positive_only")
        amplitude = element.mod_type.value.name == "am"
        index = _value(element.midx) * (1 if amplitude else -1)
        return (f"modulator: {{frequency: {number(_value(element.f))} Hz, index: {number(index)}, order: {int(element.order)}, "
                f"of: carrier, kind: {'amplitude' if amplitude else 'phase'}, phase: {number(_value(element.phase))} deg}}")

    def space(self, element: Any) -> str | None:
        ends = [element.portA, element.portB]
        if any(type(end.component).__name__ in ("ReadoutDC", "ReadoutRF") for end in ends):
            return None
        if abs(_value(element.nr) - 1) > 1e-12:
            raise InputError(f"space '{element.name}' is filled with glass: give its optical length and nr=1")
        surfaces = sum(type(end.component).__name__ in SURFACES for end in ends)
        names = [_port(end.component, end.name) for end in ends]
        return (f"{{from: {names[0]}, to: {names[1]}, length: {number(_value(element.L))} m, phase: {-45 * surfaces} deg}}")

    def readouts(self, element: Any) -> Iterator[str]:
        kind, name = type(element).__name__, element.name
        if kind in ("PowerDetector", "ReadoutDC"):
            node = element.node if kind == "PowerDetector" else element.optical_node
            yield f"{name}: {{power: {_beam(node)}}}"
        elif kind in ("PowerDetectorDemod1", "ReadoutRF"):
            node = element.node if kind == "PowerDetectorDemod1" else element.optical_node
            for suffix, turn in (("", 0),) if kind == "PowerDetectorDemod1" else (("_I", 0), ("_Q", 90)):
                yield (f"{name}{suffix}: {{demodulate: {{at: {_beam(node)}, frequency: {number(_value(element.f))} Hz, "
                       f"phase: {number(_value(element.phase) + turn)} deg}}}}")

    def freedom(self, element: Any) -> str | None:
        moves = []
        for drive, amplitude in zip(element.drives, element.amplitudes):
            component, _, what = str(drive.name).partition(".dofs.")
            if what != "z":
                self.warnings.append(f"dof '{element.name}': left out, it drives {drive.name} and not a displacement")
                return None
            moves.append(f"{component}: {number(-amplitude)}")     # mech.z = -x
        return f"{element.name}: {{{', '.join(moves)}}}"

    def text(self) -> str:
        components, spaces, readouts, freedoms = [], [], [], []
        for element in self.model.elements.values():
            kind = type(element).__name__
            if (found := self.component(element)) is not None:
                components.append(f"{element.name}: {{{found}}}")
            elif kind == "Space":
                if (link := self.space(element)) is not None:
                    spaces.append(link)
            elif kind == "DegreeOfFreedom":
                if (freedom := self.freedom(element)) is not None:
                    freedoms.append(freedom)
            elif read := list(self.readouts(element)):
                readouts += read
            elif kind in LEFT_OUT:
                self.warnings.append(f"'{element.name}': {LEFT_OUT[kind]} are left out")
            elif kind not in IGNORED | {"FreeMass", "Pendulum"}:
                raise InputError(f"'{element.name}' of type {kind} has no counterpart in a network: remove it from the model")
        sections = [("components", components, ""), ("spaces", spaces, "- "), ("readouts", readouts, ""), ("freedoms", freedoms, "")]
        body = "".join(f"    {name}:\n" + "".join(f"      {mark}{line}\n" for line in lines)
                       for name, lines, mark in sections if lines)
        return f"straytrace: 1\ninterferometer:\n  preset: none\n  network:\n    wavelength: {number(self.wavelength)} m\n{self.modes()}{body}"


def powers_of_scene(scene: str | os.PathLike[str]) -> dict[str, tuple[float, float]]:
    """W that enters and leaves each port, by straytrace ifo."""
    told = json.loads(engine.ask("ifo", str(scene), "--format", "json", "--quiet").output)
    return {row["port"]: (row["enters"], row["leaves"]) for row in told["ports"]}


def powers_of_model(model: Any) -> dict[str, tuple[float, float]]:
    """The same by FINESSE."""
    copy = model.deepcopy()
    copy.phase_config(zero_k00=False, zero_tem00_gouy=True)
    copy.fsig.f = None
    nodes = [(element, port) for element in copy.components for port in element.ports
             if type(element).__name__ in (*SURFACES, "Laser", "Modulator", "Isolator", "Lens", "Nothing") and port.name[1:].isdigit()]
    import finesse.detectors

    for i, (_, port) in enumerate(nodes):
        for way in "io":
            copy.add(finesse.detectors.PowerDetector(f"power_{i}_{way}", getattr(port, way)))
    out = copy.run()
    return {_port(element, port.name): (float(out[f"power_{i}_i"]), float(out[f"power_{i}_o"]))
            for i, (element, port) in enumerate(nodes)}


def worst_difference(ours: dict[str, tuple[float, float]], theirs: dict[str, tuple[float, float]]) -> tuple[float, str]:
    """Largest difference of powers, relative to the larger of the power and 1e-12 of the largest, and its port."""
    floor = 1e-12 * max(max(pair) for pair in theirs.values())
    found = [(max(abs(a - b) / max(b, floor) for a, b in zip(ours[port], pair)), port) for port, pair in theirs.items() if port in ours]
    return max(found, default=(0.0, ""))


def network_of_model(model: Any) -> tuple[str, list[str]]:
    """The scene of a FINESSE model and what it leaves out; the powers at all ports agree, otherwise InputError."""
    reader = Reader(model)
    text = reader.text()
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "network.yaml"
        scene.write_text(text, encoding="utf-8")
        worst, port = worst_difference(powers_of_scene(scene), powers_of_model(model))
    if worst > (SAME_MODES if model.is_modal else SAME):
        hint = ": bases may differ where cavities meet; raise maxtem" if model.is_modal else ""
        raise InputError(f"FINESSE has another power at '{port}', by {worst:.1e}{hint}")
    if worst > SAME:
        reader.warnings.append(f"FINESSE has another power at '{port}', by {worst:.1e}: the modes do not suffice")
    return text, reader.warnings


def _quantity(text: Any, default: float = 0.0) -> float:
    """'3000 m' as network_text writes it, in SI."""
    return default if text is None else float(str(text).split(" ")[0])


class Writer:
    """A FINESSE model from a scene without a preset, as straytrace ifo --show network prints it."""

    def __init__(self, network: dict[str, Any], cavities: list[str]) -> None:
        self.network, self.cavities = network, cavities      # ports that light of the cavities with modes leaves
        self.components: dict[str, dict[str, Any]] = network["components"]
        self.wavelength = _quantity(network["wavelength"])
        modes = network.get("modes", {})
        self.with_modes = bool(modes)
        word = "even" if modes.get("parity") == "even" else "None"
        self.lines = [f"modes({'' if word == 'None' else word + ', '}maxtem={modes['order']})" if modes else "modes(off)",
                      f"lambda({number(self.wavelength)})"]
        if modes:
            self.lines.append("phase_config(zero_k00=False, zero_tem00_gouy=True)")
        self.turns = 0

    def _dissolves(self, port: str) -> bool:
        """A dump: the port in front of it is open instead."""
        return "dump" in self.components[port.partition(".")[0]]

    def port(self, text: str) -> str:
        name, _, port = text.partition(".")
        return f"{name}.p{ {'': 1, 'front': 1, 'back': 2, 'in': 1, 'out': 2}.get(port) or int(port)}"

    def node(self, beam: str) -> str:
        port, _, way = beam.rpartition(".")
        if self._dissolves(port):    # light that enters a dump left the other end of its space
            other = next(s["from"] if s["to"] == port else s["to"] for s in self.network["spaces"] if port in (s["from"], s["to"]))
            return self.port(other) + ".o"
        return self.port(port) + ("." + way[0])

    def surface(self, name: str, kind: str, p: dict[str, Any]) -> None:
        phi = -_quantity(p.get("displacement")) / self.wavelength * 360
        values = f"T={number(_quantity(p['transmission']))} L={number(_quantity(p['loss']))} phi={number(phi)}"
        if isinstance(p.get("curvature"), list):
            radii = [number(1 / c) if c else "inf" for c in map(_quantity, p["curvature"])]
            values += f" Rc=[{','.join(radii)}]"
        elif curvature := _quantity(p.get("curvature")):
            values += f" Rc={number(1 / curvature)}"
        if "tilt" in p:
            x, y = map(_quantity, p["tilt"])
            values += f" xbeta={number(x)} ybeta={number(y)}"
        if kind == "mirror":
            self.lines.append(f"m {name} {values}")
        else:
            self.lines.append(f"bs {name} {values} alpha={number(math.degrees(_quantity(p['incidence'])))}")
        if "mass" in p:
            hung = f"{name}_mass {name}.mech mass={number(_quantity(p['mass']))}"
            self.lines.append(f"pendulum {hung} fz={number(_quantity(p['pendulum_frequency']))} Qz=1e9"
                              if "pendulum_frequency" in p else f"free_mass {hung}")

    def isolator(self, name: str, p: dict[str, Any]) -> None:
        back, on = _quantity(p["isolation"]), _quantity(p["transmission"])
        if on == back < 1:
            self.lines.append(f"m {name} T={number(on)} L={number(1 - on)}")
        elif on != 1:
            raise InputError(f"isolator '{name}' loses light on the way on, which one of FINESSE does not: write 'transmission: 1'")
        elif back == 1:
            self.lines.append(f"nothing {name}")
        else:
            self.lines.append(f"isol {name} S={number(-10 * math.log10(max(back, 1e-40)))}")

    def component(self, name: str) -> None:
        (kind, p), = self.components[name].items()
        if kind in ("mirror", "splitter"):
            self.surface(name, kind, p)
        elif kind == "laser":
            self.lines.append(f"l {name} P={number(_quantity(p['power']))} phase={number(-math.degrees(_quantity(p.get('phase'))))}")
            if mode := p.get("mode"):
                curvature = _quantity(mode["wavefront_curvature"])
                roc = number(1 / curvature) if curvature else "inf"
                self.lines.append(f"gauss {name}_mode {name}.p1.o w={number(_quantity(mode['radius']))} Rc={roc} priority={BEFORE_CAVITIES}")
        elif kind == "modulator":
            am = p.get("kind") == "amplitude"
            self.lines.append(f"mod {name} f={number(_quantity(p['frequency']))} midx={number(_quantity(p['index']) * (1 if am else -1))} "
                              f"order={int(p['order'])} phase={number(math.degrees(_quantity(p.get('phase'))))} mod_type={'am' if am else 'pm'}")
        elif kind == "isolator":
            self.isolator(name, p)
        elif kind == "aperture":
            raise InputError(f"aperture '{name}' has no counterpart in FINESSE but a map: remove it")
        elif kind == "lens":
            self.lines.append(f"lens {name} f={number(_quantity(p['focal_length']))}")

    def _is_surface(self, port: str) -> bool:
        (kind, p), = self.components[port.partition(".")[0]].items()
        return kind in ("mirror", "splitter") or (kind == "isolator" and _quantity(p["isolation"]) == _quantity(p["transmission"]) < 1)

    def space(self, i: int, s: dict[str, Any]) -> None:
        """What is left of the phase, after -pi/4 for each surface, is that of a turning mirror: e^{2 i phi}. It grows with
        the frequency of a sideband, which a longer space undoes."""
        if any(self._dissolves(s[end]) for end in ("from", "to")):
            return
        ends = [self.port(s["from"]), self.port(s["to"])]
        rest = -(_quantity(s.get("phase")) + math.pi / 4 * sum(self._is_surface(s[end]) for end in ("from", "to")))
        rest %= 2 * math.pi
        length = _quantity(s["length"])
        if min(rest, 2 * math.pi - rest) < 1e-13:
            self.lines.append(f"s space_{i} {ends[0]} {ends[1]} L={number(length)}")
            return
        self.turns += 1
        turn = f"turn_{self.turns}"
        last = rest * self.wavelength / (2 * math.pi)
        self.lines += [f"bs {turn} R=1 T=0 phi={number(math.degrees(rest / 2))}",
                       f"s space_{i} {ends[0]} {turn}.p1 L={number(length)}"]
        begin = f"{turn}.p2"
        if self.with_modes:      # a second reflection: x is as it was
            self.lines += [f"bs {turn}b R=1 T=0", f"s space_{i}c {begin} {turn}b.p1"]
            begin = f"{turn}b.p2"
        self.lines.append(f"s space_{i}b {begin} {ends[1]} L={number(last)}")

    def questions(self) -> None:
        self.lines.append("fsig(1)")
        for name, readout in self.network.get("readouts", {}).items():
            (kind, p), = readout.items()
            if kind == "power":
                self.lines.append(f"readout_dc {name} {self.node(p)}")
            elif kind == "demodulate":
                self.lines.append(f"pd1 {name} {self.node(p['at'])} f={number(_quantity(p['frequency']))} "
                                  f"phase={number(math.degrees(_quantity(p['phase'])))}")
        for name, moves in self.network.get("freedoms", {}).items():
            drives = " ".join(f"{component}.dofs.z {number(-float(factor))}" for component, factor in moves.items())
            self.lines.append(f"dof {name} {drives}")

    def text(self) -> str:
        if self.network.get("polarisation", "s") != "s":
            raise InputError("light of polarisation p has no counterpart in FINESSE: write 'polarisation: s'")
        modulators = [p["modulator"] for p in self.components.values() if "modulator" in p]
        if len(modulators) > 1 and any(p["of"] == "all" for p in modulators):
            raise InputError("FINESSE makes no sidebands of sidebands: write 'of: carrier' for each modulator")
        for name in self.components:
            self.component(name)
        for i, s in enumerate(self.network.get("spaces", [])):
            self.space(i, s)
        for i, start in enumerate(self.cavities):      # FINESSE traces those of high priority first
            self.lines.append(f"cav cavity_{i} {self.port(start)}.o priority={len(self.cavities) - i}")
        self.questions()
        return "\n".join(self.lines) + "\n"


def model_of_scene(scene: str | os.PathLike[str]) -> str:
    """The text of a FINESSE model of the network of a scene."""
    import ruamel.yaml

    printed = engine.ask("ifo", str(scene), "--show", "network", "--quiet").output
    network = ruamel.yaml.YAML(typ="safe").load(printed)["interferometer"]["network"]
    cavities = []
    if "modes" in network:
        told = json.loads(engine.ask("ifo", str(scene), "--show", "modes", "--format", "json", "--quiet").output)
        cavities = [row["start"] for row in told["resonances"] if row["basis"]]
    return Writer(network, cavities).text()
