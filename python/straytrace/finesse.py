# SPDX-License-Identifier: BSD-3-Clause
"""FINESSE 3 models (the extra straytrace[finesse]): responses of ports to stray light, and models as networks of scenes.

A stray field at a port is the main light there times s (docs/theory/interferometer.md): its real part is an amplitude,
its imaginary part a phase modulation. Both sidebands of s are injected at the node where the light enters, and the
readout responds in W. Divided by its response to DARM, this is the input of `responses` of an interferometer
(docs/reference/interferometer.md)::

    found = straytrace.finesse.response(kat, inject="ETMx.p2.i", relative_to="ETMx.p2.o", frequencies=f)
    model.interferometer.responses = {"SNEB": found.save("responses", "SNEB")}

`python3 -m straytrace.finesse MODEL.kat -o network.yaml` writes the network of a model as a scene for `straytrace ifo`, after
the powers at all ports have been compared. `--export SCENE -o MODEL.kat` writes a model of the network of a scene.
"""

from __future__ import annotations

import argparse
import os
import pathlib
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import InputError, NumericalError

ComplexArray = npt.NDArray[np.complex128]
DARM: Mapping[str, float] = {"ETMx.mech.z": -0.5, "ETMy.mech.z": 0.5}    # one metre of difference of the arms


@dataclass
class Response:
    """Response of one readout, [n] over frequency, complex, for exp(+iwt)."""

    frequency: npt.NDArray[np.float64]    # Hz
    phase: ComplexArray                   # W per relative field in quadrature with the main light (Im s)
    amplitude: ComplexArray               # W per relative field in phase with it (Re s)
    darm: ComplexArray                    # W/m

    def save(self, folder: str | os.PathLike[str], name: str) -> dict[str, str | list[str]]:
        """Writes NAME_phase.txt, NAME_amplitude.txt and NAME_darm.txt into `folder`, and returns the entry of the port
        for `responses`; the names are relative to a model next to `folder`."""
        folder = pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        said: dict[str, str | list[str]] = {"columns": ["Hz", "re", "im"], "unit": "W"}
        for what, unit in (("phase", "W per relative field"), ("amplitude", "W per relative field"), ("darm", "W/m")):
            place = folder / f"{name}_{what}.txt"
            values = getattr(self, what)
            np.savetxt(place, np.column_stack([self.frequency, values.real, values.imag]), fmt="%.12g",
                       header=f"Hz, re, im of the response to {what} [{unit}], for exp(+iwt); from FINESSE")
            said[what] = f"{folder.name}/{place.name}"
        return said


def _sidebands(model: Any, node: str, fields: Any, main: str, f: npt.NDArray[np.float64],
               readout: str) -> tuple[ComplexArray, ComplexArray]:
    """Answers to the real and the imaginary part of s: sidebands E s/2 above and below every carrier. The lower one is
    solved for as its conjugate."""
    from finesse.analysis.actions import FrequencyResponse2

    light = np.asarray(fields[main]).reshape(-1, fields.fields.shape[-1])       # [carriers, modes]
    carriers = [(float(getattr(value, "f", value)), e) for value, e in zip(fields.frequencies, light) if np.any(e != 0)]
    if not carriers:
        raise ValueError("the reference node of the stray field has no light, so there is no response")
    inputs = [(node, value + sign * model.fsig.f.ref) for value, _ in carriers for sign in (1, -1)]
    out = model.run(FrequencyResponse2(f, inputs, [readout])).out[:, 0]         # [frequencies, inputs, modes]
    amplitude, phase = np.zeros(len(f), complex), np.zeros(len(f), complex)
    for k, (_, e) in enumerate(carriers):
        upper, lower = out[:, 2 * k] @ e / 2, out[:, 2 * k + 1] @ np.conj(e) / 2
        amplitude += upper + lower
        phase += 1j * (upper - lower)
    return amplitude, phase


def response(model: Any, *, inject: str, frequencies: npt.ArrayLike, relative_to: str | None = None,
             readout: str = "AS.DC.o", darm: Mapping[str, float] = DARM) -> Response:
    """Response of `readout` [W] to stray light at a node of a FINESSE model.

    inject: optical node where the light enters, in its direction: "ETMx.p2.i", or "ITMx.p2.o" inside an arm.
    relative_to: node of the main light to which the couplings of the port are relative
    (docs/reference/interferometer.md, Ports); default: `inject`.
    frequencies: Hz, above 0.
    readout: the readout, in W.
    darm: inputs with their weights for one metre of DARM.

    The model needs `fsig`; with higher modes the stray light has the mode content of the main light."""
    try:
        from finesse.analysis.actions import DCFields, FrequencyResponse
    except ImportError:
        raise ImportError("responses need FINESSE 3, which is not here: pip install finesse") from None
    f = np.atleast_1d(np.asarray(frequencies, float))
    if not np.all(f > 0):
        raise ValueError("frequencies are in Hz, above 0")
    fields = model.run(DCFields())
    amplitude, phase = _sidebands(model, inject, fields, relative_to or inject, f, readout)
    moved = model.run(FrequencyResponse(f, list(darm), [readout])).out[:, 0]
    return Response(f, phase, amplitude, np.asarray(moved) @ np.array(list(darm.values()), complex))


def _converted(options: argparse.Namespace) -> str:
    from . import finesse_network as networks

    if options.export:
        return networks.model_of_scene(options.input)
    try:
        import finesse
    except ImportError:
        raise InputError("reading a model needs FINESSE 3, which is not here: pip install finesse") from None
    model = finesse.Model()
    model.parse(pathlib.Path(options.input).read_text(encoding="utf-8"))
    text, warnings = networks.network_of_model(model)
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)
    return text


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="straytrace.finesse", description="Writes the network of a FINESSE model as a scene, or back.")
    parser.add_argument("input", metavar="MODEL.kat or SCENE.yaml")
    parser.add_argument("--export", action="store_true", help="from a scene to a FINESSE model")
    parser.add_argument("-o", "--out", required=True, help="the file to write")
    options = parser.parse_args(arguments)
    try:
        pathlib.Path(options.out).write_text(_converted(options), encoding="utf-8")
    except (InputError, NumericalError, OSError) as error:
        print(error if str(error).startswith("error") else f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
