"""The shards of an output: the plan of `submit` and the state of each shard."""

import collections
import getpass
import hashlib
import json
import pathlib
import re
import shutil
import subprocess


class BadInput(Exception):
    """An error with a message for the user."""


Job = collections.namedtuple("Job", "number state reason")  # number: JOB_TASK
State = collections.namedtuple("State", "name detail job")

MERGE = 0  # key of the merge job in maps from shard numbers


class Shards:
    """The folder OUT.shards: plan.json, bags and logs."""

    def __init__(self, output):
        self.output = pathlib.Path(output).absolute()
        self.folder = self.output.with_name(self.output.name + ".shards")
        self.plan_file = self.folder / "plan.json"
        # Derived from the path, so that no record of submitted jobs is needed.
        self.job_name = "cbmv-" + hashlib.sha256(str(self.output).encode()).hexdigest()[:12]
        self.merge_name = self.job_name + "-merge"

    def read_plan(self):
        """The plan; None if there is none."""
        try:
            return json.loads(self.plan_file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            raise BadInput(f"{self.plan_file} cannot be read: {error}. Check the file") from error

    def write_plan(self, plan):
        new = self.plan_file.with_suffix(".new")
        try:
            new.write_text(json.dumps(plan, indent=2) + "\n", encoding="utf-8")
            new.replace(self.plan_file)
        except OSError as error:
            raise BadInput(f"{self.plan_file} cannot be written: {error.strerror}. Check its folder") from error

    def bag(self, number):
        return self.folder / f"shard-{number:04d}.bag"

    def log(self, number):
        return self.folder / ("merge.log" if number == MERGE else f"shard-{number:04d}.log")

    def frames_done(self, number):
        """Number of frames in the finished parts of a shard."""
        done = 0
        for part in self.folder.glob(self.bag(number).name + ".part.*"):
            numbers = re.search(r"\.part\.(\d+)-(\d+)$", part.name)
            if numbers:
                done += int(numbers.group(2)) - int(numbers.group(1)) + 1
        return done

    def jobs(self):
        """Slurm's jobs for this output, by shard number."""
        lines = slurm(["squeue", "--noheader", "--array", "--user", getpass.getuser(), "--name",
                       f"{self.job_name},{self.merge_name}", "--format", "%i|%j|%T|%r"])
        jobs = {}
        for line in lines.splitlines():
            number, name, state, reason = line.strip().split("|", 3)
            key = MERGE if name == self.merge_name else int(number.split("_")[1])
            jobs[key] = Job(number, state, reason)
        return jobs

    def states(self, count, jobs):
        """State of each shard and of the merge job: done, running, queued, failed, missing."""
        return {number: self._state(number, jobs.get(number)) for number in range(count + 1)}

    def _state(self, number, job):
        if job and job.state == "PENDING":
            return State("queued", job.reason, job)
        if job:
            return State("running", job.state.lower(), job)
        if (self.output if number == MERGE else self.bag(number)).exists():
            return State("done", "", None)
        log = self.log(number)
        if not log.exists():
            return State("missing", "", None)
        lines = log.read_text(encoding="utf-8", errors="replace").split("\n")
        said = [line for line in lines if line.strip()]
        return State("failed", said[-1] if said else "without a word", None)


def slurm(command):
    """Standard output of a Slurm program."""
    if not shutil.which(command[0]):
        raise BadInput(f"{command[0]} is not on the PATH, expected Slurm's programs. Install Slurm or correct PATH")
    done = subprocess.run(command, check=False, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)
    if done.returncode != 0:
        raise BadInput(f"{command[0]} has failed: {' '.join(done.stderr.split())}")
    return done.stdout
