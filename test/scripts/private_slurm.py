"""A private Slurm with one node for tests: it has its own munge and ports, and all files in one folder."""

import contextlib
import getpass
import os
import pathlib
import secrets
import shutil
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel", "sinfo")
CONFIGURATION = """
ClusterName=cbmvtest
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=2
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ReturnToService=2
JobRequeue=1
KillWait=5
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
NodeName=localhost NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=localhost Default=YES MaxTime=INFINITE State=UP
"""


def find(program):
    return shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/sbin")


def missing_programs():
    return [program for program in PROGRAMS if not find(program)]


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


class PrivateSlurm:
    """Runs from `start` to `stop`; `environment` is for programs that use it."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))
        self.daemons = []

    def start(self):
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.touch(mode=0o600)
        key.write_bytes(secrets.token_bytes(128))
        controller_port, node_port = free_ports(2)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            folder=self.folder, user=getpass.getuser(), controller_port=controller_port,
            node_port=node_port, processors=os.cpu_count()), encoding="utf-8")
        self._launch("munged", "--foreground", "--force", f"--key-file={key}",
                     *(f"--{name}-file={self.folder}/munge.{name}" for name in ("pid", "seed", "log")),
                     f"--socket={self.folder}/munge.socket")
        self._wait_for((self.folder / "munge.socket").exists)
        self._launch("slurmctld", "-D", "-f", self.environment["SLURM_CONF"])
        self._wait_for(lambda: "UP" in self.run("scontrol", "ping"))
        self._launch("slurmd", "-D", "-f", self.environment["SLURM_CONF"], "-N", "localhost")
        self._wait_for(lambda: "idle" in self.run("sinfo", "--noheader", "--format=%T"))

    def stop(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait()

    def cancel_all(self):
        self.run("scancel", "--user", getpass.getuser())
        self._wait_for(lambda: not self.run("squeue", "--noheader"))

    def run(self, *command):
        """Runs a command and returns its standard output."""
        done = subprocess.run([find(command[0]), *command[1:]], env=self.environment, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        return done.stdout

    def _launch(self, program, *arguments):
        with open(self.folder / f"{program}.out", "w", encoding="utf-8") as log:
            self.daemons.append(subprocess.Popen([find(program), *arguments], stdout=log, stderr=log,
                                                 env=self.environment))

    def _wait_for(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                logs = [log.read_text(encoding="utf-8") for log in self.folder.glob("*.out")]
                raise TimeoutError("Slurm does not answer:\n" + "\n".join(logs))
            time.sleep(0.2)
