#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""`straytrace submit --backend slurm` with a Slurm that runs: an array of four slices, one of which is stopped and put back into
the queue, becomes the bits of one run, its noise and its report. Usage: test_slurm.py PROGRAM"""
import pathlib
import tempfile
import unittest

from cluster_support import BLOCK, SCENE, ask, attributes, bits, trace
from slurm_cluster import Slurm

MANY = str(60 * BLOCK)


class Submitted(unittest.TestCase):
    def test_an_array_becomes_one_run(self):
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place) / "user's $(jobs) & more"           # no name may reach a shell
            command = ask("submit", *SCENE, "--backend", "slurm", "--jobs", "4", "-o", folder, "--histories", MANY, "--time", "10min")
            script = folder / "slices.sbatch"
            text = script.read_text()
            # Texts to be edited: the first slice is to end at once when it runs for the first time.
            first = 'limit=500s; if [ "$SLURM_ARRAY_TASK_ID" = 1 ] && [ -z "$SLURM_RESTART_COUNT" ]; then limit=0.001s; fi\n' \
                    'echo "begins with $limit"\n'
            self.assertEqual(text.count("--max-time 500s"), 1)
            script.write_text(text.replace("part=$(", first + "part=$(").replace("--max-time 500s", '--max-time "$limit"'))
            (pathlib.Path(place) / "slurm").mkdir()
            with Slurm(pathlib.Path(place) / "slurm") as slurm:
                slurm.ask("bash", "-c", command)
                slurm.wait(lambda: not slurm.ask("squeue", "-h").strip(), "end of all jobs", 120)
                said = "".join(f"{log.name}:\n{log.read_text()}" for log in sorted(folder.glob("*.log")))
            self.assertIn("begins with 0.001s", (folder / "slice_1.log").read_text())
            self.assertIn("begins with 500s", (folder / "slice_1.log").read_text())
            self.assertTrue((folder / "run.h5").exists(), said)
            trace(folder / "one.h5", "--histories", MANY)
            self.assertEqual(bits(folder / "run.h5"), bits(folder / "one.h5"))
            self.assertEqual([list(attributes(folder / f"part{n}.h5")["slice"]) for n in (1, 4)], [[1, 4], [4, 4]])
            self.assertIn(b"stray light", (folder / "results/report.txt").read_bytes())
            self.assertIn(b"</html>", (folder / "report.html").read_bytes())


if __name__ == "__main__":
    unittest.main()
