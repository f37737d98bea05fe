#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`straytrace signal` against scipy, number by number, and its files against h5py. Usage: test_signal.py PROGRAM
(R2.15, R6.05)"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np
from scipy import signal

from records import Records

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
RECORDS = Records("tools.signal", PROGRAM)
RATE, START, COUNT = 256, 1234567890.25, 256 * 40
CLOSE = 1e-10                                           # relative, of the largest line where lines are tiny

RANDOM = np.random.default_rng(1)
DRIVE = np.cumsum(RANDOM.normal(size=COUNT)) * 0.1 + RANDOM.normal(size=COUNT) + 3
ANSWER = signal.lfilter([0.2, 0.1], [1, -1.5, 0.8], DRIVE) + 0.3 * RANDOM.normal(size=COUNT)
WINDOWS = {"hann": "hann", "hamming": "hamming", "blackman": "blackman", "blackmanharris": "blackmanharris",
           "flattop": "flattop", "tukey(0.3)": ("tukey", 0.3), "kaiser(14)": ("kaiser", 14), "rectangular": "boxcar"}


def write_gwpy(file, name, values, unit, dtype=float):
    """As gwpy writes a series."""
    data = file.create_dataset(name, data=np.asarray(values, dtype=dtype))
    data.attrs.update(x0=START, dx=1 / RATE, xunit="s", unit=unit, name=name.split("/")[-1], channel="X1:" + name)
    return data


def ask(*words, code=0):
    done = subprocess.run([str(PROGRAM), "signal", *map(str, words)], text=True, capture_output=True)
    assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if code == 0 else done.stderr


def columns(*words):
    sheet = json.loads(ask(*words, "--format", "json", "--quiet"))
    all_columns = [sheet["x"], *sheet["y"]]
    return {c["name"]: np.array([np.nan if v is None else v for v in c["values"]]) for c in all_columns}


def close(test, got, wanted, tolerance=CLOSE):
    test.assertEqual(got.shape, wanted.shape)
    worst = np.max(np.abs(got - wanted) / np.maximum(np.abs(wanted), 1e-6 * np.max(np.abs(wanted))))
    test.assertTrue(RECORDS.below(f"relative difference, {test.id().split('.')[-1]}", worst, tolerance), (worst, tolerance))


class AgainstScipy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.data = pathlib.Path(cls.place.name) / "data.hdf5"
        with h5py.File(cls.data, "w") as f:
            write_gwpy(f, "drive", DRIVE, "um / s2")
            write_gwpy(f, "answer", ANSWER, "um")
        cls.drive, cls.answer = f"{cls.data}::drive", f"{cls.data}::answer"

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def path(self, name):
        return str(pathlib.Path(self.place.name) / name)

    def test_windows(self):
        for ours, theirs in WINDOWS.items():
            got = columns("psd", self.drive, "--power", "--segment", "2 s", "--window", ours)
            f, p = signal.welch(DRIVE, RATE, theirs, 512, detrend="constant")
            with self.subTest(ours):
                close(self, got["frequency"], f)
                close(self, got["psd"], p)

    def test_detrend_average_overlap(self):
        for detrend in ("constant", "linear", "none"):
            for average in ("mean", "median"):
                for overlap in (0, 50, 75):
                    got = columns("psd", self.drive, "--power", "--segment", "2 s", "--detrend", detrend,
                                  "--average", average, "--overlap", f"{overlap} %")
                    _, p = signal.welch(DRIVE, RATE, "hann", 512, noverlap=512 * overlap // 100, average=average,
                                        detrend=False if detrend == "none" else detrend)
                    with self.subTest(f"{detrend} {average} {overlap}"):
                        close(self, got["psd"], p)

    def test_odd_segment(self):
        got = columns("psd", self.drive, "--segment", f"{501 / RATE} s")
        _, p = signal.welch(DRIVE, RATE, "hann", 501, noverlap=250)
        close(self, got["asd"], np.sqrt(p))

    def test_cross_spectra(self):
        _, pxy = signal.csd(DRIVE, ANSWER, RATE, "hann", 512)
        _, pxx = signal.welch(DRIVE, RATE, "hann", 512)
        _, pyy = signal.welch(ANSWER, RATE, "hann", 512)
        _, c = signal.coherence(DRIVE, ANSWER, RATE, "hann", 512)
        close(self, columns("coherence", self.drive, self.answer, "--segment", "2 s")["coherence"], c)
        for name, wanted in {"h1": pxy / pxx, "h2": pyy / np.conj(pxy)}.items():
            got = columns("transfer", self.drive, self.answer, "--segment", "2 s", "--estimator", name)
            close(self, got["modulus"] * np.exp(1j * np.radians(got["phase"])), wanted)
            control = got["modulus"] * np.exp(-1j * np.radians(got["phase"]))
            self.assertGreater(np.max(np.abs(control - wanted)), 0.1 * np.max(np.abs(wanted)))

    def test_spectrogram(self):
        out = self.path("map.json")
        ask("spectrogram", self.drive, "--segment", "1 s", "--stride", "1 s", "-o", out)
        sheet = json.loads(pathlib.Path(out).read_text())
        f, t, p = signal.spectrogram(DRIVE, RATE, "hann", 256, 0, detrend="constant")
        close(self, np.array(sheet["frequency_Hz"]), f)
        close(self, np.array(sheet["time_s"]) - START, t, 1e-6)
        close(self, np.array(sheet["value"]).T, np.sqrt(p))

    def test_filters(self):
        for band, sos in {"5 Hz..40 Hz": signal.butter(4, [5, 40], "bandpass", fs=RATE, output="sos"),
                          "0 Hz..40 Hz": signal.butter(4, 40, "lowpass", fs=RATE, output="sos"),
                          "5 Hz..128 Hz": signal.butter(4, 5, "highpass", fs=RATE, output="sos")}.items():
            got = columns("convert", self.drive, "--band", band)["X1:drive"]
            with self.subTest(band):  # other sections, other padding: the settling at the ends differs by little
                wanted = signal.sosfiltfilt(sos, DRIVE)
                middle = slice(COUNT // 4, 3 * COUNT // 4)
                close(self, got[middle], wanted[middle], 1e-6)
        got = columns("convert", self.drive, "--notch", "50 Hz")["X1:drive"]
        close(self, got, signal.filtfilt(*signal.iirnotch(50, 30, RATE), DRIVE, padlen=9), 1e-8)

    def test_displacement(self):
        _, p = signal.welch(DRIVE, RATE, "hann", 512)
        f = np.arange(257) / 2
        got = columns("displacement", self.drive, "--asd", "--segment", "2 s")
        close(self, got["asd"], 1e-6 * np.sqrt(p[1:]) / (2 * np.pi * f[1:]) ** 2)

    def test_displacement_of_metres_keeps_the_microseism(self):
        t = np.arange(COUNT) / RATE
        slow, fast = 3 * np.sin(2 * np.pi * 0.2 * t), 0.5 * np.sin(2 * np.pi * 20 * t)
        with h5py.File(self.path("slow.hdf5"), "w") as f:
            write_gwpy(f, "x", slow + fast, "um")
        words = ("displacement", self.path("slow.hdf5"))
        *_, kept = columns(*words).values()
        *_, control = columns(*words, "--corner", "1 Hz").values()
        close(self, kept, 1e-6 * (slow + fast))
        self.assertLess(np.std(control[COUNT // 4:3 * COUNT // 4]), 0.5e-6)      # the high pass that was the default
        self.assertIn("not integrated, so without a high pass", ask(*words))
        self.assertIn("high pass at 1 Hz (default)", ask("displacement", self.drive))

    def test_transfer_has_a_band_where_the_coherence_tells(self):
        words = (self.drive, self.answer, "--segment", "2 s")
        got = columns("transfer", *words)
        averages = float(ask("transfer", *words).split(" independent")[0].split()[-1])
        radius = np.sqrt((0.05 ** (-1 / (averages - 1)) - 1) * (1 / got["coherence"] - 1))
        known = radius < 1
        self.assertTrue(np.array_equal(np.isfinite(got["modulus_low"]), known) and np.any(known) and not np.all(known))
        for name, wanted in {"modulus_low": got["modulus"] * (1 - radius), "modulus_high": got["modulus"] * (1 + radius),
                             "phase_high": got["phase"] + np.degrees(np.arcsin(np.minimum(radius, 1)))}.items():
            np.testing.assert_allclose(got[name][known], wanted[known], rtol=1e-2)  # averages have four digits

    def test_rms_from_each_frequency_up(self):
        got = columns("rms", self.drive, "--band", "5 Hz..40 Hz", "--segment", "2 s")
        low, rms = got["frequency"], got["rms"]
        self.assertGreater(low.size, 20)                     # control: a single row does not make a curve
        self.assertTrue(low[0] == 5 and np.all(np.diff(low) > 0) and np.all(np.diff(rms) <= 0) and np.all(got["high"] == 40))
        f, p = signal.welch(DRIVE, RATE, "hann", 512)
        for at in (0, low.size // 2):
            self.assertLess(abs(rms[at] / np.sqrt(np.sum(p[(f >= low[at]) & (f <= 40)]) * 0.5) - 1), 0.05)

    def test_confidence(self):
        from scipy.stats import chi2
        got = columns("psd", self.drive, "--power", "--segment", "2 s", "--overlap", "0 %")
        averages = COUNT // 512
        close(self, got["psd low"][1:-1], (got["psd"] * 2 * averages / chi2.ppf(0.975, 2 * averages))[1:-1])
        close(self, got["psd high"][1:-1], (got["psd"] * 2 * averages / chi2.ppf(0.025, 2 * averages))[1:-1])


class Files(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.place.name)

    def tearDown(self):
        self.place.cleanup()

    def record(self, argument, *more):
        out = self.folder / "back.hdf5"
        ask("convert", argument, *more, "-o", out, "--quiet")
        with h5py.File(out) as f:
            (data,) = f.values()
            return data[()], dict(data.attrs)

    def test_gwpy_with_groups_float32_and_pickles(self):
        file = self.folder / "many.hdf5"
        with h5py.File(file, "w") as f:
            write_gwpy(f, "a/b/deep", DRIVE, "m", np.float32).attrs["epoch"] = np.void(b"\x80\x03cos\nsystem\n")
            write_gwpy(f, "other", ANSWER, "ct")
            f["picture"] = np.zeros((3, 3))
            f["spectrum"] = np.ones(9)
            f["spectrum"].attrs.update(x0=0.0, dx=1.0, xunit="Hz", unit="m")
        values, about = self.record(f"{file}::deep")
        np.testing.assert_array_equal(values, DRIVE.astype(np.float32))
        self.assertEqual((about["x0"], about["dx"]), (START, 1 / RATE))
        self.assertEqual((about["unit"], about["xunit"]), (b"m", b"s"))
        self.assertEqual(self.record(f"{file}::X1:other")[1]["unit"], b"ct")
        self.assertIn("a/b/deep, other", ask("convert", file, code=2))
        self.assertIn("did you mean 'other'", ask("convert", f"{file}::othr", code=2))

    def test_gwosc(self):
        file = self.folder / "H-H1_GWOSC_16KHZ_R1-1126259447-32.hdf5"
        with h5py.File(file, "w") as f:
            f["strain/Strain"] = DRIVE * 1e-21
            f["strain/Strain"].attrs.update(Npoints=COUNT, Xstart=1126259447, Xspacing=1 / RATE, Xlabel="GPS time",
                                            Xunits="second", Ylabel="Strain", Yunits="")
            f["meta/Detector"], f["meta/Duration"] = b"H1", 40
            f["quality/simple/DQmask"] = np.ones(40, np.uint32)
            f["quality/simple/DQmask"].attrs.update(Xstart=1126259447, Xspacing=1.0, Xunits="second")
        values, about = self.record(f"{file}::H1:strain", "--gps", "1126259450..1126259460")
        np.testing.assert_array_equal(values, 1e-21 * DRIVE[3 * RATE:13 * RATE])
        np.testing.assert_array_equal(self.record(file)[0], 1e-21 * DRIVE)     # masks are not channels
        self.assertEqual(about["x0"], 1126259450)
        self.assertEqual(about["unit"], b"")

    def test_text_and_csv_come_back(self):
        for ending in ("txt", "csv", "hdf5"):
            first = self.folder / f"first.{ending}"
            with h5py.File(self.folder / "in.hdf5", "w") as f:
                write_gwpy(f, "x", DRIVE, "um")
            ask("convert", self.folder / "in.hdf5", "-o", first, "--quiet")
            values, about = self.record(first)
            np.testing.assert_array_equal(values, DRIVE)
            self.assertEqual((about["x0"], 1 / about["dx"], about["unit"]), (START, RATE, b"um"))

    def test_spectra_for_gwpy(self):
        with h5py.File(self.folder / "in.hdf5", "w") as f:
            write_gwpy(f, "x", DRIVE, "m")
        out = self.folder / "asd.hdf5"
        ask("psd", self.folder / "in.hdf5", "--segment", "2 s", "-o", out)
        with h5py.File(out) as f:
            about = f["asd"].attrs
            self.assertEqual((about["unit"], about["xunit"]), (b"m / Hz(1/2)", b"Hz"))
            self.assertEqual((about["x0"], about["dx"]), (0, 0.5))

    def test_pictures_and_page(self):
        with h5py.File(self.folder / "in.hdf5", "w") as f:
            write_gwpy(f, "x", DRIVE, "m")
        for command, more in {"psd": (), "spectrogram": (), "convert": (), "q": ("--band", "8 Hz..60 Hz")}.items():
            png, page = self.folder / f"{command}.png", self.folder / f"{command}.html"
            ask(command, self.folder / "in.hdf5", *more, "-o", png, "-o", page)
            self.assertTrue(png.read_bytes().startswith(b"\x89PNG"))
            text = page.read_text()
            self.assertIn("data:image/png;base64,iVBOR", text)
            self.assertIn("</table>", text)
            self.assertNotIn("://", text)    # "http" alone occurs in pictures as text, by chance

    def test_all_files_or_none(self):
        outs = [self.folder / f"none.{ending}" for ending in ("txt", "csv", "hdf5")]
        with h5py.File(self.folder / "in.hdf5", "w") as f:
            write_gwpy(f, "x", DRIVE, "m")
        message = ask("q", self.folder / "in.hdf5", "--band", "8 Hz..60 Hz", *[x for o in outs for x in ("-o", o)], code=2)
        self.assertIn("the axis 'frequency' is not regular", message)
        self.assertEqual([o.name for o in outs if o.exists()], [])

    def rejected(self, content, *words, name="bad.txt", more=()):
        file = self.folder / name
        file.write_text(content)
        message = ask("convert", file, *more, code=2)
        for word in words:
            self.assertIn(word, message)

    def test_what_is_refused(self):
        rows = [f"{START + i / 16} {i}" for i in range(64)]
        good = "\n".join(["# time [s], x [um]", *rows])
        (self.folder / "good.txt").write_text(good)
        self.assertEqual(len(self.record(self.folder / "good.txt")[0]), 64)
        gap = ["# time [s], x [um]", *rows[:20], *rows[25:]]
        self.rejected("\n".join(gap), "bad.txt:22: error: a gap of 0.375 s", "--gps")
        jitter = [*rows[:20], f"{START + 20.4 / 16} 1", *rows[21:]]
        self.rejected("\n".join(jitter), "bad.txt:21: error: the times are not regular", more=("--unit", "um"))
        self.rejected("\n".join([*rows[:20], f"{START + 20 / 16} nan", *rows[21:]]), "bad.txt:21: error: ", "not a number", more=("--unit", "um"))
        self.rejected("\n".join([*rows[:20], f"{START + 18 / 16} 1", *rows[21:]]), "does not come after", more=("--unit", "um"))
        self.rejected("0,00 1,5\n0,25 2,5\n", "bad.txt:1:1: error: ", "decimal commas", "0.5")
        self.rejected("time;x\n0,00;1,5\n0,25;2,5\n", "bad.csv:2:1: error: ", "decimal commas", name="bad.csv")
        self.rejected("\n".join(rows), "has no unit", "--unit um/s^2")
        self.rejected("\n".join(rows), "'metre'", "did you mean 'm'", more=("--unit", "metre"))
        self.rejected("0 1\n", "one row", more=("--unit", "m"))
        self.rejected("f [Hz],x [m]\n1,2\n2,3\n", "Hz, not time", name="bad.csv")
        self.rejected("t,a [m],b [m]\n0,2,1\n1,3,2\n", "2 channels", "::a", "a, b", name="bad.csv")
        self.rejected(good, "covers GPS", "..", more=("--gps", "1..2"))
        self.rejected(good, "neither a GPS time nor UTC", more=("--gps", "soon"))

    def test_outputs_are_refused_before_work(self):
        message = ask("psd", self.folder / "missing.txt", "-o", self.folder / "x.jpg", code=2)
        self.assertIn("end it with .txt, .csv", message)
        self.assertIn("cannot read", ask("psd", self.folder / "missing.txt", code=2))


if __name__ == "__main__":
    done = unittest.main(exit=False).result
    if done.wasSuccessful():
        RECORDS.write()
    sys.exit(not done.wasSuccessful())
