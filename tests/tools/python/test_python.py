# SPDX-License-Identifier: BSD-3-Clause
"""The Python package: models, runs and what goes wrong. Needs what scripts/setup --test installs."""
import concurrent.futures
import json
import multiprocessing
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
import warnings

from python_arm import BLOCK, PROGRAM, SOURCE, arm

import h5py
import numpy as np

import straytrace

CHANGING = {"timing"}    # and the attribute `created`


def content(path):
    """Every dataset and attribute of a run file but the times."""
    found = {}
    with h5py.File(path, "r") as file:
        def visit(name, item):
            if name.split("/")[0] in CHANGING:
                return
            if isinstance(item, h5py.Dataset):
                found[name] = np.asarray(item[()]).tobytes()
            found.update({f"{name}:{key}": np.asarray(value).tobytes() for key, value in item.attrs.items()})
        file.visititems(visit)
        found.update({f":{k}": np.asarray(v).tobytes() for k, v in file.attrs.items() if k != "created"})
    return found


class Trees(unittest.TestCase):
    def test_save_and_load_are_a_round_trip(self):
        model = arm()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "arm.yaml")
            model.save(path)
            again = straytrace.Model.load(path)
            self.assertEqual(again.text(), path.read_text())
            self.assertEqual(again.text(), model.text())
        self.assertEqual(again.scene["baffle"].shape.cone.inner_radius, "rim")

    def test_what_is_included_can_be_changed_and_is_run(self):
        whole = arm()
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            parts = {"straytrace": 1, "scene": [whole.scene["baffle"]]}
            straytrace.Model(parts).save(place / "baffle.yaml")
            rest = {key: value for key, value in whole.items() if key != "scene"}
            rest["scene"] = [entry for entry in whole.scene if entry.name != "baffle"]
            model = straytrace.Model({"include": ["baffle.yaml"], **rest}, folder=folder)
            before = model.check().model_hash
            cone = model.included["baffle.yaml"].scene["baffle"].shape.cone
            cone.half_angle = "36 deg"
            self.assertNotEqual(model.check().model_hash, before)
            changed = straytrace.Model.from_text(model.resolved())      # one text, without files
            self.assertIn("half_angle: 0.628", changed.text())
            run, alike = (m.run(histories=BLOCK, progress=False) for m in (model, changed))
            self.assertEqual(dict(zip(run.routes.name, run.routes.coupling)), dict(zip(alike.routes.name, alike.routes.coupling)))
            scan = straytrace.scan(model, [{}], histories=BLOCK, progress=False)
            self.assertEqual(scan.points[0].run.attributes["model_hash"], model.check().model_hash)
            self.assertNotIn("36 deg", (place / "baffle.yaml").read_text())
            model.included["baffle.yaml"].save(place / "baffle.yaml")
            self.assertIn("36 deg", (place / "baffle.yaml").read_text())

    def test_examples_keep_text_and_comments(self):
        from straytrace.tree import dump, load
        for path in sorted((SOURCE / "examples").glob("*.yaml")):
            model, text = straytrace.Model.load(path), path.read_text()
            self.assertEqual(model.text(), text, path)
            self.assertEqual(load(dump(model.data)), load(text), path)
            comments = [line.strip() for line in text.splitlines() if line.strip().startswith("#")]
            self.assertEqual([c for c in comments if c not in dump(model.data)], [], path)

    def test_changes_by_key_attribute_and_name(self):
        model = arm()
        model.params.rim = straytrace.quantity(np.float64(50), "cm")
        model["title"] = "changed"
        model.scene.append({"name": "b2", "at": np.array([1.0, 2.0, 3.0])})
        del model.scene["baffle"]
        text = model.text()
        self.assertIn("rim: 50.0 cm", text)
        self.assertIn("at: [1.0, 2.0, 3.0]", text)
        self.assertNotIn("name: baffle", text)

    def test_wrong_types_are_told_with_a_hint(self):
        model = arm()
        for value, words in ((None, "leave the key out"), ({1}, "a list or a dict"), (1j, "complex"), ({3: 1}, "write '3'")):
            with self.assertRaisesRegex(TypeError, words):
                model.params = value
        with self.assertRaisesRegex(ValueError, "nan"):
            model.params.L = float("nan")
        with self.assertRaisesRegex(AttributeError, "did you mean 'scene'"):
            model.sceen
        with self.assertRaisesRegex(KeyError, "did you mean 'baffle'"):
            model.scene["bafle"]
        with self.assertRaisesRegex(TypeError, "1e6"):
            model.run(histories="many")
        with self.assertRaisesRegex(TypeError, "h_total"):
            model.run(until=5)
        with self.assertRaisesRegex(TypeError, "60 cm"):
            model.check(params={"rim": ["50 cm"]})
        with self.assertRaisesRegex(TypeError, "Model.load"):
            straytrace.Model("arm.yaml")


class Errors(unittest.TestCase):
    def test_input_errors_are_those_of_the_command_line(self):
        model = arm()
        model.scene["baffle"].shape.cone.half_angle = "35 m"
        model.scene["ITM"].materiel = "hr"
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(straytrace.InputError) as caught:
            path = pathlib.Path(folder, "model.yaml")
            path.write_text(model.text())
            said = subprocess.run([PROGRAM, "check", path], capture_output=True, text=True)
            self.assertEqual(said.returncode, 2)
            model.check()
        self.assertEqual(str(caught.exception), said.stderr.rstrip("\n"))
        lines = model.text().splitlines()
        problems = caught.exception.problems
        self.assertEqual(len(problems), 2)
        for problem in problems:
            self.assertEqual(problem.file, "model.yaml")
            marked = lines[problem.line - 1][problem.column - 1:problem.column - 1 + problem.width]
            self.assertIn(marked, ("35 m", "materiel"))
        self.assertIn("did you mean 'material'?", [p.suggestion for p in problems])

    def test_no_file_no_yaml(self):
        with self.assertRaisesRegex(straytrace.InputError, "there is no such file"):
            straytrace.check("/nowhere/arm.yaml")
        with self.assertRaises(straytrace.InputError) as caught:
            straytrace.Model.from_text("a: [1\nb: {", "broken.yaml")
        self.assertEqual(caught.exception.problems[0].file, "broken.yaml")

    def test_what_stands_before_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            text, scene = pathlib.Path(folder, "a=b.yaml"), pathlib.Path(folder, "no=such.yaml")
            arm().save(text)
            text.rename(pathlib.Path(folder, "text"))
            said = subprocess.run([PROGRAM, "--unsaved", f"{scene}={folder}/text", "check", scene], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
            self.assertNotIn("text", said.stdout)
        for words, told in ((["--unsaved", "scene.yaml", "check", "scene.yaml"], "write --unsaved SCENE=FILE"),
                            (["--unsaved", "scene.yaml=/none", "check", "scene.yaml"], "/none")):
            said = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
            self.assertEqual(said.returncode, 2)
            self.assertIn(told, said.stderr)
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(RuntimeError, "signal SIGKILL"):
            script = pathlib.Path(folder, "program")
            script.write_text("#!/bin/sh\nkill -9 $$\n")
            script.chmod(0o755)
            with unittest.mock.patch.dict(os.environ, STRAYTRACE_PROGRAM=str(script)):
                arm().check()

    def test_missing_program_is_an_input_error(self):
        with tempfile.TemporaryDirectory() as folder:
            bare = pathlib.Path(folder, "program")
            bare.write_text("#!/bin/sh\n")                       # not executable
            for place in (bare, pathlib.Path(folder, "none")):
                with unittest.mock.patch.dict(os.environ, STRAYTRACE_PROGRAM=str(place)), \
                        self.assertRaisesRegex(straytrace.InputError, f"STRAYTRACE_PROGRAM names '{place}'"):
                    arm().check()

    def test_check_tells_numbers_and_warnings(self):
        model = arm(bodies={"mirrors": {"motion": "still"}, "tube": {"motion": "still"}})
        found = model.check()
        self.assertEqual((found.ports, found.bodies), (2, 2))
        told = [w for w in found.warnings if "no body moves" in w.message]
        self.assertEqual([w.severity for w in told], ["warning"])
        self.assertTrue(told[0].line > 0 and told[0].suggestion, told)
        self.assertEqual(arm(noise={"band": ["5 Hz", "1 kHz"]}).check().warnings, ())
        self.assertIn("another one", arm().check().warnings[0].message)   # no signal recycling, and the curve of adv
        self.assertNotEqual(found.model_hash, arm().check(params={"rim": "50 cm"}).model_hash)


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.place = pathlib.Path(cls.folder.name)
        cls.model = arm()
        cls.run_ = cls.model.run(progress=False, threads=2)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_bits_of_the_command_line(self):
        self.model.save(self.place / "model.yaml")
        subprocess.run([PROGRAM, "run", "model.yaml", "-o", "cli.h5", "--quiet", "--threads", "1"], check=True,
                       cwd=self.place, stdout=subprocess.DEVNULL)
        ours, theirs = content(self.run_.path), content(self.place / "cli.h5")
        self.assertGreater(len(ours), 150)
        self.assertEqual({k for k in ours.keys() | theirs.keys() if ours.get(k) != theirs.get(k)}, set())
        other = content(self.model.run(histories=BLOCK, progress=False).path)      # control: less light is seen
        self.assertIn("classes/mean", {k for k in ours if ours[k] != other.get(k)})

    def test_new_motion_is_that_of_the_command_line(self):
        line = {"line": {"at": "0.3 Hz", "width": "0.05 Hz", "rms": "3 um rms"}}
        motion = {"bodies": {"mirrors": {"motion": "still"}, "tube": {"motion": {"z": line, "others": "still"}}}}
        new = self.run_.noise(motion=motion)
        path = self.place / "motion.yaml"
        straytrace.Model(motion).save(path)
        subprocess.run([PROGRAM, "noise", self.run_.path, "--motion", path, "-o", self.place / "moved.h5", "--quiet"],
                       check=True, stdout=subprocess.DEVNULL)
        np.testing.assert_array_equal(new.total.mean, straytrace.open(self.place / "moved.h5").noise.total.mean)
        self.assertGreater(np.nanmax(abs(new.total.mean / self.run_.noise.total.mean - 1)), 0.1)
        traced = self.model.trace(histories=BLOCK, progress=False)
        self.assertIsNone(traced.noise)
        self.assertEqual(len(traced.project(motion).noise.routes), len(traced.routes.name))

    def test_a_run_goes_on_where_it_stopped(self):
        first = self.model.run(self.place / "on.h5", histories=BLOCK, progress=False)
        second = self.model.run(self.place / "on.h5", histories=2 * BLOCK, progress=False)
        whole = self.model.run(histories=2 * BLOCK, progress=False)
        self.assertEqual((first.histories, second.histories), (BLOCK, 2 * BLOCK))
        np.testing.assert_array_equal(second.routes.coupling, whole.routes.coupling)
        with self.assertRaisesRegex(straytrace.InputError, "--force"):
            self.model.run(self.place / "on.h5", seed=7, progress=False)

    def test_interrupted_gives_a_valid_part(self):
        heard = []

        def listen(progress):
            if not heard:
                threading.Thread(target=lambda: (time.sleep(0.1), os.kill(os.getpid(), signal.SIGINT))).start()
            heard.append(progress)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            part = self.model.run(histories=1e9, progress=listen)
        self.assertFalse(part.complete)
        self.assertTrue(0 < part.histories < 1e9)
        self.assertTrue(any("stopped early" in str(w.message) for w in told))
        self.assertEqual(straytrace.open(part.path).histories, part.histories)
        self.assertTrue(all(p.wanted_histories >= 1e9 for p in heard))

    def test_damaged_newer_and_other_files_are_refused(self):
        whole = self.run_.path.read_bytes()
        bad = self.place / "bad.h5"
        bad.write_bytes(whole[:-1000])
        self.rejected(bad, "damaged: it contains")
        bad.write_bytes(whole[:-1000] + bytes([whole[-1000] ^ 1]) + whole[-999:])
        self.rejected(bad, "does not match its checksum")
        bad.write_bytes(b"no run at all")
        self.rejected(bad, "cannot read")
        bad.write_bytes(whole[512:])
        with h5py.File(bad, "r+") as file:
            file.attrs["schema"] = [3, 0]
        self.rejected(bad, "has format 3.0")
        self.rejected(self.place / "none.h5", "cannot read")

    def rejected(self, path, words):
        with self.assertRaisesRegex(straytrace.RunError, words):
            straytrace.open(path)

    def test_an_optimisation(self):
        """A steep cost under a limit; the command gives the same numbers."""
        words = {"minimise": "1 m / rim", "vary": {"rim": "45cm..49cm"}, "histories": BLOCK, "most": 4}
        with tempfile.TemporaryDirectory() as folder:
            found = straytrace.optimise(self.model, subject=["rim < 48 cm", "h_total < 1e9 x line"], out=folder, **words)
            told = json.loads(pathlib.Path(folder, "optimise.json").read_text())
            self.assertEqual(len(found.table()), len(told["candidates"]))
            self.assertLess(float(found.best.settings["rim"].split()[0]), 0.48)
            self.assertEqual(found.best.ratio, told["finalists"][told["best"]]["limits"][0]["ratio"]["value"])
            self.assertTrue(found.best.met and found.complete and found.run.histories == found.best.histories > BLOCK)
            self.assertIn("binds", found.text)
            # The cost is 1/rim and the largest rim is the limit: d cost/d ln limit = -cost (eq. O.9).
            self.assertAlmostEqual(found.prices_of_limits["rim < 48 cm"] / found.best.objective, -1, delta=0.1)
            self.assertEqual(found.prices_of_limits["h_total < 1e9 x line"], 0)
            self.assertEqual(found.sigmas_of_prices["rim < 48 cm"], 0)                     # a relation is known without a trace
        none = straytrace.optimise(self.model, subject=["h_total < 1e-9 x line"], **words)
        self.assertTrue(none.best is None and none.run is None and not any(c.met for c in none.candidates))
        with self.assertRaisesRegex(straytrace.InputError, "did you mean 'rim'"):
            straytrace.optimise(self.model, **{**words, "vary": {"rmi": "1cm..2cm"}})

    def test_a_scan_is_the_same_on_every_executor(self):
        params = {"rim": ["49 cm", "50 cm"]}
        options = {"histories": BLOCK, "threads": 1, "progress": False}
        alone = straytrace.scan(self.model, params, **options)
        alone_in_process = multiprocessing.get_context("spawn")     # a copy of a process with threads may lock up (Python 3.12)
        with (concurrent.futures.ThreadPoolExecutor(2) as threads,
              concurrent.futures.ProcessPoolExecutor(1, mp_context=alone_in_process) as processes):
            for executor, values in ((threads, ["49 cm", "50 cm"]), (processes, ["49 cm"])):
                other = straytrace.scan(self.model, {"rim": values}, executor=executor, **options)
                self.assertEqual([p.params["rim"] for p in other.points], values)
                for a, b in zip(alone.points, other.points):
                    np.testing.assert_array_equal(a.run.routes.coupling, b.run.routes.coupling)
            with self.assertRaisesRegex(straytrace.InputError, "rimm") as caught:
                straytrace.scan(self.model, {"rimm": ["1 m"]}, executor=processes, **options)
        self.assertFalse(np.array_equal(alone.points[0].run.routes.coupling, alone.points[1].run.routes.coupling))
        self.assertEqual(list(alone.table()["rim"]), params["rim"])
        few = straytrace.scan(self.model, params, **{**options, "histories": 128})   # 16 blocks of 8 resolve nothing
        self.assertTrue((few.table()["bound"] == "lower").all())
        self.assertTrue((alone.table()["bound"] == "").all())
        self.assertEqual(len(caught.exception.problems), 1)
        with self.assertRaisesRegex(TypeError, "list of them"):
            straytrace.scan(self.model, {"rim": "49 cm"})


class Decisions(unittest.TestCase):
    def test_sensitivity_is_the_slope_of_other_inputs(self):
        run = arm().run(histories=BLOCK, progress=False)
        found = run.sensitivity(only=["strength"])
        self.assertEqual(found.frequency.size, run.noise.frequency.size)
        steel = next(s for s in found.inputs if s.name == "material steel")
        plain, twice = (run.with_inputs(*settings)["total_strain"][0]["value"] for settings in ((), ("steel=x1.01",)))
        e = steel.elasticity[int(np.argmin(np.abs(np.log(found.frequency / 10))))]
        self.assertAlmostEqual(np.log(twice / plain) / np.log(1.01), e, delta=2e-3)
        self.assertGreater(abs(e), 0.3)
        self.assertEqual(list(found.table()["class"].unique()), ["strength"])
        self.assertFalse(found.sampled.any())                                      # no input states an uncertainty
        self.assertTrue(np.isnan(steel.narrowing).all())
        with self.assertRaisesRegex(straytrace.InputError, "there is no material or value 'stel'"):
            run.with_inputs("stel=x2")


if __name__ == "__main__":
    sys.exit(unittest.main())
