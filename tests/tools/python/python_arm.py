# SPDX-License-Identifier: BSD-3-Clause
"""A small model for tests of the Python package: an arm with one baffle, as a user would build it."""
import os
import pathlib
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PROGRAM = os.environ.get("STRAYTRACE_PROGRAM", str(SOURCE / "build" / "straytrace"))
sys.path.insert(0, str(SOURCE / "python"))
sys.dont_write_bytecode = True
os.environ["STRAYTRACE_PROGRAM"] = PROGRAM

import straytrace  # noqa: E402

BLOCK = 4096  # histories
HISTORIES = 32 * BLOCK


def arm(**tables):
    """A model; `tables` replace its own."""
    mirror = {"use": "mirror", "body": "mirrors", "material": "hr"}
    return straytrace.Model({
        "title": "An arm with one baffle",
        "params": {"lambda": "1064 nm", "L": straytrace.quantity(3, "km"), "rim": "49.5 cm"},
        "materials": {
            "hr": {"specular": {"reflect": "1 - 100 ppm"},
                   "scatter": [{"model": "power-law", "kappa": "2e-9 /sr", "exponent": 2.2, "above": "50 urad"},
                               {"model": "lambertian", "tis": "4 ppm"}]},
            "steel": {"scatter": {"model": "lambertian", "brdf": "5e-2 /sr"}}},
        "bodies": {"mirrors": {"motion": "still"},
                   "tube": {"motion": {"z": {"peterson": "high"}, "x": {"like": "z"}, "y": {"like": "z"}}}},
        "scene": [
            {"name": "ITM", **mirror, "facing": (0, 0, 1), "radius_of_curvature": "1420 m"},
            {"name": "ETM", **mirror, "at": ("0 m", "0 m", "L"), "facing": (0, 0, -1), "radius_of_curvature": "1683 m"},
            {"name": "baffle", "body": "tube", "material": "steel", "at": ["0 m", "0 m", "400 m"], "facing": [0, 0, -1],
             "shape": {"cone": {"inner_radius": "rim", "outer_radius": "59 cm", "half_angle": "35 deg"}}}],
        "beams": {"arm": {"cavity": ["ITM", "ETM"], "wavelength": "lambda", "power": "650 kW"}},
        "ports": {"ITM": {"beam": "arm", "at": "ITM"}, "ETM": {"beam": "arm", "at": "ETM"}},
        "interferometer": {"preset": "fabry-perot-michelson", "arm_length": "L", "mirror_mass": "42 kg",
                           "input_transmission": "1.4 %"},
        "trace": {"seed": 1, "histories": HISTORIES},
        "noise": {"band": ["5 Hz", "1 kHz"], "compare": ["adv-lal"]}, **tables})
