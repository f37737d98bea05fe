# SPDX-License-Identifier: BSD-3-Clause
"""Sequential lens files of Zemax (.zmx): lenses and mirrors with spheres, conics and even aspheres, placed by coordinate breaks; the
first surface is at the origin, its axis is z. Glass catalogues (.agf)."""

from __future__ import annotations

import dataclasses
import math
import pathlib

import numpy as np

from .scene import Beam, Layout, LayoutError, Optic, Plane, Profile, Shaped, plain_name

UNITS = {"MM": 1e-3, "CM": 1e-2, "IN": 25.4e-3, "METER": 1.0, "M": 1.0}
# Glasses that are presets of the program, by the names of catalogues.
PRESETS = {"BK7": "bk7", "N-BK7": "bk7", "N-BK7HT": "bk7", "F_SILICA": "fused_silica", "SILICA": "fused_silica", "LITHOSIL-Q": "fused_silica",
           "SAPPHIRE": "sapphire", "CAF2": "calcium_fluoride", "SILICON": "silicon"}
# Kinds that are faces, with the power of the coefficient number n.
POWERS = {"STANDARD": None, "EVENASPH": lambda n: 2 * n, "ODDASPHE": lambda n: n}
# Keywords of surfaces that change nothing in a scene: pick-ups and solves (their results are in the file), drawing, coatings.
HARMLESS = {"TYPE", "CURV", "DISZ", "DIAM", "GLAS", "CONI", "PARM", "STOP", "CLAP", "OBDC", "COMM", "COAT", "HIDE", "MIRR", "SLAB", "POPS", "FIMP",
            "MEMA", "FLAP", "PPAR", "PZUP", "CRPK", "MAZH", "OEMA", "SDIA", "ETYP", "SCOL"}


@dataclasses.dataclass
class Surface:
    number: int
    line: int
    kind: str = "STANDARD"
    curvature: float = 0.0              # per unit of the file, positive with the centre behind the surface
    conic: float = 0.0
    gap: float = 0.0                    # to the next surface
    radius: float = 0.0                 # clear semi-diameter
    hole: float = 0.0                   # radius
    decentre: tuple[float, float] = (0.0, 0.0)    # of the aperture
    stop: bool = False
    glass: list[str] = dataclasses.field(default_factory=list)
    numbers: dict[int, float] = dataclasses.field(default_factory=dict)    # PARM

    @property
    def mirror(self) -> bool:
        return bool(self.glass) and self.glass[0].upper() == "MIRROR"

    def profile(self, unit: float, side: int) -> Profile:
        """The face whose outward normal is `side` times the local z. ValueError says why no shape has it."""
        if self.kind not in POWERS:
            raise ValueError(f"is of type {self.kind}, for which there is no shape")
        power = POWERS[self.kind]
        terms = {power(n): a for n, a in self.numbers.items() if a} if power else {}
        curvature, conic = self.curvature, self.conic
        if terms.get(2) and curvature == 0 and conic == 0:          # a parabola
            curvature, conic = 2 * terms.pop(2), -1.0
        if wrong := sorted(n for n in terms if n not in (4, 6, 8, 10)):
            raise ValueError(f"has the aspheric term r^{wrong[0]:g}; the shape conic has r^4, r^6, r^8 and r^10")
        # Orders of the file become orders of the metre.
        found = tuple(side * terms.get(n, 0.0) / unit**(n - 1) for n in (4, 6, 8, 10))
        return Profile(side * curvature / unit, conic, found)      # type: ignore[arg-type]


@dataclasses.dataclass
class Glass:
    """Dispersion of a catalogue: formula and coefficients of Zemax, wavelengths in um."""

    formula: int
    coefficients: list[float]
    lowest: float = 0.0
    highest: float = math.inf

    def index(self, um: float) -> float:
        c, s = self.coefficients + [0.0] * 10, um * um
        if not self.lowest <= um <= self.highest:
            raise ValueError(f"is known from {self.lowest:g} to {self.highest:g} um, not at {um:g} um")
        if self.formula == 1:           # Schott
            return math.sqrt(c[0] + c[1] * s + c[2] / s + c[3] / s**2 + c[4] / s**3 + c[5] / s**4)
        if self.formula in (2, 6):      # Sellmeier 1 and 3
            return math.sqrt(1 + sum(c[i] * s / (s - c[i + 1]) for i in range(0, 6 if self.formula == 2 else 8, 2)))
        raise ValueError(f"has dispersion formula {self.formula}; 1, 2 and 6 can be read")


def decoded(path) -> str:
    data = pathlib.Path(path).read_bytes()
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def read_glasses(paths) -> dict[str, Glass]:
    glasses: dict[str, Glass] = {}
    for path in paths:
        current = None
        for words in map(str.split, decoded(path).splitlines()):
            if len(words) > 2 and words[0] == "NM":
                current = glasses[words[1].upper()] = Glass(int(float(words[2])), [])
            elif current and words and words[0] == "CD":
                current.coefficients = [float(w) for w in words[1:]]
            elif current and len(words) > 2 and words[0] == "LD":
                current.lowest, current.highest = float(words[1]), float(words[2])
    return glasses


def is_zemax(text: str) -> bool:
    words = [line.split()[:1] for line in text.splitlines()]
    return ["SURF"] in words and (["MODE"] in words or ["VERS"] in words)


class Reader:
    def __init__(self, path: str, text: str, glasses: dict[str, Glass]) -> None:
        self.path, self.glasses = path, glasses
        self.problems: list[str] = []
        self.unread: list[str] = []
        self.apertures: set[int] = set()
        self.surfaces: list[Surface] = []
        self.title, self.unit, self.pupil, self.primary = "Zemax lens", 1e-3, 0.0, 1
        self.waves: dict[int, float] = {}
        for number, line in enumerate(text.splitlines(), 1):
            if words := line.split():
                self.read(words, line, number)
        wave = self.waves.get(self.primary) or next(iter(self.waves.values()), 0.0)
        if not wave > 0:
            self.refuse(0, "no wavelength", "save the file with a wavelength (WAVM)")
        self.wavelength = wave * 1e-6

    def refuse(self, line: int, what: str, remedy: str) -> None:
        self.problems.append(f"{self.path}{f':{line}' if line else ''}: error: {what}; {remedy}")

    def number(self, word: str, line: int) -> float:
        try:
            return math.inf if word.upper().startswith("INF") else float(word)
        except ValueError:
            self.refuse(line, f"'{word}' is not a number", "save the file again")
            return math.nan

    def read(self, words: list[str], text: str, line: int) -> None:
        key, rest = words[0], words[1:]
        if key == "SURF":
            self.surfaces.append(Surface(len(self.surfaces), line))
        elif self.surfaces and text[:1].isspace():
            self.read_surface(self.surfaces[-1], key, rest, line)
        elif key == "MODE" and rest[:1] != ["SEQ"]:
            self.refuse(line, f"mode '{' '.join(rest)}'", "only sequential files can be read: export the lens as a sequential system, or as STEP")
        elif key == "NAME" and rest:
            self.title = " ".join(rest)
        elif key == "UNIT" and rest:
            if rest[0].upper() not in UNITS:
                self.refuse(line, f"unit '{rest[0]}'", "use MM, CM, IN or METER")
            self.unit = UNITS.get(rest[0].upper(), math.nan)
        elif key == "ENPD" and rest:
            self.pupil = self.number(rest[0], line)
        elif key == "PWAV" and rest:
            self.primary = int(self.number(rest[0], line))
        elif key == "WAVM" and len(rest) > 1:
            self.waves[int(self.number(rest[0], line))] = self.number(rest[1], line)
        elif key in ("XFLN", "YFLN", "XFLD", "YFLD") and any(self.number(word, line) for word in rest):
            self.unread.append(f"{self.path}:{line}: field points ({key}); only light on the axis is launched: add beams to the scene")
        elif key == "MNUM" and rest and self.number(rest[0], line) > 1:
            self.unread.append(f"{self.path}:{line}: configurations other than the one stored; save the file in each of them")
        elif key == "WAVL":
            self.waves.update({i: self.number(w, line) for i, w in enumerate(rest, 1)})

    def read_surface(self, s: Surface, key: str, rest: list[str], line: int) -> None:
        if key == "TYPE":
            s.kind = rest[0]
        elif key == "CURV":
            s.curvature = self.number(rest[0], line)
        elif key == "DISZ":
            s.gap = self.number(rest[0], line)
        elif key == "DIAM":
            s.radius = s.radius if s.number in self.apertures else self.number(rest[0], line)
        elif key == "GLAS":
            s.glass = rest
        elif key == "CONI":
            s.conic = self.number(rest[0], line)
        elif key == "PARM":
            s.numbers[int(self.number(rest[0], line))] = self.number(rest[1], line)
        elif key == "STOP":
            s.stop = True
        elif key == "CLAP":
            s.hole, s.radius = self.number(rest[0], line), self.number(rest[1], line)
            self.apertures.add(s.number)
        elif key == "OBDC":
            s.decentre = self.number(rest[0], line), self.number(rest[1], line)
        elif key not in HARMLESS and any(word.strip("-+0.") for word in rest):
            self.unread.append(f"{self.path}:{line}: surface {s.number}: {key} is not read; if it tilts, moves or limits the surface, add that to "
                               "the scene")

    def glass_of(self, s: Surface, left_out: list[str]) -> tuple[float, str]:
        """Index, and the preset of the program that gives it instead."""
        name, um = s.glass[0].upper(), self.wavelength * 1e6
        if name in self.glasses:
            try:
                return self.glasses[name].index(um), ""
            except ValueError as error:
                self.refuse(s.line, f"surface {s.number}: the glass {name} {error}", "choose another wavelength or glass")
                return 1.5, ""
        if name in PRESETS:
            return 1.5, PRESETS[name]
        nd = float(s.glass[3]) if len(s.glass) > 3 and s.glass[3].replace(".", "", 1).isdigit() else 0.0
        if nd > 1 and name == "___BLANK":
            left_out.append(f"surface {s.number}: dispersion of a model glass; its index at 587.6 nm, {nd:g}, is used")
            return nd, ""
        self.refuse(s.line, f"surface {s.number}: the glass {name} is not known", "name its catalogue: --glass schott.agf")
        return 1.5, ""


class Frame:
    """Axes and origin of the surface that is read. `along`: of the light, with or against z."""

    def __init__(self) -> None:
        self.axes, self.origin, self.along = np.eye(3), np.zeros(3), 1

    def step(self, length: float) -> None:
        self.origin = self.origin + length * self.axes[:, 2]

    def coordinate_break(self, numbers: dict[int, float], unit: float) -> None:
        """Decentre, then tilts about x, y and z, each about the new axes; in the reverse order where number 6 is not 0."""
        dx, dy, *tilts = (numbers.get(i, 0.0) for i in range(1, 6))
        shift, turns = np.array([dx, dy, 0.0]) * unit, [turn(axis, math.radians(angle)) for axis, angle in enumerate(tilts)]
        if numbers.get(6, 0.0):
            self.axes = self.axes @ turns[2] @ turns[1] @ turns[0]
            self.origin = self.origin + self.axes @ shift
        else:
            self.origin = self.origin + self.axes @ shift
            self.axes = self.axes @ turns[0] @ turns[1] @ turns[2]


def turn(axis: int, angle: float) -> np.ndarray:
    """Right-handed rotation about axis 0, 1 or 2."""
    matrix, (i, j) = np.eye(3), ((axis + 1) % 3, (axis + 2) % 3)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[j, i] = math.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix


class Builder:
    """Optics of a layout, surface by surface."""

    def __init__(self, reader: Reader, layout: Layout) -> None:
        self.reader, self.layout, self.frame = reader, layout, Frame()
        self.taken = {"image", "input", "black", "bench"}
        self.built: list[tuple[np.ndarray, np.ndarray]] = []      # ends of the lenses

    def where(self, s: Surface) -> str:
        return f"{self.reader.path}:{s.line}: surface {s.number}"

    def leave_out(self, s: Surface, what: str, remedy: str) -> None:
        self.layout.left_out.append(f"{self.where(s)} {what}; {remedy}")

    def refuse(self, s: Surface, what: str, remedy: str) -> None:
        self.reader.refuse(s.line, f"surface {s.number} {what}", remedy)

    def add(self, before: Surface, s: Surface, after: Surface) -> None:
        unit = self.reader.unit
        if s.kind == "COORDBRK":
            self.frame.coordinate_break(s.numbers, unit)
        elif s.mirror:
            self.add_mirror(s)
            self.frame.along = -self.frame.along
        elif s.glass:
            self.add_lens(s, after)
        elif before.glass == [] or before.mirror:
            self.check_empty(s)
        if not math.isfinite(s.gap):
            return self.refuse(s, "is followed by an infinite thickness", "state the distance to the next surface (DISZ)")
        return self.frame.step(s.gap * unit)

    def check_empty(self, s: Surface) -> None:
        """A surface between vacuum and vacuum."""
        if s.kind not in POWERS:
            self.leave_out(s, f"is of type {s.kind}, which cannot be modelled", "the scene omits its effect; add an equivalent optic by hand")
        elif s.stop:
            self.leave_out(s, f"is an aperture stop of radius {s.radius:g}", "add a disk with that inner_radius")

    def add_mirror(self, s: Surface) -> None:
        unit, side = self.reader.unit, -self.frame.along
        try:
            front = s.profile(unit, side)
        except ValueError as error:
            return self.refuse(s, f"is a mirror and {error}", "export the system as STEP")
        x, y = s.decentre
        reach = s.radius + math.hypot(x, y)
        if not s.radius > 0:
            return self.refuse(s, f"is a mirror with the semi-diameter {s.radius:g}", "state it (DIAM)")
        if math.isnan(front.sag(reach * unit)):
            return self.refuse(s, "is a mirror wider than the surface it is cut from", "lower its semi-diameter")
        self.layout.shaped.append(Shaped(plain_name(f"M{s.number}", self.taken), self.frame.origin, side * self.frame.axes[:, 2],
                                         self.frame.axes[:, 0], s.radius * unit, front, hole=s.hole * unit,
                                         decentre=(x * unit, side * y * unit)))
        return None

    def add_lens(self, front: Surface, back: Surface) -> None:
        unit, along = self.reader.unit, self.frame.along
        if back.kind == "COORDBRK" or back.mirror:
            return self.refuse(front, "is glass whose other face is tilted or a mirror", "export this optic as STEP")
        if not (max(front.radius, back.radius) > 0 and 0 < along * front.gap < math.inf):
            return self.refuse(front, f"has the semi-diameter {front.radius:g} and the thickness {front.gap:g}",
                               "state both (DIAM, DISZ); the thickness is negative after an odd number of mirrors, else positive")
        try:
            faces = front.profile(unit, -along), back.profile(unit, along)
        except ValueError as error:
            return self.leave_out(front, f"begins a lens with a face that {error}", "its effect is missing: import the lens as STEP or as a mesh")
        for s in (front, back):
            if any(s.decentre) or s.hole:
                self.leave_out(s, "has a decentred or annular aperture", "the lens is round and without a hole")
        ends = self.frame.origin, self.frame.origin + front.gap * unit * self.frame.axes[:, 2]
        if any(min(abs(a - c).max() + abs(b - d).max(), abs(a - d).max() + abs(b - c).max()) < 1e-9 for a, b in self.built for c, d in [ends]):
            return self.leave_out(front, "begins a lens that the light has passed before", "it is there once, for all passages")
        self.built.append(ends)
        return self.place(front, max(front.radius, back.radius) * unit, abs(front.gap) * unit, faces)

    def place(self, s: Surface, radius: float, thickness: float, faces: tuple[Profile, Profile]) -> None:
        index, preset = self.reader.glass_of(s, self.layout.left_out)
        heights = [face.sag(radius) for face in faces]
        if any(map(math.isnan, heights)):
            return self.refuse(s, "begins a lens with a face wider than the sphere or conic it is cut from", "lower its semi-diameter")
        name, normal = plain_name(f"L{s.number}", self.taken), -self.frame.along * self.frame.axes[:, 2]
        if not all(face.spherical for face in faces):
            if thickness + sum(heights) <= 0:
                return self.refuse(s, "begins a lens whose faces meet before the edge", "lower its semi-diameter")
            self.layout.shaped.append(Shaped(name, self.frame.origin, normal, self.frame.axes[:, 0], radius, faces[0], faces[1], thickness, index, preset))
            return None
        self.layout.optics.append(Optic(name, self.frame.origin + heights[0] * normal, normal, self.frame.axes[:, 0], 2 * radius,
                                        thickness + sum(heights), index, None, None, faces[0].curvature, faces[1].curvature, 0.0,
                                        f"{self.reader.path}:{s.line}", preset))
        return None


def read_zemax(path: str, text: str, glasses: dict[str, Glass]) -> Layout:
    reader = Reader(path, text, glasses)
    layout = Layout(reader.title)
    builder, surfaces = Builder(reader, layout), reader.surfaces
    for before, s, after in zip(surfaces, surfaces[1:], surfaces[2:]):
        builder.add(before, s, after)
    layout.left_out += reader.unread
    if reader.problems:
        raise LayoutError(reader.problems)
    add_light(reader, layout, builder.frame)
    return layout


def add_light(reader: Reader, layout: Layout, frame: Frame) -> None:
    """A collimated beam as wide as the entrance pupil, and the image, where `frame` is, as a receiver."""
    widest = max([o.diameter / 2 for o in layout.optics] + [o.radius for o in layout.shaped], default=0.0)
    radius = reader.pupil / 2 * reader.unit if reader.pupil > 0 else widest / 2
    start = min([0.0, *(o.vertex[2] for o in layout.shaped), *(o.chord[2] for o in layout.optics)]) - 0.1
    layout.beams.append(Beam("input", np.array([0, 0, start]), np.array([0, 0, 1.0]), radius, -start, 1.0, reader.wavelength))
    layout.left_out.append(f"the light: the beam 'input' of {radius * 1e3:.4g} mm (1/e^2 radius) and 1 W is assumed")
    layout.left_out.append("coatings: faces reflect as uncoated glass, mirrors all light")
    image = reader.surfaces[-1] if reader.surfaces else None
    if image is not None and image.radius > 0:
        layout.planes.append(Plane("image", frame.origin, -frame.along * frame.axes[:, 2], 2 * image.radius * reader.unit))
