# SPDX-License-Identifier: BSD-3-Clause
"""A Slurm of one node on this machine: munged, slurmctld and slurmd of the Debian packages, on the loopback, in a folder of
their own, all under the user who runs this."""
import os
import pathlib
import pwd
import shutil
import socket
import subprocess
import time

CONF = """ClusterName=straytrace
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={control}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0,sched_min_interval=0
MailProg=/bin/true
ReturnToService=2
SlurmdParameters=config_overrides
KillWait=2
MpiDefault=none
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 RealMemory=16000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Slurm:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.children = []
        for tool in ("munged", "slurmctld", "slurmd", "sbatch"):
            if not shutil.which(tool, path=os.environ["PATH"] + ":/usr/sbin"):
                raise FileNotFoundError(f"{tool}: scripts/setup --test installs slurmctld, slurmd, slurm-client and munge")
        (self.folder / "state").mkdir()
        (self.folder / "spool").mkdir()
        self.folder.chmod(0o755)
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        self.host = socket.gethostname().split(".")[0]
        (self.folder / "slurm.conf").write_text(
            CONF.format(host=self.host, user=pwd.getpwuid(os.getuid()).pw_name, folder=self.folder, control=free_port(),
                        node=free_port()))
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"),
                                PATH=os.environ["PATH"] + ":/usr/sbin")

    def __enter__(self):
        here = self.folder
        self.start("munged", "--foreground", "--force", f"--socket={here}/munge.socket", f"--key-file={here}/munge.key",
                   f"--pid-file={here}/munged.pid", f"--seed-file={here}/munged.seed")
        self.wait(lambda: (here / "munge.socket").exists(), "munged")
        self.start("slurmctld", "-D", "-c")
        self.start("slurmd", "-D", "-N", self.host)
        self.wait(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%t", check=False), "a node that is idle")
        return self

    def __exit__(self, *_):
        for child in reversed(self.children):
            child.terminate()
        for child in reversed(self.children):
            try:
                child.wait(10)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()

    def start(self, *words):
        with open(self.folder / f"{words[0]}.out", "w") as log:
            self.children.append(subprocess.Popen(words, env=self.environment, stdout=log, stderr=log))

    def ask(self, *words, check=True, **more):
        done = subprocess.run(words, text=True, capture_output=True, env=self.environment, **more)
        if check and done.returncode:
            raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def wait(self, there, what, seconds=60):
        until = time.monotonic() + seconds
        while not there():
            for child in self.children:
                if child.poll() is not None:
                    raise AssertionError(f"{child.args[0]} has ended\n{self.logs()}")
            if time.monotonic() > until:
                raise AssertionError(f"no {what} after {seconds} s\n{self.logs()}")
            time.sleep(0.1)

    def logs(self):
        names = ("munged.out", "slurmctld.out", "slurmctld.log", "slurmd.out", "slurmd.log")
        return "".join(f"--- {n}\n{(self.folder / n).read_text()[-3000:]}\n" for n in names if (self.folder / n).exists())
