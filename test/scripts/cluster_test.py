#!/usr/bin/python3
"""Tests scripts/cluster with a private Slurm. Usage: cluster_test.py CBMV_BAG FOREST. Skipped (exit status 77)
without CBMV_TEST_CLUSTER=1, because it takes minutes and needs Slurm and munge."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import private_slurm

SKIPPED = 77
CLUSTER = pathlib.Path(__file__).resolve().parents[2] / "scripts/cluster"
WIDTH, HEIGHT, FRAMES = 320, 240, 40
PROGRAM = FOREST = None  # from the command line


def write_recording(path):
    """Writes a bag with different frames, and messages of another topic."""
    import numpy
    import rosbag
    import rospy
    from sensor_msgs.msg import CameraInfo, Image
    from std_msgs.msg import Header, String

    random = numpy.random.RandomState(1)
    with rosbag.Bag(str(path), "w") as bag:
        for frame in range(FRAMES):
            time_of_frame = rospy.Time.from_sec(100 + frame / 10)
            header = Header(stamp=time_of_frame, seq=frame, frame_id="camera")
            blocks = random.randint(0, 256, (HEIGHT // 4, WIDTH // 4 + 10)).astype(numpy.uint8)
            scene = blocks.repeat(4, 0).repeat(4, 1)
            bag.write("/words", String(f"word {frame}"), time_of_frame)
            for side, shift, p3 in (("left", 0, 0), ("right", 8 + frame % 16, -30)):
                pixels = scene[:, shift:shift + WIDTH].tobytes()
                bag.write(f"/stereo/{side}/image_rect",
                          Image(header, HEIGHT, WIDTH, "mono8", 0, WIDTH, pixels), time_of_frame)
                info = CameraInfo(header=header, width=WIDTH, height=HEIGHT)
                info.P = [300, 0, WIDTH / 2, p3, 0, 300, HEIGHT / 2, 0, 0, 0, 1, 0]
                bag.write(f"/stereo/{side}/camera_info", info, time_of_frame)


def content(path):
    """Topic, type, bytes, checksum, time and header of the connection of every message."""
    import rosbag

    with rosbag.Bag(str(path)) as bag:
        return [(topic, raw[0], raw[1], raw[2], stamp, tuple(sorted(header.items())))
                for topic, raw, stamp, header in bag.read_messages(raw=True, return_connection_header=True)]


def programs_of(shard):
    """The processes of cbmv_bag that write a shard."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
        except OSError:
            continue  # it has ended
        if os.fsencode(shard) in words and words[0].endswith(b"cbmv_bag"):
            found.append(int(folder.name))
    return found


class ClusterTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="cbmv_cluster_test_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        (cls.folder / "slurm").mkdir()
        cls.slurm = private_slurm.PrivateSlurm(cls.folder / "slurm")
        cls.addClassCleanup(cls.slurm.stop)
        cls.slurm.start()
        cls.input = cls.folder / "in.bag"
        write_recording(cls.input)
        cls.options = ["--forest", FOREST, "--disparities", "64", "--frames-per-part", "2", "--copy",
                       "--write", "disparity,confidence"]
        whole = cls.folder / "whole.bag"
        subprocess.run([PROGRAM, cls.input, "--output", whole, *cls.options], check=True,
                       stdout=subprocess.DEVNULL)
        cls.whole = content(whole)

    def setUp(self):
        name = self.id().split(".")[-1]
        self.output = self.folder / f"{name}.bag"
        self.shards = self.folder / f"{name}.bag.shards"
        self.addCleanup(self.slurm.cancel_all)

    def call(self, script, *arguments, status=0):
        done = subprocess.run([CLUSTER / script, *map(str, arguments)], env=self.slurm.environment,
                              check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, status, done.stdout)
        return done.stdout

    def submit(self, *more, program=None):
        return self.call("submit", self.input, self.output, "--shards", 4, "--cpus-per-task", 1,
                         "--cbmv-bag", program or PROGRAM, *more, *self.options)

    def queue(self):
        """Numbers of all jobs that are not done."""
        return self.slurm.run("squeue", "--noheader", "--array", "--format=%i").split()

    def shard(self, number):
        return self.shards / f"shard-{number:04d}.bag"

    def log(self, number):
        return self.shards.joinpath(f"shard-{number:04d}.log").read_text(encoding="utf-8")

    def task(self, number):
        """JOB_TASK of a shard in the queue."""
        return next(job for job in self.queue() if job.endswith(f"_{number}"))

    def wait_for(self, condition, seconds=300):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                self.fail(self.call_status())
            time.sleep(0.05)

    def call_status(self):
        return subprocess.run([CLUSTER / "status", self.output], env=self.slurm.environment, check=False,
                              stdout=subprocess.PIPE, text=True).stdout

    def wait_for_part(self, number):
        """Waits until a shard has stored frames."""
        self.wait_for(lambda: list(self.shards.glob(f"shard-{number:04d}.bag.part.0*")))

    def finish(self):
        """Waits until the queue is empty. Releases restarted tasks, which Slurm would delay by two minutes."""
        def done():
            for line in self.slurm.run("squeue", "--noheader", "--array", "--format=%i %r").splitlines():
                job, reason = line.split(maxsplit=1)
                if reason == "BeginTime":
                    self.slurm.run("scontrol", "update", f"JobId={job}", "StartTime=now")
            time.sleep(0.3)
            return not self.queue()
        self.wait_for(done)

    def expect_whole(self):
        self.call("status", self.output)
        self.assertEqual(len(self.whole), 7 * FRAMES)
        self.assertTrue(content(self.output) == self.whole)

    def test_four_tasks_do_the_work_of_one(self):
        self.assertIn("4 submitted", self.submit())
        queue = self.queue()
        self.assertEqual(len(queue), 5)
        self.assertIn("0 submitted", self.submit())
        self.assertLessEqual(set(self.queue()), set(queue))
        self.assertIn("0 failed, 0 missing", self.call("status", self.output, status=3))
        self.finish()
        self.expect_whole()
        self.assertIn("complete already", self.submit())
        self.assertEqual(self.queue(), [])

    def test_tasks_that_are_killed_or_requeued_go_on(self):
        self.submit()
        self.wait_for_part(1)
        for process in programs_of(self.shard(1)):
            os.kill(process, signal.SIGKILL)
        self.wait_for_part(2)
        self.slurm.run("scontrol", "requeue", self.task(2))
        self.wait_for_part(3)
        self.slurm.run("scancel", "--batch", "--signal=USR1", self.task(3))  # the time limit is nearly reached
        self.finish()
        self.expect_whole()
        self.assertIn("ended by signal 9", self.log(1))
        self.assertIn("DUE TO JOB REQUEUE", self.log(2))
        self.assertIn("restart 1 of 3", self.log(3))
        for number in (1, 2, 3):
            self.assertIn("processed earlier", self.log(number))
        self.assertNotIn("processed earlier", self.log(4))

    def test_a_shard_that_is_deleted_is_done_again(self):
        self.submit()
        self.finish()
        self.shard(2).unlink()
        self.output.unlink()
        others = {number: self.shard(number).stat().st_mtime_ns for number in (1, 3, 4)}
        self.assertIn("3 done, 0 in the queue, 1 submitted", self.submit())
        self.assertEqual([job.partition("_")[2] for job in sorted(self.queue())], ["2", ""])
        self.finish()
        self.expect_whole()
        self.assertEqual(others, {number: self.shard(number).stat().st_mtime_ns for number in others})

    def test_a_shard_that_fails_is_tried_again_and_given_up(self):
        broken = self.folder / "broken"
        broken.touch()
        program = self.folder / "fragile"
        program.write_text(f'#!/bin/sh\ncase "$*" in *" 3/4 "*) [ ! -e {broken} ] || exit 9;; esac\n'
                           f'exec {PROGRAM} "$@"\n', encoding="utf-8")
        program.chmod(0o755)
        self.submit("--retries", 1, program=program)
        self.finish()
        self.assertEqual(self.log(3).count("ended by exit status 9"), 2)
        self.assertIn("shard 3/4  failed  run_task: gives up after 1 restarts",
                      self.call("status", self.output, status=3))
        self.assertFalse(self.output.exists())
        broken.unlink()
        self.assertIn("3 done, 0 in the queue, 1 submitted", self.submit())
        self.finish()
        self.expect_whole()


def main():
    global PROGRAM, FOREST
    if os.environ.get("CBMV_TEST_CLUSTER") != "1":
        print("skipped: CBMV_TEST_CLUSTER is not 1")
        sys.exit(SKIPPED)
    missing = private_slurm.missing_programs()
    if missing:
        print(f"cluster_test: {', '.join(missing)} missing; scripts/install_dependencies --cluster installs "
              "them", file=sys.stderr)
        sys.exit(2)
    PROGRAM, FOREST = map(os.path.abspath, sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])


if __name__ == "__main__":
    main()
