# SPDX-License-Identifier: BSD-3-Clause
"""The Python package: tables, conditions, pictures, and results for gwpy, pygwinc and FINESSE."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

from python_arm import SOURCE, arm

import finesse
import h5py
import numpy as np

import straytrace
import straytrace.engine
import straytrace.finesse
from straytrace.curves import Curve
from straytrace.curves import between_bins, log_log
from straytrace.reading import text, texts


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_ = arm().run(progress=False)

    def test_tables_hold_what_the_arrays_hold(self):
        noise, table = self.run_.noise, self.run_.noise.table()
        np.testing.assert_array_equal(table["h"], noise.total.mean)
        np.testing.assert_array_equal(table.index, noise.frequency)
        self.assertEqual(list(table.columns[-2:]), ["adv-lal", "bound"])
        balance = self.run_.energy_balance.table()
        terms = balance.drop(index="emitted")
        self.assertAlmostEqual(terms["share"].sum(), 1, places=9)
        routes = self.run_.routes.table()
        self.assertEqual(routes["coupling"].isna().sum(), int(np.sum(~self.run_.routes.trusted)))
        self.assertEqual(self.run_.provenance["seed"], 1)

    def test_columns_of_routes_are_those_of_the_run_file(self):
        routes = self.run_.routes
        with h5py.File(self.run_.path) as file:
            stored = file["classes"]
            np.testing.assert_array_equal(routes.coupling, stored["mean"][()])
            np.testing.assert_array_equal(routes.trusted, stored["trusted"][()] == 1)
            self.assertEqual(routes.columns["reverse"], ("1", text(stored["reverse"].attrs["meaning"])))
            self.assertEqual(routes.port, [texts(file["names/ports"])[i] for i in stored["port"][()]])
        self.assertEqual(set(routes.kind), {"scattered"})
        self.assertTrue(all(meaning for _, meaning in routes.columns.values()), routes.columns)
        with self.assertRaisesRegex(AttributeError, "no column 'lever'.*why_not"):
            routes.lever
        self.assertIn("model.yaml", self.run_.provenance["files"])

    def test_paths_are_picked_by_what_is_said_of_them(self):
        paths = self.run_.paths()
        table = paths.table(frequencies=[30])
        self.assertEqual(len(table), len(self.run_.routes.name))
        by_name = {r.name: r for r in self.run_.noise.routes}
        first = paths[0]
        self.assertAlmostEqual(first.strain(30), float(self.run_.noise.at(30, by_name[first.sequence])))
        self.assertAlmostEqual(table["share"].sum(), 1, places=9)
        via = self.run_.paths(where='via("baff*") and resolved')
        self.assertEqual([p.sequence for p in via], [p.sequence for p in paths if "baffle" in p.sequence and p.resolved])
        self.assertTrue(0 < len(via) < len(paths))
        for where, test in (("share > 5 %", lambda p: p.share > 0.05), ("h(30 Hz) > 1e-26", lambda p: p.strain(30) > 1e-26),
                            ('via("ITM") and not scatters == 2', lambda p: "ITM" in p.objects and p.scatters != 2),
                            ("opl < 5 km or rank == 1", lambda p: p.opl < 5000 or p.rank == 1)):
            wanted = [p.id for p in paths if test(p)]
            self.assertEqual([p.id for p in paths.where(where)], wanted, where)
            self.assertTrue(0 < len(wanted) < len(paths), where)      # a condition that picks all or none tests nothing
        self.assertEqual(len(paths.where(lambda p: p.rank < 3)), 2)
        low = self.run_.paths(low=30, high=100)
        shares = dict(zip([r.name for r in self.run_.noise.routes], self.run_.noise.shares(30, 100)[0]))
        for p in low:
            if p.resolved:
                self.assertAlmostEqual(p.share, shares[p.sequence], places=12)
        self.assertNotAlmostEqual(low[0].share, first.share, places=11)           # a band that changes nothing tests nothing

    def test_wrong_conditions_are_errors(self):
        paths = self.run_.paths()
        for where, words in (("shares > 1 %", "'shares' is not known"), ("share > 1", "share needs a unit"), ("via(3)", "'3'"),
                             ("1 + 2 == 3", "a number comes first"), ("__import__('os')", "is not known"),
                             ("h('30')", "write h"), ("opl > 3 Hz", "is not a unit of opl")):
            with self.assertRaisesRegex(straytrace.InputError, words):
                paths.where(where)

    def test_pictures_and_copies(self):
        with tempfile.TemporaryDirectory() as folder:
            self.run_.save(pathlib.Path(folder, "kept.h5"))
            self.assertEqual(straytrace.open(pathlib.Path(folder, "kept.h5")).histories, self.run_.histories)
            figure = self.run_.plot(pathlib.Path(folder, "run.png"), low=10, high=100)
            self.assertGreater(pathlib.Path(folder, "run.png").stat().st_size, 50000)
        with self.assertRaisesRegex(straytrace.RunError, "maps of: nothing"):
            self.run_.plot_map("PD")
        self.assertIn("10 to 100 Hz", [a.get_title(loc="left") for a in figure.axes][1])

    def test_gwpy_gets_regular_axes_or_a_reason(self):
        noise = self.run_.noise
        with self.assertRaisesRegex(ValueError, "interpolate=0.5"):
            noise.to_gwpy()
        series = noise.to_gwpy(interpolate=0.5)
        self.assertEqual((str(series.unit), series.df.value), ("1 / Hz(1/2)", 0.5))
        self.assertTrue(noise.frequency[0] <= series.f0.value < noise.frequency[0] + 0.5)
        np.testing.assert_allclose(series.value, log_log(series.frequencies.value, noise.frequency, noise.total.mean))
        self.assertTrue(np.all(np.isfinite(series.value)))
        law = log_log(np.array([20.0]), np.array([10.0, 40.0]), np.array([1.0, 1 / 16]))     # 1/f^2 stays 1/f^2
        np.testing.assert_allclose(law, 0.25)

    def test_pygwinc_budget_gives_back_the_strain(self):
        import gwinc
        from straytrace.pygwinc import StrayLight

        f = np.geomspace(10, 500, 40)
        base = gwinc.load_budget("aLIGO", freq=f)
        kind = type("Budget", (type(base),), {"noises": [StrayLight.of(self.run_)]})
        total = kind(freq=f, ifo=base.ifo).run().psd
        np.testing.assert_allclose(np.sqrt(total), self.run_.noise.at(f), rtol=1e-9)
        self.assertFalse(np.allclose(np.sqrt(total), self.run_.noise.at(f) * base.ifo.Infrastructure.Length, atol=0))


class Reading(unittest.TestCase):
    def test_a_line_is_read_from_its_bin(self):
        edges = np.geomspace(6, 15, 25)
        own = int(np.searchsorted(edges, 10)) - 1
        for background in (0.0, 1e-26):
            mean = np.full(24, background)
            mean[own] = 1.7e-24
            self.assertEqual(between_bins(10, edges, mean), 1.7e-24)
            self.assertEqual(between_bins(0.999 * edges[own], edges, mean), background)
            centre = np.sqrt(edges[:-1] * edges[1:])
            self.assertGreater(abs(log_log(10.0, centre, mean) / 1.7e-24 - 1), 0.1)    # control: between the centres
        np.testing.assert_allclose(between_bins([7.0, 10.0], edges, np.sqrt(edges[:-1] * edges[1:]) ** -9.0), [7.0**-9, 1e-9])
        self.assertTrue(np.all(np.isnan(between_bins([5.9, 15.0], edges, np.ones(24)))))

    def test_upper_bounds_are_known_as_such(self):
        one = np.ones(3)
        curve = Curve("total", one, 0.01 * one, one, one, bound_share=np.array([0.0, 0.001, 0.5]))
        self.assertEqual(list(curve.at_most), [False, False, True])    # 0.001 hides in the error
        self.assertFalse(Curve("total", one, 0.01 * one, one, one).at_most.any())


DUAL_RECYCLED = """
modes(off)
l laser P=125
m PRM T=0.05 L=0
bs BS T=0.5 L=0 alpha=45
m SRM T=0.2 L=0
m ITMx T=0.014 L=0
m ETMx T=4.4e-6 L=75e-6 phi=1e-5
m ITMy T=0.014 L=0 phi=90
m ETMy T=4.4e-6 L=75e-6 phi=90
s inp laser.p1 PRM.p1
s rec PRM.p2 BS.p1
s sig BS.p4 SRM.p1
s shx BS.p3 ITMx.p1
s shy BS.p2 ITMy.p1
s ax ITMx.p2 ETMx.p1 L=3000
s ay ITMy.p2 ETMy.p1 L=3000
fsig(1)
readout_dc AS SRM.p2.o
"""


class OfReceivers(unittest.TestCase):
    def test_watts_and_maps(self):
        run = straytrace.run(SOURCE / "examples/two_mirrors.yaml", histories=4096, progress=False)
        self.assertIsNone(run.noise)
        self.assertEqual(run.paths().rows, [])
        self.assertEqual(list(run.maps), ["PD", "plane"])
        self.assertEqual(run.maps["PD"].image.shape, (48, 48))
        self.assertEqual(list(run.receivers.table().index), ["PD", "plane"])
        seen = np.nansum(run.maps["PD"].image)
        self.assertTrue(0 < seen <= run.maps["PD"].power * (1 + 1e-9), (seen, run.maps["PD"].power))
        self.assertGreater(len(run.plot_map("PD").axes), 2)
        with self.assertRaisesRegex(straytrace.InputError, "without an interferometer"):
            run.project({"bodies": {"bench": {"motion": "still"}}})

    def test_areas_are_those_of_the_tables(self):
        """Even light of 1/(pi R^2) on a disc: pixels and cells that its rim cuts have the irradiance of the others, and the field
        is the root of it. Control: over whole cells they are darker."""
        with tempfile.TemporaryDirectory() as name:
            scene = pathlib.Path(name) / "disc.yaml"
            scene.write_text("straytrace: 1\nmaterials: {black: {}}\nbodies: {b: {motion: still}}\nscene:\n"
                             "  - {name: det, shape: {disk: {outer_radius: 5 cm}}, at: [0 m, 0 m, 1 m], facing: [0, 0, -1],"
                             " body: b, material: black}\n"
                             "beams: {light: {from: [0 m, 0 m, 0 m], facing: [0, 0, 1], profile: even, radius: 6 cm}}\n"
                             "receivers: {pixels: {on: det, map: {pixels: [9, 9], width: 10.2 cm}},"
                             " cells: {on: det, map: {width: 10.2 cm}}}\n")
            run = straytrace.run(scene, histories=2**18, progress=False)
            subprocess.run([straytrace.engine.program(), "maps", run.path, "-o", name], check=True, capture_output=True)
            uniform = 1 / (np.pi * 0.06**2)
            for receiver in run.receivers:
                lines = (pathlib.Path(name) / f"{receiver.name}_image.csv").read_text().splitlines()
                rows = np.genfromtxt([line for line in lines if not line.startswith("#")], delimiter=",", names=True)
                areas = np.ravel(receiver.areas)
                np.testing.assert_array_equal(areas, rows["area_m2"])
                receiver.within_rim, within = None, receiver.within_rim
                whole = np.broadcast_to(np.ravel(receiver.areas), areas.shape)
                receiver.within_rim = within
                cut = (areas < 0.8 * whole) & (areas > 0.2 * whole)
                self.assertGreater(cut.sum(), 5)
                light = np.ravel(receiver.image)
                self.assertAlmostEqual(np.nansum(light[cut]) / areas[cut].sum() / uniform, 1, delta=0.03)
                self.assertLess(np.nansum(light[cut]) / whole[cut].sum() / uniform, 0.85)
                if receiver.field is not None:
                    np.testing.assert_allclose(abs(np.ravel(receiver.field))[cut]**2, (light / areas)[cut], rtol=1e-9)


class FromFinesse(unittest.TestCase):
    F = np.array([10.0, 100.0, 1000.0])

    @classmethod
    def setUpClass(cls):
        cls.kat = finesse.Model()
        cls.kat.parse(DUAL_RECYCLED)

    def test_sidebands_at_the_laser_are_its_modulation(self):
        from finesse.analysis.actions import FrequencyResponse

        theirs = self.kat.run(FrequencyResponse(self.F, ["laser.amp.i", "laser.phs.i"], ["AS.DC.o"])).out[:, 0]
        ours = straytrace.finesse.response(self.kat, inject="laser.p1.o", frequencies=self.F)
        np.testing.assert_allclose(ours.amplitude, theirs[:, 0], rtol=1e-6)
        np.testing.assert_allclose(ours.phase, theirs[:, 1], rtol=1e-6)

    def test_light_behind_an_end_mirror_counts_as_its_displacement(self):
        """docs/theory/interferometer.md, eq. 9.3: a phase quadrature s of light that enters through T is the displacement T lambda/(4 pi) s;
        DARM of one metre is half a metre on either end mirror."""
        found = straytrace.finesse.response(self.kat, inject="ETMx.p2.i", relative_to="ETMx.p2.o", frequencies=self.F)
        np.testing.assert_allclose(abs(found.phase / found.darm), 4.4e-6 * 1064e-9 / (4 * np.pi), rtol=2e-3)
        control = straytrace.finesse.response(self.kat, inject="ETMx.p2.i", relative_to="ETMx.p1.i", frequencies=self.F)
        self.assertFalse(np.allclose(abs(control.phase / found.phase), 1, rtol=0.5))    # relative to other light

    def test_the_files_are_read_by_the_program(self):
        f = np.geomspace(4, 300, 60)
        found = straytrace.finesse.response(self.kat, inject="ETMx.p2.i", relative_to="ETMx.p2.o", frequencies=f)
        with tempfile.TemporaryDirectory() as folder:
            model = bench(pathlib.Path(folder))
            run = model.run(progress=False)
            said = found.save(pathlib.Path(folder, "responses"), "SNEB")
            response = straytrace.Model({"interferometer": {"responses": {"SNEB": said}}}, folder=folder, name="finesse.yaml")
            theirs = run.noise(response=response)
        inside = run.noise.total.mean > 0
        self.assertGreater(inside.sum(), 20)
        # The preset has recycling cavities of some length and radiation pressure; the phase quadrature is eq. 9.3 in both.
        np.testing.assert_allclose(theirs.total.phase[inside], run.noise.total.phase[inside], rtol=0.02)
        with self.assertRaisesRegex(ValueError, "no light"):
            straytrace.finesse.response(self.kat, inject="SRM.p2.i", frequencies=f)


def bench(folder):
    """An end bench of Advanced Virgo (docs/reference/interferometer.md)."""
    motion = {"z": {"line": {"at": "0.35 Hz", "width": "0.05 Hz", "rms": "2 um rms"}}, "others": "still"}
    return straytrace.Model({
        "materials": {"lens": {"specular": {"reflect": "100 ppm"}, "scatter": {"model": "lambertian", "brdf": "1e-3 /sr"}}},
        "bodies": {"bench": {"motion": motion}},
        "scene": [{"name": "lens", "shape": {"disk": {"outer_radius": "2 cm"}}, "facing": [0, 0, 1], "side": "front",
                   "body": "bench", "material": "lens"}],
        "beams": {"leak": {"on": "lens", "radius": "5 mm", "travel": [0, 0, -1]}},
        "ports": {"SNEB": {"beam": "leak", "at": "lens"}},
        "interferometer": {"preset": "adv", "ports": {"SNEB": {"at": "end-bench", "copies": 1}}},
        "trace": {"seed": 1, "histories": 1 << 17}, "noise": {"band": ["5 Hz", "200 Hz"]}}, folder=folder)


if __name__ == "__main__":
    sys.exit(unittest.main())
