# SPDX-License-Identifier: BSD-3-Clause
"""Sequential lens files of Zemax (.zmx): centred spherical lenses along +z, from the first surface at the origin; glass catalogues
(.agf)."""

from __future__ import annotations

import dataclasses
import math
import pathlib

import numpy as np

from .scene import Beam, Layout, LayoutError, Optic, Plane, plain_name, sag

UNITS = {"MM": 1e-3, "CM": 1e-2, "IN": 25.4e-3, "METER": 1.0, "M": 1.0}
# Glasses that are presets of the program, by the names of catalogues.
PRESETS = {"BK7": "bk7", "N-BK7": "bk7", "N-BK7HT": "bk7", "F_SILICA": "fused_silica", "SILICA": "fused_silica", "LITHOSIL-Q": "fused_silica",
           "SAPPHIRE": "sapphire", "CAF2": "calcium_fluoride", "SILICON": "silicon"}
SURFACES = ("STANDARD", "EVENASPH", "ODDASPHE")


@dataclasses.dataclass
class Surface:
    number: int
    line: int
    kind: str = "STANDARD"
    curvature: float = 0.0              # per unit of the file, positive with the centre behind the surface
    gap: float = 0.0                    # to the next surface
    radius: float = 0.0                 # clear semi-diameter
    glass: list[str] = dataclasses.field(default_factory=list)
    bent: str = ""                      # what makes it other than a sphere


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
            s.radius = self.number(rest[0], line)
        elif key == "GLAS":
            s.glass = rest
        elif key == "CONI" and self.number(rest[0], line) != 0:
            s.bent = f"conic constant {rest[0]}"
        elif key == "PARM" and s.kind in SURFACES[1:] and self.number(rest[1], line) != 0:
            s.bent = f"aspheric coefficient {rest[0]}"

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


def optic_of(reader: Reader, front: Surface, back: Surface, z: float, layout: Layout, taken: set[str]) -> Optic | None:
    bent = next((s for s in (front, back) if s.bent or s.kind not in SURFACES), None)
    if bent is not None:
        layout.left_out.append(f"surfaces {front.number} and {back.number}: surface {bent.number} is no sphere "
                               f"({bent.bent or bent.kind}); use the shape conic, or a mesh")
        return None
    index, preset = reader.glass_of(front, layout.left_out)
    radius, unit = max(front.radius, back.radius) * reader.unit, reader.unit
    place = f"{reader.path}:{front.line}"
    if not (radius > 0 and math.isfinite(front.gap)):
        reader.refuse(front.line, f"surface {front.number}: semi-diameter {front.radius:g}, thickness {front.gap:g}",
                      "state both (DIAM, DISZ)")
        return None
    concave = -front.curvature / unit, back.curvature / unit
    if max(map(abs, concave)) * radius >= 1:
        reader.refuse(front.line, f"surface {front.number}: a face is wider than the sphere it is cut from", "lower its semi-diameter")
        return None
    normal, depths = np.array([0, 0, -1.0]), [sag(c, radius) for c in concave]
    return Optic(plain_name(f"L{front.number}", taken), np.array([0, 0, z]) + depths[0] * normal, normal, np.array([1.0, 0, 0]), 2 * radius,
                 front.gap * unit + sum(depths), index, None, None, concave[0], concave[1], 0.0, place, preset)


def read_zemax(path: str, text: str, glasses: dict[str, Glass]) -> Layout:
    reader = Reader(path, text, glasses)
    layout, taken, z = Layout(reader.title), {"image", "input", "black", "bench"}, 0.0
    surfaces = reader.surfaces
    for s, after in zip(surfaces, surfaces[1:]):
        if s.glass and s.glass[0].upper() == "MIRROR" or s.kind == "COORDBRK":
            reader.refuse(s.line, f"surface {s.number} is a mirror or a coordinate break", "only centred lenses can be read: export the system as STEP")
        elif s.glass:
            layout.optics.append(optic_of(reader, s, after, z, layout, taken))
        if s.number > 0:
            z += s.gap * reader.unit
    if reader.problems:
        raise LayoutError(reader.problems)
    layout.optics = [o for o in layout.optics if o]
    add_light(reader, layout, z)
    return layout


def add_light(reader: Reader, layout: Layout, z: float) -> None:
    """A collimated beam as wide as the entrance pupil, and the image as a receiver."""
    radius = reader.pupil / 2 * reader.unit if reader.pupil > 0 else layout.optics[0].diameter / 4 if layout.optics else 0.0
    layout.beams.append(Beam("input", np.array([0, 0, -0.1]), np.array([0, 0, 1.0]), radius, 0.1, 1.0, reader.wavelength))
    layout.left_out.append(f"the light: the beam 'input' of {radius * 1e3:.4g} mm (1/e^2 radius) and 1 W is assumed")
    layout.left_out.append("coatings: faces reflect as uncoated glass")
    image = reader.surfaces[-1] if reader.surfaces else None
    if image is not None and image.radius > 0 and math.isfinite(z):
        layout.planes.append(Plane("image", np.array([0, 0, z]), np.array([0, 0, -1.0]), 2 * image.radius * reader.unit))
