# SPDX-License-Identifier: BSD-3-Clause
"""theia .tia layouts: a line each for benches, beams and optics, arguments by order or by name, expressions with units."""

from __future__ import annotations

import ast
import math
import operator

import numpy as np

from .scene import Beam, Face, Layout, LayoutError, Optic, Plane, plain_name, sag

UNITS = {"km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "kW": 1e3, "W": 1.0, "mW": 1e-3, "uW": 1e-6,
         "nW": 1e-9, "ppm": 1e-6, "rad": 1.0, "deg": math.pi / 180, "pi": math.pi}
FUNCTIONS = {"sin": math.sin, "cos": math.cos, "tan": math.tan, "arcsin": math.asin, "arccos": math.acos,
             "arctan": math.atan, "sqrt": math.sqrt, "exp": math.exp}
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
             ast.Pow: operator.pow}
PLACE = {"X": 0.0, "Y": 0.0, "Z": 0.0, "Theta": math.pi / 2, "Phi": 0.0}
MIRROR = PLACE | {"Wedge": 0.0, "Alpha": 0.0, "HRK": 0.01, "ARK": 0.0, "Diameter": 0.1, "Thickness": 0.02, "N": 1.4585,
                  "HRr": 0.99, "HRt": 0.01, "ARr": 0.1, "ARt": 0.9, "KeepI": False}
KINDS = {                              # keyword: arguments in their order, with the values that theia gives them
    "bo": {"X": 0.0, "Y": 0.0, "Z": 0.0},
    "bm": {"Wx": 1e-3, "Wy": 1e-3, "WDistx": 0.0, "WDisty": 0.0, "Wl": 1.064e-6, "P": 1.0} | PLACE | {"Alpha": 0.0},
    "mr": MIRROR, "bs": MIRROR,
    "sp": {"RonHR": 0.0, "TonHR": 0.0, "RonAR": 0.0, "TonAR": 0.0} | MIRROR,
    "th": PLACE | {"Focal": 0.1, "Diameter": 0.05, "R": 0.1, "T": 0.9, "KeepI": False},
    "tk": PLACE | {"K1": 0.01, "K2": 0.001, "Diameter": 0.05, "Thickness": 0.02, "N": 1.4585, "R": 0.1, "T": 0.9,
                   "KeepI": False},
    "bd": PLACE | {"Diameter": 0.05, "Thickness": 0.02},
    "gh": PLACE | {"Diameter": 0.05},
}
NAMES = {"bo": "", "bm": "beam", "mr": "M", "bs": "BS", "sp": "SP", "th": "L", "tk": "L", "bd": "BD", "gh": "G"}
THIN_INDEX, THIN_EDGE = 1.4585, 1e-3   # of the real lens that represents a thin one


def evaluate(node):
    if isinstance(node, ast.Expression):
        return evaluate(node.body)
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float, str)):
        return node.value
    if isinstance(node, ast.Name) and node.id in UNITS:
        return UNITS[node.id]
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return OPERATORS[type(node.op)](evaluate(node.left), evaluate(node.right))
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        return -evaluate(node.operand) if isinstance(node.op, ast.USub) else evaluate(node.operand)
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") in FUNCTIONS and len(node.args) == 1:
        return FUNCTIONS[node.func.id](evaluate(node.args[0]))
    raise ValueError(f"'{ast.unparse(node)}' is neither a number, a unit nor a function of theia")


def arguments(line, kind):
    """Values by name. ValueError explains errors."""
    known = KINDS[kind]
    call = ast.parse(f"f({line})", mode="eval").body
    values, order, texts = dict(known), list(known), []
    for node in call.args:
        value = evaluate(node)
        if isinstance(value, str):
            texts.append(value)
        elif order:
            values[order.pop(0)] = value
        else:
            raise ValueError(f"too many values; '{kind}' takes {', '.join(known)}")
    for word in call.keywords:
        if word.arg not in known and word.arg not in ("Name", "Ref"):
            near = ", ".join(known)
            raise ValueError(f"'{kind}' has no '{word.arg}'; it takes {near}")
        if word.arg in known:
            values[word.arg] = evaluate(word.value)
        elif not (isinstance(word.value, ast.Constant) and word.value.value is None):
            texts.append(evaluate(word.value))
    for key, value in values.items():
        if not isinstance(value, bool) and not (isinstance(value, (int, float)) and math.isfinite(value)):
            raise ValueError(f"{key} is {value!r} and should be a finite number")
    return values, str(texts[-1]) if texts else NAMES[kind]


def basis(normal):
    """theia's axes across a direction: the first has the largest z component."""
    up = np.array([0, 0, 1.0])
    if abs(normal[2]) > 1 - 1e-9:
        first = np.array([math.copysign(1, normal[2]), 0, 0])
    else:
        first = up - np.dot(up, normal) * normal
        first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


class Reader:
    def __init__(self, path, layout):
        self.path, self.layout, self.taken, self.bench = path, layout, set(), np.zeros(3)

    def place(self, v):
        sine = math.sin(v["Theta"])
        return (np.array([v["X"], v["Y"], v["Z"]]) + self.bench,
                np.array([sine * math.cos(v["Phi"]), sine * math.sin(v["Phi"]), math.cos(v["Theta"])]))

    def add(self, kind, v, name, where):
        at, normal = self.place(PLACE | v)
        if kind == "bo":
            self.bench = np.array([v["X"], v["Y"], v["Z"]])
            return
        name = plain_name(name, self.taken)
        if kind == "bm":
            self.beam(v, name, at, normal)
        elif kind == "gh":
            self.layout.planes.append(Plane(name, at, normal, v["Diameter"]))
        elif kind in ("th", "tk"):
            self.lens(kind, v, name, at, normal, where)
        elif kind == "bd":
            black = Face(0, 0)
            self.layout.optics.append(Optic(name, at, normal, basis(normal)[0], v["Diameter"], v["Thickness"], 1.5, black,
                                            black, where=where))
            self.layout.dumps.append(name)
        else:
            self.mirror(kind, v, name, at, normal, where)

    def mirror(self, kind, v, name, at, normal, where):
        if kind == "sp":
            self.layout.left_out.append(f"'{name}': its orders of strayness; the optic itself is there")
        if v["ARK"] and v["Wedge"]:
            self.layout.left_out.append(f"'{name}': two curved faces with a wedge between them")
            return
        a, b = basis(normal)
        # The normal of the back leans by the wedge towards -sin(Alpha) a + cos(Alpha) b: there the glass is thinner.
        thick = math.sin(v["Alpha"]) * a - math.cos(v["Alpha"]) * b
        on_axis = v["Thickness"] + math.tan(v["Wedge"]) * v["Diameter"] / 2
        self.layout.optics.append(Optic(name, at, normal, thick, v["Diameter"], on_axis, v["N"], Face(v["HRr"], v["HRt"]),
                                        Face(v["ARr"], v["ARt"]), v["HRK"], v["ARK"], v["Wedge"], where))

    def lens(self, kind, v, name, at, normal, where):
        face = Face(v["R"], v["T"])
        half = v["Diameter"] / 2
        if kind == "tk":               # X, Y, Z: the vertex of the first face; thickness between the vertices
            front, back, index = v["K1"], v["K2"], v["N"]
            if max(abs(front), abs(back)) * half >= 1:
                raise ValueError(f"'{name}': a face is wider than the sphere it is cut from")
            chord = at + sag(front, half) * normal
            thickness = v["Thickness"] + sag(front, half) + sag(back, half)
        else:
            if v["Focal"] == 0:
                raise ValueError(f"'{name}': focal length 0")
            front = back = -0.5 / (v["Focal"] * (THIN_INDEX - 1))
            if abs(front) * half >= 1:
                raise ValueError(f"'{name}': a lens of this focal length and diameter does not exist; lower the diameter")
            index, bend = THIN_INDEX, sag(front, half)
            thickness = THIN_EDGE + max(0.0, 2 * bend)
            chord = at + thickness / 2 * normal
            self.layout.left_out.append(f"'{name}': a thin lens; a biconvex or biconcave one of index {THIN_INDEX} and an "
                                        f"edge or middle of {THIN_EDGE * 1e3:g} mm represents it")
        self.layout.optics.append(Optic(name, chord, normal, basis(normal)[0], v["Diameter"], thickness, index, face, face,
                                        front, back, where=where))

    def beam(self, v, name, at, direction):
        if not (v["Wx"] > 0 and v["Wy"] > 0 and v["Wl"] > 0 and v["P"] >= 0):
            raise ValueError(f"'{name}': waists, wavelength and power are above 0")
        if abs(v["Wx"] - v["Wy"]) > 1e-9 or abs(v["WDistx"] - v["WDisty"]) > 1e-9:
            self.layout.left_out.append(f"'{name}': elliptic beam; the mean of both waists is used")
        self.layout.beams.append(Beam(name, at, direction, math.sqrt(v["Wx"] * v["Wy"]), (v["WDistx"] + v["WDisty"]) / 2,
                                      v["P"], v["Wl"]))


def read_theia(path, text) -> Layout:
    layout, problems, titled = Layout("theia layout"), [], False
    reader = Reader(path, layout)
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.split("#", 1)[0].strip()
        if not line:
            continue
        word, _, rest = line.partition(" ") if " " in line else line.partition("\t")
        word, rest = word.strip(), rest.strip()
        if word not in KINDS and "\t" in word:
            word, _, rest = line.partition("\t")
        if word.split("=")[0] in ("order", "threshold"):
            layout.left_out.append(f"'{line}': give 'straytrace ghosts' --order and --floor instead")
        elif word in KINDS:
            try:
                reader.add(word, *arguments(rest, word), f"{path}:{number}:1")
            except SyntaxError as error:
                column = len(raw) - len(raw.lstrip()) + len(word) + max((error.offset or 3) - 2, 0)
                problems.append(f"{path}:{number}:{column}: error: cannot read '{rest[:60]}'; write for example "
                                "'X = 1*m, Phi = 45*deg', with decimal points")
            except (ValueError, ZeroDivisionError, TypeError, OverflowError) as error:
                problems.append(f"{path}:{number}:1: error: {error}")
        elif not titled:
            layout.title = line
        else:
            problems.append(f"{path}:{number}:1: error: unknown keyword '{word}'; known: {', '.join(KINDS)}")
        titled = True
    if problems:
        raise LayoutError(problems)
    return layout
