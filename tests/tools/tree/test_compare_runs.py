#!/usr/bin/env python3
"""tools/compare_runs.py finds equal runs equal and sees every kind of difference. Usage: test_compare_runs.py PROGRAM"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

import h5py  # noqa: E402
import numpy as np  # noqa: E402

import compare_runs  # noqa: E402

PROGRAM = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else ROOT / "build/straytrace").resolve()
SCENE = ROOT / "examples/arm_tube.yaml"


class Files(unittest.TestCase):
    """Two files that are alike but for one thing."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def written(self, name, change=lambda file: None):
        path = pathlib.Path(self.folder.name, name)
        with h5py.File(path, "w") as file:
            file.attrs.update(created=name, version=name, seed=1)
            file["classes/mean"] = np.array([0.0, 1.5, np.nan])
            file["classes/mean"].attrs["unit"] = "1"
            file["names/ports"] = np.array([b"ITM", b"ETM"], dtype=h5py.string_dtype())
            file["timing/seconds"] = 1.0 if name == "old" else 2.0
            change(file)
        return compare_runs.contents(path)

    def differences(self, change):
        return list(compare_runs.differences(self.written("old"), self.written("new", change)))

    def test_equal_but_for_the_build(self):
        self.assertEqual(self.differences(lambda file: None), [])     # other times, NaN equal to itself

    def test_attributes_that_old_programs_do_not_write(self):
        def described(name):
            return lambda file: file["names/ports"].attrs.create(name, "port of the interferometer")
        self.assertEqual(self.differences(described("meaning")), [])
        self.assertEqual(len(self.differences(described("unit"))), 1)     # negative control

    def test_reworded_descriptions(self):
        def described(attribute, text):
            def change(file):
                file["names/ports"].attrs[attribute] = text
            return change
        old = self.written("old", described("meaning", "port"))
        self.assertEqual(list(compare_runs.differences(old, self.written("new", described("meaning", "reworded")))), [])
        old = self.written("old", described("unit", "m"))     # negative control
        self.assertEqual(len(list(compare_runs.differences(old, self.written("new", described("unit", "s"))))), 1)

    def test_groups_that_old_programs_do_not_write(self):
        def added(name):
            def change(file):
                file[f"{name}/notes"] = 1.0
                file[name].attrs["meaning"] = "new"
            return change
        self.assertEqual(self.differences(added("projection")), [])
        self.assertEqual(self.differences(lambda file: file.create_dataset("records/member", data=1)), [])
        self.assertEqual(len(self.differences(added("other"))), 2)     # negative control
        old, new = self.written("old", added("projection")), self.written("new")
        self.assertEqual(len(list(compare_runs.differences(old, new))), 2)     # a lost group is a difference

    def test_one_bit_differs(self):
        def change(file):
            file["classes/mean"][1] = np.nextafter(1.5, 2)
        self.assertEqual(self.differences(change), ["classes/mean differs"])

    def test_sign_of_zero_type_and_shape_differ(self):
        for values in (np.array([-0.0, 1.5, np.nan]), np.array([0.0, 1.5, np.nan]).view(np.int64),
                       np.array([[0.0, 1.5, np.nan]])):
            def change(file, values=values):
                del file["classes/mean"]
                file["classes/mean"] = values
                file["classes/mean"].attrs["unit"] = "1"
            self.assertEqual(self.differences(change), ["classes/mean differs"], values)

    def test_text_and_attributes_differ(self):
        def change(file):
            file["names/ports"][0] = b"IMT"
            file["classes/mean"].attrs["unit"] = "m"
            file.attrs["seed"] = 2
        self.assertEqual(self.differences(change), ["@seed differs", "classes/mean@unit differs", "names/ports differs"])

    def test_missing_and_additional_datasets(self):
        def change(file):
            del file["names/ports"]
            file["classes/share"] = 1.0
        self.assertEqual(self.differences(change), ["classes/share is only in the new file", "names/ports is only in the old file"])


class Programs(unittest.TestCase):
    """The command with programs that do what they should, or not."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def program(self, lines):
        path = pathlib.Path(self.folder.name, "changed")
        path.write_text(f"#!/bin/sh\n{lines}\n")
        path.chmod(0o755)
        return path

    def compared(self, old, new, scene=SCENE):
        done = subprocess.run([sys.executable, ROOT / "tools/compare_runs.py", old, new, scene, "--histories", "4096"],
                              capture_output=True, text=True)
        return done.returncode, done.stdout

    def test_same_program(self):
        self.assertEqual(self.compared(PROGRAM, PROGRAM), (0, "arm_tube.yaml: equal\nscenes: 1, different: 0\n"))

    def test_other_seed(self):
        status, said = self.compared(PROGRAM, self.program(f"exec {PROGRAM} \"$@\" --seed 2"))
        self.assertEqual(status, 1, said)
        self.assertIn("@seed differs", said)
        self.assertRegex(said, "absorbed/mean differs; .*; and [0-9]+ more")
        self.assertIn("scenes: 1, different: 1", said)

    def test_failing_program(self):
        status, said = self.compared(PROGRAM, self.program("echo 'no such key' >&2; exit 2"))
        self.assertEqual((status, "no run file from the new program: no such key" in said), (1, True), said)

    def test_rejected_scene(self):
        scene = pathlib.Path(self.folder.name, "bad.yaml")
        scene.write_text("straytrace: 1\nsceen: []\n")
        self.assertEqual(self.compared(PROGRAM, PROGRAM, scene)[0], 0)
        for other in ("echo 'another message' >&2; exit 2", f"{PROGRAM} \"$@\"; exit 3"):
            status, said = self.compared(PROGRAM, self.program(other), scene)
            self.assertEqual((status, "exit codes or messages differ" in said), (1, True), said)


if __name__ == "__main__":
    unittest.main()
