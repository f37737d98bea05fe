#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Files of `straytrace submit`: HTCondor's own parser reads them, a pool of one machine made here runs them to the bits of one run;
names of users cannot become commands; scenes that cannot be sliced are errors. Usage: test_submit.py PROGRAM"""
import pathlib
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest

import htcondor2

from cluster_support import BLOCK, PROGRAM, QUIET, SCENE, SOURCE, ask, bits, trace

MANY = str(12 * BLOCK)


def described(file, process=0):
    """A submit file as HTCondor understands it, for one process of its queue."""
    job = htcondor2.Submit(file.read_text())
    job["Process"] = str(process)
    return job


class Pool:
    """Runs jobs like HTCondor: each in a separate folder with the transferred files, again after a checkpoint."""

    def __init__(self, home):
        self.home, self.restarts = home, 0

    def run(self, job):
        arguments = shlex.split(job.expand("arguments").strip('"'))
        kept = []
        while True:
            with tempfile.TemporaryDirectory() as scratch:
                for name in [n.strip() for n in job.expand("transfer_input_files").split(",")]:
                    shutil.copy(self.home / name, scratch)
                for name, content in kept:
                    (pathlib.Path(scratch) / name).write_bytes(content)
                done = subprocess.run([job.expand("executable"), *arguments], cwd=scratch, env=QUIET, text=True, capture_output=True)
                if done.returncode == int(job.get("checkpoint_exit_code", "-1")):
                    name = job.expand("transfer_checkpoint_files")
                    kept = [(name, (pathlib.Path(scratch) / name).read_bytes())]
                    arguments = [a if a != "0.001s" else "500s" for a in arguments]
                    self.restarts += 1
                    continue
                assert done.returncode == 0, f"{arguments}: {done.stderr}"
                for name in job.expand("transfer_output_files").split(","):
                    result = pathlib.Path(scratch) / name.strip()
                    (shutil.copytree if result.is_dir() else shutil.copy)(result, self.home / name.strip())
                return


class Condor(unittest.TestCase):
    def test_a_dag_becomes_one_run(self):
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place) / "jobs"
            ask("submit", *SCENE, "--backend", "condor", "--jobs", "3", "-o", folder, "--histories", MANY, "--time", "10min",
                "--accounting", "virgo.prod.o4")
            dag = (folder / "run.dag").read_text()                      # no parser of these comes without a pool: by their grammar
            for line in dag.splitlines():
                self.assertRegex(line, r"^(#.*|JOB \w+ \w+\.sub|RETRY \w+ \d+|PARENT \w+ CHILD \w+)$")
            order = re.findall(r"^PARENT (\w+) CHILD (\w+)$", dag, re.M)
            self.assertEqual(order, [("slices", "merge"), ("merge", "noise"), ("noise", "report")])
            self.assertEqual(sorted(re.findall(r"^JOB (\w+) (\w+\.sub)$", dag, re.M)),
                             sorted((n, n + ".sub") for n in ("slices", "merge", "noise", "report")))
            text = (folder / "slices.sub").read_text()
            self.assertEqual(described(folder / "slices.sub").getQArgs().strip(), "3")
            self.assertEqual(described(folder / "slices.sub").expand("accounting_group"), "virgo.prod.o4")
            (folder / "slices.sub").write_text(text.replace("--max-time 500s", "--max-time 0.001s"))
            pool = Pool(folder)
            for process in range(3):
                pool.run(described(folder / "slices.sub", process))
            self.assertEqual(pool.restarts, 3)
            for name in ("merge", "noise", "report"):
                pool.run(described(folder / f"{name}.sub"))
            trace(folder / "one.h5", "--histories", MANY)
            self.assertEqual(bits(folder / "run.h5"), bits(folder / "one.h5"))
            self.assertIn(b"</html>", (folder / "report.html").read_bytes())

    def test_broken_text_is_seen(self):                                 # control: the parser that is trusted above
        with self.assertRaises(Exception):
            htcondor2.Submit("executable = /bin/true\nthis is no line of a submit file\nqueue\n")


class Words(unittest.TestCase):
    def test_names_of_users_are_no_commands(self):
        hostile = "a b'c\"d $(touch owned) `touch owned`;touch owned #\n#SBATCH --wrap=touch"
        with tempfile.TemporaryDirectory() as place:
            home = pathlib.Path(place) / hostile
            home.mkdir()
            scene = home / f"scene {hostile.replace('/', '')}.yaml"
            scene.write_text(pathlib.Path(SCENE[0]).read_text())
            program = home / "stray trace"
            shutil.copy(PROGRAM, program)
            for backend, files in (("slurm", 4), ("condor", 7)):
                out = home / backend
                words = [str(program), "submit", str(scene), "--backend", backend, "--jobs", "2", "-o", str(out), "--histories", MANY]
                done = subprocess.run(words, text=True, capture_output=True, env=QUIET, cwd=place)
                if backend == "condor":
                    self.assertEqual(done.returncode, 2)                # a submit file has no way to quote it
                    self.assertIn("install straytrace in a path", done.stderr)
                    self.assertFalse(out.exists())
                    words[0] = str(PROGRAM)
                    done = subprocess.run(words, text=True, capture_output=True, env=QUIET, cwd=place)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(len(list(out.iterdir())), files)
                for file in out.glob("*.s*"):
                    if file.suffix in (".sbatch", ".sh"):
                        subprocess.run(["bash", "-n", str(file)], check=True)
                        orders = file.read_text().split("\nprogram=")[0]     # Slurm reads none below the first command
                        self.assertNotRegex(orders, r"(?m)^#SBATCH --wrap")
                # The commands are replaced by one that prints its folder and arguments.
                tools = pathlib.Path(place) / "tools"
                tools.mkdir(exist_ok=True)
                for tool in ("sbatch", "condor_submit_dag", "scontrol"):
                    (tools / tool).write_text('#!/bin/bash\necho "$PWD|$*" >>"$SAID"; echo 12\n')
                    (tools / tool).chmod(0o755)
                said = pathlib.Path(place) / f"said_{backend}"
                environment = dict(QUIET, PATH=f"{tools}:{QUIET['PATH']}", SAID=str(said))
                subprocess.run(["bash", "-c", done.stdout], check=True, env=environment, cwd=place, capture_output=True)
                self.assertIn(f"{out}|", said.read_text())
            task = dict(environment, SLURM_ARRAY_TASK_ID="2", SLURM_ARRAY_JOB_ID="12")
            for script in ("slices.sbatch", "finish.sbatch"):
                if script == "finish.sbatch":
                    subprocess.run(["bash", "slices.sbatch"], check=True, env=dict(task, SLURM_ARRAY_TASK_ID="1"), cwd=home / "slurm")
                subprocess.run(["bash", script], check=True, env=task, cwd=home / "slurm", capture_output=True)
            self.assertTrue((home / "slurm/run.h5").exists())
            self.assertEqual([p for p in pathlib.Path(place).rglob("owned")], [])

    def test_what_cannot_be_sliced_is_refused(self):
        with tempfile.TemporaryDirectory() as place:
            def rejected(*words, scene=tuple(SCENE)):
                said = ask("submit", *scene, "--backend", "slurm", "-o", f"{place}/jobs", *words, code=2)
                self.assertFalse(pathlib.Path(place, "jobs").exists())
                return said
            virgo = (str(SOURCE / "examples/virgo_arm.yaml"),)          # it stops by error
            self.assertIn("--histories", rejected("--jobs", "4", scene=virgo))
            self.assertIn("write --jobs 192", rejected("--jobs", "400", "--histories", 3 * BLOCK))
            for time in ("1s", "1e300h"):                               # too short to write a part; no number of a clock
                self.assertIn("between 1min and 8784h", rejected("--jobs", "2", "--histories", MANY, "--time", time))
            self.assertIn("from 1 to 50000", rejected("--jobs", "60000", "--histories", "1e10"))
            self.assertIn("not a valid name of an account", rejected("--jobs", "2", "--accounting", "a;b"))
            self.assertIn("--backend", ask("submit", *SCENE, "--jobs", "2", "-o", f"{place}/jobs", code=2))
            for count, said in (("1000", False), ("1001", True)):
                words = ["submit", *SCENE, "--backend", "slurm", "-o", f"{place}/many", "--jobs", count, "--histories", "1e10"]
                done = subprocess.run([str(PROGRAM), *words], text=True, capture_output=True, env=QUIET, check=True)
                self.assertEqual("MaxArraySize" in done.stderr, said)
            jobs = f"{place}/jobs"
            ask("submit", *SCENE, "--backend", "slurm", "-o", jobs, "--jobs", "2", "--histories", MANY)
            ask("trace", f"{jobs}/input.h5", "--slice", "1/2", "-o", f"{jobs}/part1.h5", "--quiet")
            ask("submit", *SCENE, "--backend", "slurm", "-o", jobs, "--jobs", "2", "--histories", MANY)       # the same again
            self.assertIn("another number of jobs",
                          ask("submit", *SCENE, "--backend", "slurm", "-o", jobs, "--jobs", "3", "--histories", MANY, code=2))


if __name__ == "__main__":
    unittest.main()
