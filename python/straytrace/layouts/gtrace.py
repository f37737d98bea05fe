# SPDX-License-Identifier: BSD-3-Clause
"""gtrace layouts: JSON of OpticalLayout.save, optics and sources in a plane, lengths in m, angles in rad."""

from __future__ import annotations

import math

import numpy as np

from .scene import Beam, Face, Layout, LayoutError, Optic, plain_name, sag


class Reader:
    def __init__(self, path):
        self.path, self.problems, self.taken = path, [], set()

    def value(self, table, place, key, size=1, fallback=None):
        """Numbers of a key; NaN and a problem when they are not there."""
        got = table.get(key, fallback)
        values = got if size > 1 else [got]
        if isinstance(values, list) and len(values) == size and all(
                isinstance(v, (int, float)) and not isinstance(v, bool) and math.isfinite(v) for v in values):
            return np.array(values, float) if size > 1 else float(values[0])
        what = "is missing" if got is None else f"is {got!r}"
        self.problems.append(f"{self.path}: error: {place}: '{key}' {what}; write {size} finite "
                             f"number{'s' * (size > 1)}")
        return np.full(size, np.nan) if size > 1 else math.nan

    def optic(self, table, number, left_out):
        place = f"optics[{number}] '{table.get('name', '')}'"
        if table.get("type") not in ("Mirror", "CyMirror", "Lens"):
            self.problems.append(f"{self.path}: error: {place}: unknown type {table.get('type')!r}; Mirror, CyMirror or Lens")
            return None
        get = {k: self.value(table, place, k) for k in
               ("normAngleHR", "diameter", "thickness", "wedgeAngle", "inv_ROC_HR", "inv_ROC_AR", "Refl_HR", "Trans_HR",
                "Refl_AR", "Trans_AR", "n")}
        apex = self.value(table, place, "HRcenter", 2)
        name = plain_name(table.get("name", "optic"), self.taken)
        if table["type"] == "CyMirror" and get["inv_ROC_HR"]:
            left_out.append(f"'{name}': a cylindrical face; scenes have spherical ones")
            return None
        if get["inv_ROC_AR"] and get["wedgeAngle"]:
            left_out.append(f"'{name}': two curved faces with a wedge between them")
            return None
        turn = get["normAngleHR"]
        normal = np.array([math.cos(turn), math.sin(turn), 0])
        bend = get["inv_ROC_HR"] * get["diameter"] / 2
        chord = np.append(apex, 0.0)
        if abs(bend) < 1:
            chord = chord + sag(get["inv_ROC_HR"], get["diameter"] / 2) * normal
        return Optic(name, chord, normal, np.array([-normal[1], normal[0], 0]), get["diameter"], get["thickness"], get["n"],
                     Face(get["Refl_HR"], get["Trans_HR"]), Face(get["Refl_AR"], get["Trans_AR"]), get["inv_ROC_HR"],
                     get["inv_ROC_AR"], get["wedgeAngle"], f"{self.path}: {place}")

    def beam(self, table, number, left_out):
        place = f"sources[{number}] '{table.get('name', '')}'"
        start = self.value(table, place, "pos", 2)
        turn, wavelength = self.value(table, place, "dirAngle"), self.value(table, place, "wl")
        power = self.value(table, place, "P", fallback=1.0)
        # q = z + i z_R, z the way from the waist: where Re q is negative the waist lies ahead.
        qx, qy = self.value(table, place, "qx", 2), self.value(table, place, "qy", 2)
        if not (qx[1] > 0 and qy[1] > 0):
            self.problems.append(f"{self.path}: error: {place}: Rayleigh length {qx[1]:g}, {qy[1]:g}; both above 0")
            return None
        name = plain_name(table.get("name", "beam"), self.taken)
        if abs(qx - qy).max() > 1e-6 * qx[1]:
            left_out.append(f"'{name}': elliptic beam; the mean of both waists is used")
        q = (qx + qy) / 2
        return Beam(name, np.append(start, 0.0), np.array([math.cos(turn), math.sin(turn), 0]),
                    math.sqrt(q[1] * wavelength / math.pi), -q[0], power, wavelength)


def read_gtrace(path, content) -> Layout:
    if not isinstance(content.get("optics"), list):
        raise LayoutError([f"{path}: error: no list 'optics'; save the layout by OpticalLayout.save of gtrace"])
    reader, layout = Reader(path), Layout(str(content.get("name", "gtrace layout")))
    for number, table in enumerate(content["optics"]):
        layout.optics.append(reader.optic(table, number, layout.left_out))
    for number, table in enumerate(content.get("sources", [])):
        layout.beams.append(reader.beam(table, number, layout.left_out))
    if reader.problems:
        raise LayoutError(reader.problems)
    layout.optics = [o for o in layout.optics if o]
    if "rules" in content:
        layout.left_out.append("tracing rules: give 'straytrace ghosts' --order and --floor instead")
    return layout
