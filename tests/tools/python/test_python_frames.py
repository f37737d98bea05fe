# SPDX-License-Identifier: BSD-3-Clause
"""Frames (GWF), lists of them, NDS2, segments and measured curves, read by the program: the same bits as from HDF5 of the same data."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import warnings

import gwframe
import h5py
import numpy as np
from gwpy.segments import DataQualityFlag, SegmentList
from python_arm import PROGRAM, SOURCE, arm
from scipy import signal

GPS, RATE, FRAMES, LENGTH = 1000000000, 256, 4, 8        # s, Hz; frames of so many s
RANDOM = np.random.default_rng(3)
H = RANDOM.normal(size=FRAMES * LENGTH * RATE) * 1e-21
ACC = (RANDOM.normal(size=H.size) * 1e3).astype(np.float32)
LIGOLW = f"""<?xml version='1.0' encoding='utf-8'?>
<!DOCTYPE LIGO_LW SYSTEM "http://ldas-sw.ligo.caltech.edu/doc/ligolwAPI/html/ligolw_dtd.txt">
<LIGO_LW>
  <Table Name="segment_definer:table">
    <Column Name="process_id" Type="int_8s"/><Column Name="segment_def_id" Type="int_8s"/>
    <Column Name="ifos" Type="lstring"/><Column Name="name" Type="lstring"/><Column Name="version" Type="int_4s"/>
    <Stream Name="segment_definer:table" Type="Local" Delimiter=",">
      0,0,"V1","ITF_SCIENCE",1,
      0,1,"V1","ITF_CALM",2
    </Stream>
  </Table>
  <Table Name="segment:table">
    <Column Name="segment:segment_id" Type="int_8s"/><Column Name="segment:start_time" Type="int_4s"/>
    <Column Name="segment:start_time_ns" Type="int_4s"/><Column Name="segment:end_time" Type="int_4s"/>
    <Column Name="segment:end_time_ns" Type="int_4s"/><Column Name="segment:segment_def_id" Type="int_8s"/>
    <Stream Name="segment:table" Type="Local" Delimiter=",">
      0,{GPS},0,{GPS + 10},0,0,
      1,{GPS + 20},0,{GPS + 32},0,0,
      2,{GPS + 1},500000000,{GPS + 2},0,1
    </Stream>
  </Table>
</LIGO_LW>
"""
ENVIRONMENT = {**os.environ, "STRAYTRACE_PYTHON": sys.executable, "STRAYTRACE_PYTHONPATH": str(SOURCE / "python")}

WITHOUT_PYTHON = {**os.environ, "STRAYTRACE_PYTHON": "/bin/false"}


def run(*words, code=0, env=ENVIRONMENT):
    done = subprocess.run([PROGRAM, *map(str, words)], text=True, capture_output=True, env=env, timeout=60)
    assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if code == 0 else done.stderr


class Frames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.place.name)
        with h5py.File(cls.folder / "same.hdf5", "w") as file:
            for name, data, unit in (("V1:h", H, "strain"), ("V1:acc", ACC, "um / s2")):
                file.create_dataset(name, data=data).attrs.update(x0=GPS, dx=1 / RATE, xunit="s", unit=unit, name=name)
        paths = [cls.folder / f"V-R-{GPS + k * LENGTH}-{LENGTH}.gwf" for k in range(FRAMES)]
        for k, path in enumerate(paths):
            part = slice(k * LENGTH * RATE, (k + 1) * LENGTH * RATE)
            frame = gwframe.Frame(start=float(GPS + k * LENGTH), duration=LENGTH, name="V1", run=1)
            frame.add_channel("V1:h", H[part], sample_rate=RATE, unit="strain")
            frame.add_channel("V1:acc", ACC[part], sample_rate=RATE, unit="um/s^2")
            bad = np.ma.array(ACC[part], mask=np.zeros(LENGTH * RATE, bool))
            if k == 2:
                bad[RATE: 2 * RATE] = np.ma.masked
            frame.add_channel("V1:bad", bad, sample_rate=RATE, unit="um/s^2", channel_type="adc", aux_mask=True)
            frame.write(str(path))
        lines = [f"{p} {GPS + k * LENGTH} {LENGTH} 0 0\n" for k, p in enumerate(paths)]
        cls.write("all.ffl", "".join(lines))
        cls.write("gap.ffl", lines[0] + lines[1] + lines[3])
        (cls.folder / "copy.gwf").write_bytes(paths[0].read_bytes())
        cls.write("twice.ffl", lines[0] + f"copy.gwf {GPS} {LENGTH} 0 0\n")
        cls.write("gone.ffl", lines[0].replace("V-R", "V-Q"))
        cls.write("all.lcf", "".join(f"V R {GPS + k * LENGTH} {LENGTH} file://localhost{p}\n" for k, p in enumerate(paths)))
        cls.write("flag.txt", f"# start end\n{GPS} {GPS + 10}\n{GPS + 20} {GPS + 32}\n")
        cls.one = paths[0]

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    @classmethod
    def write(cls, name, text):
        (cls.folder / name).write_text(text)

    def converted(self, source, channel="V1:h", span=""):
        out = self.folder / "out.csv"
        run("signal", "convert", f"{source}::{channel}", *(["--gps", span] if span else []), "-o", out, "--quiet")
        return [line for line in out.read_text().split("\n") if "." in line and "::" not in line]

    def test_the_same_bits(self):
        span, later = f"{GPS + 5}..{GPS + 19}", f"{GPS + 6}..{GPS + 20}"
        for channel in ("V1:h", "V1:acc"):
            same = self.converted(self.folder / "same.hdf5", channel, span)
            self.assertGreater(len(same), 14 * RATE)
            for source in ("all.ffl", "all.lcf"):
                self.assertEqual(self.converted(self.folder / source, channel, span), same)
            self.assertNotEqual(self.converted(self.folder / "all.ffl", channel, later), same, "control: a second later")
        self.assertEqual(self.converted(self.one), self.converted(self.folder / "same.hdf5", "V1:h", f"{GPS}..{GPS + LENGTH}"))

    def refused(self, *words, env=ENVIRONMENT):
        return run("signal", "psd", *words, code=2, env=env)

    def test_errors_have_a_remedy(self):
        gap = self.refused(f"{self.folder}/gap.ffl::V1:h")
        self.assertIn(f"no frame from GPS {GPS + 16} to {GPS + 24}", gap)
        self.assertIn(f"{GPS}..{GPS + 16}", gap)
        self.assertIn("two frames hold", self.refused(f"{self.folder}/twice.ffl::V1:h"))
        self.assertIn("there is no frame file", self.refused(f"{self.folder}/gone.ffl::V1:h"))
        self.assertIn("there are V1:acc, V1:bad, V1:h", self.refused(f"{self.one}::V1:q"))
        self.assertIn("cover GPS", self.refused(f"{self.folder}/all.ffl::V1:h", "--gps", "5..9"))
        self.assertIn("not a number", self.refused(f"{self.folder}/all.ffl::V1:bad"))
        self.write("broken.gwf", "IGWD and nothing else")
        self.assertIn("cannot be read as frames", self.refused(f"{self.folder}/broken.gwf::V1:h"))
        self.write("frames", "IGWD")
        self.assertIn("without the ending .gwf", self.refused(f"{self.folder}/frames::V1:h"))

    def test_without_the_packages(self):
        empty = self.folder / "empty"
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", empty], check=True)
        told = self.refused(f"{self.one}::V1:h", env={**ENVIRONMENT, "STRAYTRACE_PYTHON": str(empty / "bin/python")})
        self.assertIn("pip install", told)
        self.assertIn("gwframe", told)

    def psd(self, source, *words):
        sheet = json.loads(run("signal", "psd", source, "--segment", "1 s", "--power", "--format", "json", "--quiet", *words))
        return np.array(sheet["y"][0]["values"]), sheet["notes"]

    def test_averages_over_segments(self):
        parts = [H[: 10 * RATE], H[20 * RATE:]]
        every = [signal.welch(p, RATE, "hann", RATE)[1] * n for p, n in zip(parts, (19, 23))]
        expected = sum(every) / (19 + 23)
        for source in ("same.hdf5", "all.ffl"):
            found, notes = self.psd(f"{self.folder}/{source}::V1:h", "--segments", self.folder / "flag.txt")
            np.testing.assert_allclose(found, expected, rtol=1e-10)
            self.assertTrue(any("22 s of 32 s are active" in n for n in notes), notes)
        self.assertGreater(np.max(np.abs(self.psd(f"{self.folder}/same.hdf5::V1:h")[0] / expected - 1)), 0.05, "control: all data")

    def test_gaps_outside_the_flag(self):
        told = self.refused(f"{self.folder}/gap.ffl::V1:h", "--segments", self.folder / "flag.txt")
        self.assertIn(f"no valid sample at GPS {GPS + 20}", told)           # a gap where the flag is active
        self.write("early.txt", f"{GPS} {GPS + 12}\n{GPS + 25} {GPS + 32}\n")
        gap = self.psd(f"{self.folder}/gap.ffl::V1:h", "--segments", self.folder / "early.txt")[0]
        np.testing.assert_array_equal(gap, self.psd(f"{self.folder}/same.hdf5::V1:h", "--segments", self.folder / "early.txt")[0])
        bad = f"{self.folder}/all.ffl::V1:bad"
        self.write("all.txt", f"{GPS} {GPS + 32}\n")
        self.assertIn("no valid sample at GPS 1000000017", self.refused(bad, "--segments", self.folder / "all.txt"))
        self.psd(bad, "--segments", self.folder / "early.txt")

    def test_formats_of_segments(self):
        active = SegmentList([(GPS, GPS + 10), (GPS + 20, GPS + 32)])
        flag = DataQualityFlag("V1:ITF_SCIENCE:1", active=active, known=[(GPS, GPS + 32)])
        expected = self.psd(f"{self.folder}/same.hdf5::V1:h", "--segments", self.folder / "flag.txt")[0]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            flag.write(str(self.folder / "flags.json"))
            flag.write(str(self.folder / "flags.hdf5"), path=flag.name)
        self.write("flags.xml", LIGOLW)
        for file in ("flags.json", "flags.hdf5::V1:ITF_SCIENCE:1", "flags.xml::V1:ITF_SCIENCE"):
            found = self.psd(f"{self.folder}/same.hdf5::V1:h", "--segments", f"{self.folder}/{file}")[0]
            np.testing.assert_array_equal(found, expected, file)
        told = self.refused(f"{self.folder}/same.hdf5::V1:h", "--segments", self.folder / "flags.xml")
        self.assertIn("there are V1:ITF_CALM:2, V1:ITF_SCIENCE:1", told)
        self.write("wizard.txt", f"0 {GPS} {GPS + 10} 10\n1 {GPS + 20} {GPS + 32} 12\n")
        np.testing.assert_array_equal(self.psd(f"{self.folder}/same.hdf5::V1:h", "--segments", self.folder / "wizard.txt")[0], expected)
        self.write("wizard.txt", f"0 {GPS} {GPS + 10} 11\n")
        self.assertIn("does not last 11 s", self.refused(f"{self.folder}/same.hdf5::V1:h", "--segments", self.folder / "wizard.txt"))

    def test_one_stretch_for_other_commands(self):
        words = ["signal", "whiten", f"{self.folder}/same.hdf5::V1:h", "--segments", self.folder / "flag.txt", "--quiet"]
        told = run(*words, code=2)
        self.assertIn("2 stretches", told)
        self.assertIn(f"{GPS + 20}..{GPS + 32}", told)
        self.assertIn("12 s from GPS 1000000020", run(*words, "--gps", f"{GPS + 11}..{GPS + 32}"))

    def test_couple(self):
        def coupling(source):
            return run("couple", "noise", "--witness", f"{source}::V1:acc", "--target", f"{source}::V1:h", "--injection", f"{GPS + 16}..{GPS + 32}",
                       "--quiet", f"{GPS}..{GPS + 16}", "--segment", "1 s", "--silent", "--show", "3")
        self.assertEqual(coupling(self.folder / "all.ffl"), coupling(self.folder / "same.hdf5"))

    def test_nds2_gets_its_arguments(self):
        """No server: a module in the place of gwpy records the call."""
        fake = self.folder / "fake"
        (fake / "gwpy").mkdir(parents=True)
        (fake / "nds2.py").write_text("")
        (fake / "gwpy/__init__.py").write_text("")
        (fake / "gwpy/timeseries.py").write_text(
            "import numpy, types\n"
            "class TimeSeries:\n"
            "  def fetch(*words, **options):\n"
            f"    open({str(self.folder / 'call.txt')!r}, 'w').write(repr((words, options)))\n"
            "    v = lambda x: types.SimpleNamespace(value=x)\n"
            f"    return types.SimpleNamespace(t0=v({GPS}.0), sample_rate=v(16.0), value=numpy.arange(128.0), unit='m')\n")
        env = {**ENVIRONMENT, "PYTHONPATH": str(fake)}
        source = "nds2://nds.example.org:31201::V1:h"
        run("signal", "psd", source, "--gps", f"{GPS + 1}..{GPS + 5}", "--segment", "1 s", env=env)
        self.assertEqual((self.folder / "call.txt").read_text(),
                         f"(('V1:h', {GPS + 1}.0, {GPS + 5}.0), {{'host': 'nds.example.org', 'port': 31201, 'verbose': False}})")
        self.assertIn("both ends", self.refused(source, env=env))
        self.assertIn("many channels", self.refused("nds2://nds.example.org", "--gps", "1..5", env=env))
        self.assertIn("conda install", self.refused(source, "--gps", "1..5"))


class InARun(unittest.TestCase):
    """Motion from frames, and a measured strain over the report: one traced run for all."""

    @classmethod
    def setUpClass(cls):
        Frames.setUpClass()
        cls.folder = Frames.folder
        arm(trace={"seed": 1, "histories": 4096}).save(cls.folder / "arm.yaml")
        run("trace", cls.folder / "arm.yaml", "-o", cls.folder / "traced.h5", "--quiet")

    @classmethod
    def tearDownClass(cls):
        Frames.tearDownClass()

    def noise(self, source, out, env=ENVIRONMENT, **keys):
        words = ", ".join(f"{k}: {v}" for k, v in {"channel": "V1:acc", "highpass": "2 Hz", **keys}.items())
        motion = self.folder / "motion.yaml"
        motion.write_text("straytrace: 1\nbodies:\n  mirrors: {motion: still}\n"
                          f"  tube: {{motion: {{z: {{series: '{source}', {words}}}, others: still}}}}\n"
                          "noise: {band: [5 Hz, 100 Hz]}\n")
        files = ["-o", self.folder / out] if out else []
        return run("noise", self.folder / "traced.h5", "--motion", motion, "--show", 1, "--quiet", *files, env=env)

    def test_motion(self):
        span = {"span": f"{GPS + 4}..{GPS + 28}"}
        same = self.noise("same.hdf5", "", **span)
        self.assertEqual(self.noise("all.ffl", "", **span), same)
        self.assertNotEqual(self.noise("all.ffl", "", span=f"{GPS + 8}..{GPS + 32}"), same, "control: another stretch")
        part = self.noise("same.hdf5", "", span=f"{GPS + 20}..{GPS + 32}")
        self.assertEqual(self.noise("all.ffl", "kept", segments="flag.txt", span=f"{GPS + 11}..{GPS + 32}").split("\n")[-2], part.split("\n")[-2])
        again = run("noise", self.folder / "kept/run.h5", "--quiet", env=WITHOUT_PYTHON)
        self.assertIn(part.split("\n")[-2], again)                # the run holds the samples: no frames are read

    def test_measured(self):
        self.noise("same.hdf5", "m", env=WITHOUT_PYTHON)
        page = self.folder / "page.html"
        run("report", self.folder / "m/run.h5", "-o", page, "--measured", f"{self.folder}/all.ffl::V1:h", "--segment", "1 s", "--pictures", "budget", "--quiet")
        text = page.read_text()
        measured = json.loads(text[text.index('"measured":[') + len('"measured":'):].split('}]', 1)[0] + "}]")[0]
        f, p = signal.welch(H, RATE, "hann", RATE, average="median")
        np.testing.assert_allclose(measured["asd"][:20], np.sqrt(p[5:25]), rtol=1e-5)
        self.assertGreater(np.max(np.abs(np.array(measured["asd"][:20]) / np.sqrt(signal.welch(H, RATE, "hann", RATE)[1][5:25]) - 1)), 1e-3,
                           "control: the mean")
        self.assertTrue(all(low < asd < high for low, asd, high in zip(measured["low"], measured["asd"], measured["high"])))
        self.assertIn("all.ffl::V1:h", measured["source"])
        acc = run("report", self.folder / "m/run.h5", "-o", page, "--measured", f"{self.folder}/all.ffl::V1:acc", code=2)
        self.assertIn("not strain", acc)
        (self.folder / "curve.txt").write_text("".join(f"{f} 1e-23\n" for f in range(1, 200)))
        run("report", self.folder / "m/run.h5", "-o", self.folder / "over.svg", "--measured", self.folder / "curve.txt", "--quiet")
        self.assertIn("curve.txt, without errors", (self.folder / "over.svg").read_text().replace("\n", " "))


if __name__ == "__main__":
    unittest.main()
