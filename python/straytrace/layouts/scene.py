# SPDX-License-Identifier: BSD-3-Clause
"""A specular layout, from any program, and the resulting scene. Lengths in m, angles in rad, powers in W."""

from __future__ import annotations

import dataclasses
import math

import numpy as np


class LayoutError(ValueError):
    """All problems of a layout, one line each."""

    def __init__(self, problems):
        super().__init__("\n".join(problems))
        self.problems = list(problems)


@dataclasses.dataclass
class Face:
    reflect: float
    transmit: float


@dataclasses.dataclass
class Optic:
    """A substrate between two faces. `normal` points out of the front face; `thick_side` is across it, where a wedge
    makes the glass thicker. Curvatures in 1/m, positive for concave faces. `thickness` between the planes of the rims,
    on the axis."""

    name: str
    chord: np.ndarray                  # centre of the plane of the front rim
    normal: np.ndarray
    thick_side: np.ndarray
    diameter: float
    thickness: float
    index: float
    front: Face | None                 # None: uncoated glass
    back: Face | None
    curvature_front: float = 0.0
    curvature_back: float = 0.0
    wedge: float = 0.0
    where: str = ""                    # file and line, for messages
    preset: str = ""                   # medium of the program instead of `index`


@dataclasses.dataclass
class Profile:
    """A face of revolution about its normal: curvature in 1/m, positive for a concave face; conic constant; coefficients of the
    4th, 6th, 8th and 10th power in SI."""

    curvature: float
    conic: float = 0.0
    terms: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    @property
    def spherical(self) -> bool:
        return not (self.conic and self.curvature or any(self.terms))

    def sag(self, radius: float) -> float:
        """Height of the rim before the vertex, m; NaN where the face ends before."""
        under = 1 - (1 + self.conic) * (self.curvature * radius)**2
        if under < 0:
            return math.nan
        return self.curvature * radius**2 / (1 + math.sqrt(under)) + sum(a * radius**(4 + 2 * i) for i, a in enumerate(self.terms))

    def shape(self, radius: float, hole: float = 0.0, decentre: tuple[float, float] = (0.0, 0.0)) -> str:
        keys = f"outer_radius: {number(radius)} m" + (f", inner_radius: {number(hole)} m" if hole else "")
        if self.spherical and not hole and not any(decentre):
            return f"{{cap: {{{keys}, curvature: {number(self.curvature)} /m}}}}" if self.curvature else f"{{disk: {{{keys}}}}}"
        keys += f", curvature: {number(self.curvature)} /m" if self.curvature else ""
        keys += f", conic_constant: {number(self.conic)}" if self.conic else ""
        keys += "".join(f", a{n}: {a:.12g} /m^{n - 1}" for n, a in zip((4, 6, 8, 10), self.terms) if a)
        keys += "".join(f", decentre_{axis}: {number(d)} m" for axis, d in zip("xy", decentre) if d)
        return f"{{conic: {{{keys}}}}}"


@dataclasses.dataclass
class Shaped:
    """An optic that no part describes: a mirror, which is a face without glass, or a lens with a face that is no sphere."""

    name: str
    vertex: np.ndarray
    normal: np.ndarray                 # out of the front
    across: np.ndarray                 # x of the decentre
    radius: float
    front: Profile
    back: Profile | None = None        # None: a mirror
    thickness: float = 0.0             # on the axis
    index: float = 1.0
    preset: str = ""
    hole: float = 0.0                  # of a mirror: radius
    decentre: tuple[float, float] = (0.0, 0.0)


@dataclasses.dataclass
class Beam:
    name: str
    start: np.ndarray
    direction: np.ndarray
    waist: float                       # 1/e^2 radius of the intensity
    ahead: float                       # distance of the waist from `start`
    power: float
    wavelength: float


@dataclasses.dataclass
class Plane:
    """A disc that counts the light that passes it."""

    name: str
    at: np.ndarray
    normal: np.ndarray
    diameter: float


@dataclasses.dataclass
class Layout:
    title: str
    optics: list[Optic] = dataclasses.field(default_factory=list)
    shaped: list[Shaped] = dataclasses.field(default_factory=list)
    beams: list[Beam] = dataclasses.field(default_factory=list)
    dumps: list[str] = dataclasses.field(default_factory=list)       # names of optics on which light is counted
    planes: list[Plane] = dataclasses.field(default_factory=list)
    left_out: list[str] = dataclasses.field(default_factory=list)


def sag(curvature: float, radius: float) -> float:
    """Height of the vertex behind the plane of the rim, m; positive for a concave face."""
    return curvature * radius**2 / (1 + math.sqrt(1 - (curvature * radius)**2))


def problems_of(optic: Optic) -> list[str]:
    """Problems of an optic, one line each, with the remedy."""
    found = []
    for face, side in ((optic.front, "front (HR)"), (optic.back, "back (AR)")):
        if face and min(face.reflect, face.transmit) < 0 or face and face.reflect + face.transmit > 1 + 1e-12:
            found.append(f"{optic.where}: error: '{optic.name}', {side}: R = {face.reflect:g}, T = {face.transmit:g}; "
                         "both 0 or more, and together at most 1")
    for value, what in ((optic.diameter, "diameter"), (optic.thickness, "thickness"), (optic.index, "index")):
        if not (math.isfinite(value) and value > 0):
            found.append(f"{optic.where}: error: '{optic.name}': {what} {value:g}; write a number above 0")
    widest = max(abs(optic.curvature_front), abs(optic.curvature_back)) * optic.diameter / 2
    if not widest < 1:
        found.append(f"{optic.where}: error: '{optic.name}': a face is wider than the sphere it is cut from; lower its "
                     "curvature or its diameter")
    return found


def number(value: float) -> str:
    return f"{round(value, 15) + 0.0:.12g}"       # neither -0 nor the rounding of a cosine


def vector(values, unit="") -> str:
    return "[" + ", ".join(number(v) + unit for v in values) + "]"


def rotation(normal, across):
    """Axis and angle that take +z to `normal` and +x to `across`."""
    z = normal / np.linalg.norm(normal)
    x = across - np.dot(across, z) * z
    x /= np.linalg.norm(x)
    matrix = np.stack([x, np.cross(z, x), z], axis=1)
    angle = math.acos(np.clip((np.trace(matrix) - 1) / 2, -1, 1))
    axis = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    if math.pi - angle < 1e-6:         # half a turn: the axis is the eigenvector to 1
        values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
        axis = vectors[:, np.argmax(values)]
    return (axis / np.linalg.norm(axis) if angle > 1e-12 else np.array([0, 0, 1.0])), angle


def entry_of(optic: Optic) -> str:
    radius = optic.diameter / 2
    front, back = (sag(c, radius) for c in (optic.curvature_front, optic.curvature_back))
    vertex = optic.chord - front * optic.normal
    middle = optic.thickness - front - back
    if optic.curvature_back:           # two curved faces: the part has convex radii positive
        radii = ", ".join(f"radius_{i}: {number(-1 / c)} m" for i, c in
                          ((1, optic.curvature_front), (2, optic.curvature_back)) if c)
        part = f"use: lens, diameter: {number(optic.diameter)} m, thickness: {number(middle)} m, {radii}"
    else:
        curved = f", radius_of_curvature: {number(1 / optic.curvature_front)} m" if optic.curvature_front else ""
        wedge = f", wedge: {number(optic.wedge)} rad" if optic.wedge else ""
        part = f"use: thick_mirror, radius: {number(radius)} m, thickness: {number(middle)} m{curved}{wedge}"
    if optic.wedge:
        axis, angle = rotation(optic.normal, optic.thick_side)
        turned = f"rotate: {{axis: {vector(axis)}, angle: {number(angle)} rad}}"
    else:
        turned = f"facing: {vector(optic.normal)}"
    return (f"  - {{name: {optic.name}, {part}, medium: {medium_of(optic)},\n     at: {vector(vertex, ' m')}, {turned},\n"
            f"     body: bench, material: {optic.name}_front, surfaces: {{back: {optic.name}_back, barrel: black}}}}\n")


def part_of(lens: Shaped) -> str:
    """A part of the scene: two faces and a barrel."""
    assert lens.back is not None
    return (f"  {lens.name}_lens:\n    faces:\n      front: {{shape: {lens.front.shape(lens.radius)}}}\n"
            f"      barrel: {{shape: {{cylinder: {{radius: {number(lens.radius)} m, "
            f"from: {number(-lens.thickness - lens.back.sag(lens.radius))} m, to: {number(lens.front.sag(lens.radius))} m}}}}}}\n"
            f"      back: {{shape: {lens.back.shape(lens.radius)}, at: [0 m, 0 m, {number(-lens.thickness)} m], facing: [0, 0, -1]}}\n")


def shaped_entry(optic: Shaped) -> str:
    axis, angle = rotation(optic.normal, optic.across)
    turned = f"rotate: {{axis: {vector(axis)}, angle: {number(angle)} rad}}" if any(optic.decentre) else f"facing: {vector(optic.normal)}"
    if optic.back is None:
        what = f"shape: {optic.front.shape(optic.radius, optic.hole, optic.decentre)}, side: front"
        faces = f"material: {optic.name}_front"
    else:
        what = f"use: {optic.name}_lens, medium: {medium_of(optic)}"
        faces = f"material: {optic.name}_front, surfaces: {{back: {optic.name}_back, barrel: black}}"
    return f"  - {{name: {optic.name}, {what},\n     at: {vector(optic.vertex, ' m')}, {turned},\n     body: bench, {faces}}}\n"


def medium_of(optic: Optic | Shaped) -> str:
    return optic.preset or "n_" + number(optic.index).replace(".", "_").replace("-", "_")


def beam_text(beam: Beam) -> str:
    return (f"  {beam.name}: {{from: {vector(beam.start, ' m')}, facing: {vector(beam.direction)}, lit: yes,\n"
            f"    waist: {{radius: {number(beam.waist)} m, ahead: {number(beam.ahead)} m}}, power: {number(beam.power)} W, "
            f"wavelength: {number(beam.wavelength * 1e9)} nm}}\n")


def scene_text(layout: Layout, source: str) -> str:
    """The scene (YAML). LayoutError where an optic cannot be, or where nothing is left."""
    problems = [line for optic in layout.optics for line in problems_of(optic)]
    if not layout.optics and not layout.shaped:
        problems.append(f"{source}: error: the layout holds no optic that can be translated")
    if problems:
        raise LayoutError(problems)
    text = f"straytrace: 1\ntitle: {json_string(layout.title)}\n# made from {source}\n"
    text += "".join(f"# not translated: {note}\n" for note in layout.left_out)
    text += "materials:\n  black: {}\n"
    for optic in layout.optics:
        for side, face in (("front", optic.front), ("back", optic.back)):
            specular = f"{{reflect: {number(face.reflect)}, transmit: {number(face.transmit)}}}" if face else "fresnel"
            text += f"  {optic.name}_{side}: {{specular: {specular}}}\n"
    for shaped in layout.shaped:
        if shaped.back is None:
            text += f"  {shaped.name}_front: {{specular: {{reflect: 1}}}}\n"
        else:
            text += f"  {shaped.name}_front: {{specular: fresnel}}\n  {shaped.name}_back: {{specular: fresnel}}\n"
    lenses = [o for o in layout.shaped if o.back is not None]
    media = {medium_of(o): o.index for o in [*layout.optics, *lenses] if not o.preset}
    if media:
        text += "media:\n" + "".join(f"  {name}: {{index: {number(index)}}}\n" for name, index in sorted(media.items()))
    if lenses:
        text += "parts:\n" + "".join(map(part_of, lenses))
    text += "bodies: {bench: {motion: still}}\nscene:\n" + "".join(map(entry_of, layout.optics)) + "".join(map(shaped_entry, layout.shaped))
    if layout.beams:
        text += "beams:\n" + "".join(beam_text(b) for b in layout.beams)
    return text + receivers_text(layout)


def receivers_text(layout: Layout) -> str:
    lines = [f"  on_{name}: {{on: {name}/front, side: front}}\n" for name in layout.dumps]
    lines += [f"  {p.name}: {{shape: {{disk: {{outer_radius: {number(p.diameter / 2)} m}}}}, at: {vector(p.at, ' m')}, "
              f"facing: {vector(p.normal)}}}\n" for p in layout.planes]
    if not lines:
        return "# add ports and an interferometer, or receivers, to run it\n"
    return "receivers:\n" + "".join(lines)


def json_string(text: str) -> str:
    return '"' + text.replace("\\", " ").replace('"', "'") + '"'


def plain_name(text: str, taken: set[str]) -> str:
    """A name that a scene accepts, not in `taken`, to which it is added."""
    name = "".join(c if c.isalnum() and c.isascii() or c == "_" else "_" for c in str(text)) or "optic"
    if not name[0].isalpha():
        name = "o" + name
    base, count = name, 2
    while name in taken:
        name, count = f"{base}_{count}", count + 1
    taken.add(name)
    return name
