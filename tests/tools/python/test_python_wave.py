# SPDX-License-Identifier: BSD-3-Clause
"""The field of a cavity in Python, from a made-up group /wave."""
import pathlib
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(SOURCE / "python"))
sys.dont_write_bytecode = True

import h5py  # noqa: E402
import numpy as np  # noqa: E402

from straytrace.wave import seam_of, wave_of, wave_ring_of  # noqa: E402


def made_wave(file, fields=True):
    """Two edges, of which the grid holds the light that meets the first, with two draws of the tolerances."""
    def texts(values):
        return np.array([v.encode() for v in values], dtype="S20")

    group = file.create_group("wave")
    group.attrs.update(beam=np.bytes_("arm"), power=3e6, wavelength=1064e-9, length=1e4, points=4, window=2.0, crossover=1e-4,
                       eigenvalue_real=0.6, eigenvalue_imaginary=-0.8 * (1 - 1e-7), loss=8e-8,
                       loss_of_smooth_mirrors=np.nan, beyond_band=1e-9)
    group["warnings"] = texts([])
    group["mirrors/name"], group["mirrors/lost"] = texts(["ITM", "ETM"]), [3e-8, 4e-8]
    group["heights/loss"] = [8e-8]
    for mirror, size in (("mirror1", 1), ("mirror2", 2)):
        group[f"heights/{mirror}_figure_real"] = size * np.ones((1, 3))
        group[f"heights/{mirror}_figure_imaginary"] = -size * np.ones((1, 3))
    group["modes/n"], group["modes/loss"] = [0, 1], [1e-7, 1e-6]
    group["edges/name"] = texts(["baffle_a", "baffle_b"])
    group["edges/centre"] = [[0, 0, 4000.0], [0, 0, 9000.0]]
    for name in ("radius", "angle1", "angle2", "speckle_across", "speckle_along"):
        group["edges/" + name] = [4.0, 16.0]
    group["edges/towards_mirror2"], group["edges/towards_mirror1"] = [1e-9, 3e-9], [2e-9, 4e-9]
    group["edges/draw_offset"] = np.array([0, 3, 3], dtype=np.uint64)
    lever = np.array([[9, 9, 9], [3, 4, 1], [5, 0, 1]], dtype=float)
    for kind in ("displacement", "rotation"):
        group[f"draws/{kind}_real"], group[f"draws/{kind}_imaginary"] = 0.6 * lever, -0.8 * lever
    group["draws/tolerance"] = np.arange(3, dtype=np.uint32)
    light = np.arange(12, dtype=np.float32).reshape(3, 4)        # rings of four sectors
    planes = [(1, 0), (2, 0), (3, 0), (0, 1), (1, 1), (2, 1)]
    for name, values in {"plane": [p for p, _ in planes], "towards_mirror1": [b for _, b in planes], "step": [0.5] * 6,
                         "rings": [3] * 6, "sectors": [4] * 6}.items():
        group["irradiance/" + name] = values
    group["irradiance/mean"] = np.concatenate([(i + 1) * light.ravel() for i in range(6)])
    group["irradiance/mean_square"] = np.concatenate([((i + 1) * light.ravel()) ** 2 for i in range(6)])
    if fields:
        group.attrs["device"] = np.bytes_("some GPU")
        group["photodiodes/name"], group["photodiodes/edge"] = texts(["d_1", "d_2"]), np.array([1, 2**32 - 1], dtype=np.uint32)
        group["photodiodes/centre"], group["photodiodes/area"] = [[0.45, 0.0], [0.0, 0.46]], [1e-4, 1e-4]
        for name, values in {"power": [2e-9, np.nan], "mean": [1e-9, 3e-9], "spread": [1e-9, 2e-9]}.items():
            group["photodiodes/" + name] = values
        group["by_frequency/from"], group["by_frequency/loss"] = [10.0, 20.0], [-1e-9, 5e-9]
        group["by_frequency"].attrs.update(meaning=np.bytes_("loss"), smooth=3e-9, beyond=6e-8)
        group.create_group("grid_check").attrs.update(points=np.array([6], dtype=np.uint64), loss=1e-12, along=np.nan)
        group["fields/at"] = np.array([-1, -0.5, 0, 0.5])
        for i, name in enumerate(("mirror1", "mirror2")):
            group["fields/" + name] = np.arange(32, dtype=np.float32).reshape(4, 4, 2) + i


class WaveArrays(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        with h5py.File(pathlib.Path(self.folder.name) / "run.h5", "w") as file:
            self.assertIsNone(wave_of(file))
            made_wave(file)
            self.wave = wave_of(file)

    def test_light_is_found_by_plane_and_direction(self):
        wave = self.wave
        self.assertEqual([len(wave.light(p)) for p in ("ITM", "baffle_a", "ETM", "none")], [1, 2, 1, 0])
        (light,) = wave.light("baffle_a", towards="ITM")
        self.assertEqual((light.place, light.towards), (4000, "ITM"))
        np.testing.assert_array_equal(light.mean, 5 * np.arange(12).reshape(3, 4))
        np.testing.assert_array_equal(light.mean_square, light.mean**2)
        np.testing.assert_allclose(light.radius, [0.25, 0.75, 1.25])
        np.testing.assert_allclose(light.azimuth, np.pi * np.array([0.25, 0.75, 1.25, 1.75]))
        np.testing.assert_allclose(light.area.sum() * 4, np.pi * 1.5**2)
        np.testing.assert_allclose(light.profile, 5 * np.array([1.5, 5.5, 9.5]))
        (other,) = wave.light("baffle_a", towards="ETM")
        self.assertFalse(np.array_equal(light.mean, other.mean))

    def test_photodiodes_in_watts(self):
        light = self.wave.light_on_photodiodes()
        self.assertEqual(list(light.index), ["d_1", "d_2"])
        self.assertEqual(list(light["y"]), [0.0, 0.46])
        np.testing.assert_allclose(light["mean"], [3e-3, 9e-3])
        np.testing.assert_allclose(light["spread"], [3e-3, 6e-3])
        np.testing.assert_allclose(light["power"], [6e-3, np.nan])
        self.assertEqual(self.wave.device, "some GPU")
        self.wave.power = 0.0                       # control: not stated, so shares
        np.testing.assert_allclose(self.wave.light_on_photodiodes()["mean"], [1e-9, 3e-9])

    def test_levers_are_complex_and_by_edge(self):
        drawn = self.wave.levers(0)
        self.assertEqual(drawn.shape, (3, 6))
        self.assertAlmostEqual(drawn[1, 1], 4 * (0.6 - 0.8j))
        self.assertEqual(self.wave.levers(1).shape, (0, 6))

    # rms over the draws of the tolerances: (9 + 16 + 25 + 0)/2/2 = 12.5 across; the edges as in the scene stay out.
    def test_table_has_the_method_of_each_edge(self):
        table = self.wave.table()
        self.assertEqual(list(table["method"]), ["wave", "speckle"])
        self.assertAlmostEqual(table["across"].iloc[0], np.sqrt(12.5))
        self.assertAlmostEqual(table["along"].iloc[0], 1)
        self.assertTrue(np.isnan(table["across"].iloc[1]))
        self.assertEqual(list(table["speckle_across"]), [2, 4])
        np.testing.assert_allclose(table["power"], [3e6 * 3e-9, 3e6 * 7e-9])

    def test_ledger_and_loss(self):
        self.assertEqual(self.wave.loss, 8e-8)
        for mirror, size in (("mirror1", 1), ("mirror2", 2)):
            np.testing.assert_array_equal(self.wave.heights[mirror + "_figure"], size * np.full((1, 3), 1 - 1j))
        ledger = self.wave.ledger()
        self.assertAlmostEqual(sum(ledger.values()), 7e-8 + 1e-8 + 1e-9, places=20)
        self.assertEqual(ledger["on baffles, towards ETM"], 4e-9)

    def test_checks_of_the_solution_are_there_where_they_were_made(self):
        self.assertEqual(list(self.wave.by_frequency["loss"]), [-1e-9, 5e-9])
        self.assertEqual((self.wave.by_frequency["smooth"], "meaning" in self.wave.by_frequency), (3e-9, False))
        self.assertEqual((self.wave.grid_check["points"], self.wave.grid_check["loss"]), (6, 1e-12))
        with h5py.File(pathlib.Path(self.folder.name) / "bare.h5", "w") as file:
            made_wave(file, fields=False)
            wave = wave_of(file)
        self.assertEqual((wave.device, wave.photodiodes, len(wave.light_on_photodiodes())), ("cpu", None, 0))
        self.assertEqual((wave.grid_check, wave.by_frequency), (None, None))

    def test_fields_are_complex_images(self):
        self.assertEqual([f.dtype for f in self.wave.fields], [np.complex64] * 2)
        self.assertEqual(self.wave.fields[0].shape, (4, 4))
        self.assertEqual(self.wave.fields[0][1, 2], 12 + 13j)
        self.assertEqual(self.wave.fields[1][1, 2], 13 + 14j)
        self.assertEqual(len(self.wave.at), 4)
        with h5py.File(pathlib.Path(self.folder.name) / "bare.h5", "w") as file:
            made_wave(file, fields=False)
            self.assertEqual((wave_of(file).fields, wave_of(file).at), ([], None))


class RingCavity(unittest.TestCase):
    """A made-up group /wave_ring."""

    def test_levers_by_surface(self):
        with tempfile.TemporaryDirectory() as folder, h5py.File(pathlib.Path(folder) / "run.h5", "w") as file:
            self.assertIsNone(wave_ring_of(file))
            group = file.create_group("wave_ring")
            group.attrs.update(beam=np.bytes_("mode_cleaner"), power=10.0, wavelength=1064e-9, length=300.0, points=4, window=0.1,
                               crossover=1e-3, eigenvalue_real=0.6, eigenvalue_imaginary=0.8, reverse_eigenvalue_real=0.6,
                               reverse_eigenvalue_imaginary=0.79, loss=1e-6, beyond_band=1e-9)
            group["warnings"] = np.array([], dtype="S20")
            group["modes/n"] = [0, 1]
            group["surfaces/name"] = np.array([b"baffle", b"end"], dtype="S20")
            for kind, size in (("displacement", 1.0), ("rotation", 10.0)):
                rows = size * np.array([[1.0, 2, 3], [4, 5, 6]])
                group[f"surfaces/{kind}_real"], group[f"surfaces/{kind}_imaginary"] = rows, -rows
            group.create_group("grid_check").attrs.update(points=np.array([6], dtype=np.uint64), loss=1e-12)
            group["grid_check/lost"] = [1e-13, 2e-13]
            ring = wave_ring_of(file)
        self.assertEqual((ring.beam, ring.points, ring.reverse_eigenvalue), ("mode_cleaner", 4, 0.6 + 0.79j))
        np.testing.assert_array_equal(ring.levers("end"), (1 - 1j) * np.array([4, 5, 6, 40, 50, 60]))
        self.assertEqual((ring.grid_check["points"], ring.grid_check["loss"]), (6, 1e-12))
        np.testing.assert_array_equal(ring.grid_check["lost"], [1e-13, 2e-13])
        with self.assertRaisesRegex(KeyError, "it has baffle, end"):
            ring.levers("mirror")


class Seam(unittest.TestCase):
    """A made-up group /seam."""

    def test_pairs_of_value_and_error(self):
        with tempfile.TemporaryDirectory() as folder, h5py.File(pathlib.Path(folder) / "run.h5", "w") as file:
            self.assertIsNone(seam_of(file))
            of = file.create_group("seam").attrs
            of.update(frequency=10.0, crossover=2e-4, other_crossover=1.4e-4, histories=1000)
            for name, base in (("baffles", 1.0), ("total", 2.0)):
                for i, key in enumerate(("strain", "other", "change")):
                    of[f"{name}_{key}"], of[f"{name}_{key}_sigma"] = base + i, base / 10
            seam = seam_of(file)
        self.assertEqual((seam.histories, seam.other_crossover), (1000, 1.4e-4))
        self.assertEqual(seam.baffles, {"strain": (1.0, 0.1), "other": (2.0, 0.1), "change": (3.0, 0.1)})
        self.assertEqual(seam.total["change"], (4.0, 0.2))


if __name__ == "__main__":
    unittest.main()
