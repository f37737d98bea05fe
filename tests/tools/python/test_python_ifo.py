# SPDX-License-Identifier: BSD-3-Clause
"""Interferometers in Python: the numbers of `straytrace ifo` as tables, against closed forms of the cavity of
examples/ifo_cavity.yaml (docs/theory/interferometer.md)."""
import subprocess
import unittest
import warnings

import numpy as np
from python_arm import SOURCE

import straytrace

CAVITY, LOOPS, MODES = (str(SOURCE / "examples" / f"ifo_{name}.yaml") for name in ("cavity", "loops", "modes"))
LENGTH, T1, T2, CARRIER = 3000.0, 0.02, 0.004, 0.9950062422     # m; mirrors; J_0(0.1)^2, share of the carrier
SPEED_OF_LIGHT = 299792458.0


def circulating(phase):
    """Carrier in the cavity [W], of 1 W before the modulator; phase: one way."""
    r1, r2 = np.sqrt(1 - T1), np.sqrt(1 - T2)
    return CARRIER * T1 / np.abs(1 - r1 * r2 * np.exp(2j * phase)) ** 2


class Cavity(unittest.TestCase):
    def setUp(self):
        self.ifo = straytrace.Interferometer(CAVITY)

    def test_operating_point(self):
        point = self.ifo.operating_point()
        r = np.sqrt((1 - T1) * (1 - T2))
        cavity = point["cavities"].loc["ITM-ETM"]
        self.assertAlmostEqual(cavity.finesse / (np.pi * np.sqrt(r) / (1 - r)), 1, places=9)
        self.assertEqual(point["cavities"].attrs["units"]["pole"], "Hz")
        transmitted = point["readouts"]["value"]["transmitted"]
        self.assertAlmostEqual(transmitted / (T2 * circulating(0)), 1, places=4)      # its sidebands: 5e-6
        self.assertGreater(abs(transmitted / (T1 * circulating(0)) - 1), 0.5, "control: the other mirror")
        self.assertTrue(np.isnan(point["readouts"]["value"]["PDH"]))

    def test_scan(self):
        scan = self.ifo.scan("LENGTH", "-5 nm", "5 nm", points=5)
        self.assertEqual(scan.index.name, "LENGTH")
        np.testing.assert_allclose(scan.index, np.linspace(-5e-9, 5e-9, 5), atol=1e-20)
        expected = T2 * circulating(2 * np.pi / 1064e-9 * scan.index.to_numpy())
        np.testing.assert_allclose(scan.transmitted, expected, rtol=1e-4)
        with self.assertRaises(straytrace.InputError):
            self.ifo.scan("LENGTH", -5e-9, 5e-9)                # no unit

    def test_responses_are_one_complex_number(self):
        response = self.ifo.transfer("LENGTH", "PDH", band=(100, "1 kHz"), points=3)
        self.assertEqual(response.attrs, {"unit": "W/m"})
        sensing = self.ifo.sensing(at=100)
        self.assertEqual(sensing.index.name, "readout")
        self.assertEqual(sensing["LENGTH"]["PDH"], sensing.loc["PDH", "LENGTH"])
        self.assertLess(abs(sensing["LENGTH"]["PDH"] / response.iloc[0] - 1), 1e-9)
        self.assertGreater(abs(np.conj(sensing["LENGTH"]["PDH"]) / response.iloc[0] - 1), 0.1, "control: the other sign of time")
        self.assertTrue(np.isnan(sensing["LENGTH"]["transmitted"]))
        # From the slope of errors(): light of the end mirror arrives after one way, and builds up with every round trip.
        r, lag = np.sqrt((1 - T1) * (1 - T2)), np.exp(-2j * np.pi * response.index * LENGTH / SPEED_OF_LIGHT)
        expected = self.ifo.errors().slope["PDH", "LENGTH"] * (1 - r) * lag / (1 - r * lag**2)
        np.testing.assert_allclose(response, expected, rtol=5e-4)        # signals on the sidebands: 3e-4 at 1 kHz

    def test_slopes(self):
        slopes = self.ifo.slopes("transmitted")
        self.assertAlmostEqual(slopes.slope["laser.power"], self.ifo.operating_point()["readouts"]["value"]["transmitted"], places=9)
        self.assertEqual(slopes.unit["laser.power"], "W")

    def test_noise(self):
        noise = self.ifo.noise("PDH", referred_to="LENGTH", band=("100 Hz", "1 kHz"), points=2)
        watts = self.ifo.noise("PDH", band=("100 Hz", "1 kHz"), points=2)
        response = self.ifo.transfer("LENGTH", "PDH", band=("100 Hz", "1 kHz"), points=2).abs()
        np.testing.assert_allclose(noise.vacuum * response, watts.vacuum, rtol=1e-9)
        self.assertEqual((noise.attrs["units"]["total"], watts.attrs["units"]["total"]), ("m/sqrt(Hz)", "W/sqrt(Hz)"))

    def test_changes_of_the_model_act(self):
        model = straytrace.Model.load(CAVITY)
        ifo = straytrace.Interferometer(model)
        before = ifo.operating_point()["cavities"].finesse.iloc[0]
        model.interferometer.network.components.ITM = {"mirror": {"transmission": "4 %"}}
        self.assertLess(ifo.operating_point()["cavities"].finesse.iloc[0], 0.6 * before)
        self.assertEqual(straytrace.Interferometer(model.data).operating_point()["cavities"].shape[0], 1)

    def test_network_is_a_model(self):
        network = self.ifo.network()
        again = straytrace.Interferometer(network).operating_point()["ports"].leaves
        np.testing.assert_allclose(again, self.ifo.operating_point()["ports"].leaves, rtol=1e-9)

    def test_wrong_input(self):
        with self.assertRaisesRegex(straytrace.InputError, "no cause 'nothing'"):
            self.ifo.transfer("nothing", "PDH")
        with self.assertRaisesRegex(TypeError, "at is True"):
            self.ifo.sensing(at=True)
        with self.assertRaisesRegex(ValueError, "one frequency"):
            self.ifo.sensing(at="10 Hz, 20 Hz")

    def test_no_frequency_is_the_default(self):
        np.testing.assert_array_equal(self.ifo.sensing(None), self.ifo.sensing())


class Others(unittest.TestCase):
    def test_loops_and_stray_light(self):
        ifo = straytrace.Interferometer(LOOPS)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tables, stray = ifo.loops(at="20 Hz"), ifo.stray(at="20 Hz")
            curve = ifo.stray_transfer("recycling-cavity", "AS", band=(20, 40), points=2)
        loops = tables["loops"]
        np.testing.assert_allclose(loops.suppression, np.abs(1 / (1 + loops.gain)), rtol=1e-9)
        parts = tables["stray"].filter(like="by_").columns
        self.assertEqual(set(parts), {f"by_{name}" for name in loops.length})
        self.assertLess(abs(stray.loc[("recycling-cavity", "AS"), "phase"] / curve["phase"].iloc[0] - 1), 1e-9)

    def test_modes(self):
        tables = straytrace.Interferometer(MODES).modes()
        orders = tables["content"].filter(like="order_")
        np.testing.assert_allclose(orders.sum(axis=1), 1, rtol=1e-9)

    def test_program_prints_the_same(self):
        said = subprocess.run([straytrace.engine.program(), "ifo", CAVITY, "--show", "scan", "LENGTH", "-1nm", "1nm",
                               "--points", "3", "--csv"], capture_output=True, text=True, check=True).stdout
        rows = [line.split(",") for line in said.splitlines() if line and line[0] in "-0123456789"]
        scan = straytrace.Interferometer(CAVITY).scan("LENGTH", "-1 nm", "1 nm", points=3)
        self.assertEqual([float(row[1]) for row in rows], list(scan.transmitted))


if __name__ == "__main__":
    unittest.main()
