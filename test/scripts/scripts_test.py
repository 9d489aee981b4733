#!/usr/bin/python3
"""Checks error messages and exit status 2 of the scripts for invalid arguments."""

import os
import pathlib
import subprocess
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"


class ScriptTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def make_folders(self, *names):
        for name in names:
            (self.folder / name).mkdir(parents=True)

    def make_program(self, name, text="#!/bin/sh\nexit 0\n"):
        path = self.folder / "programs" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)

    def rejects(self, script, *arguments, says, lines=1, **environment):
        """Expects an error whose last line begins with the script's name and contains `says`."""
        variables = {name: value for name, value in os.environ.items() if name != "CBMV_DATA"}
        variables.update({name: str(value) for name, value in environment.items()})
        done = subprocess.run([SCRIPTS / script, *map(str, arguments)], env=variables, check=False,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), lines, done.stderr)
        last = done.stderr.splitlines()[-1]
        self.assertTrue(last.startswith(f"{pathlib.Path(script).name}: "), last)
        self.assertIn(str(says), last)


class Run(ScriptTest):
    def test_unknown_program(self):
        self.rejects("run", "cbmv_nonsense", says="cbmv_match")
        self.rejects("run", says="cbmv_match")


class TestOn(ScriptTest):
    def test_wrong_arguments(self):
        self.rejects("test_on", says="expected bullseye, bookworm or trixie")
        self.rejects("test_on", "focal", says="the release is 'focal'")
        self.rejects("test_on", "trixie", "--compiler", says="--compiler has no value")
        self.rejects("test_on", "trixie", "--only", "build", says="--only is build, expected demo, test or workspace")
        self.rejects("test_on", "trixie", CBMV_DATA=self.folder / "none", says="none, expected a folder")


class Soak(ScriptTest):
    def test_wrong_arguments(self):
        self.rejects("soak", "--size", "640", says="--size is 640, expected WIDTHxHEIGHT")
        self.rejects("soak", "--factors", "1,x", says="--factors is 1,x, expected numbers")

    def test_missing_program(self):
        self.rejects("soak", "--build", self.folder, says=f"there is no {self.folder}/devel/lib/")


class CheckLinks(ScriptTest):
    def check(self, *arguments):
        return subprocess.run([SCRIPTS / "check_links", *arguments], check=False, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)

    def test_the_docs_have_no_broken_link(self):
        done = self.check()
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_broken_links_are_named(self):
        self.make_folders("docs")
        (self.folder / "docs" / "a.md").write_text("# A `b`: c_d\n[x](../README.md) [y](#a-b-c_d)\n")
        (self.folder / "README.md").write_text(
            "[a](docs/a.md#a-b-c_d) [b](docs/b.md) [c](docs/a.md#e) [d](../f.md) [e](https://g.example)\n")
        done = self.check("--root", self.folder, "--external")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stdout, "README.md: https://g.example\n")
        self.assertEqual(done.stderr.splitlines(), [
            "README.md: link docs/b.md: there is no such file",
            "README.md: link docs/a.md#e: docs/a.md has no such heading",
            "README.md: link ../f.md: there is no such file"])


class Generalization(ScriptTest):
    DATA = ("data/middlebury_eval3_Q", "data/kitti2012", "data/kitti2015")

    def rejects_with(self, says, lines=1, output="output"):
        self.rejects("generalization", "--data", self.folder / "data", "--programs",
                     self.folder / "programs", "--output", self.folder / output, says=says,
                     lines=lines)

    def test_missing_program(self):
        self.rejects_with("there is no cbmv_train")
        self.make_program("cbmv_train")
        self.rejects_with("there is no cbmv_eval")

    def test_missing_folder(self):
        self.make_program("cbmv_train")
        self.make_program("cbmv_eval")
        self.rejects_with(self.folder / "data/middlebury_eval3_Q")
        self.make_folders(*self.DATA[:2])
        self.rejects_with(self.folder / "data/kitti2015")

    def test_folder_that_cannot_be_made(self):
        self.make_program("cbmv_train")
        self.make_program("cbmv_eval")
        self.make_folders(*self.DATA)
        (self.folder / "file").write_text("no folder")
        self.rejects_with(self.folder / "file", output="file/output")

    def test_program_that_fails(self):
        self.make_program("cbmv_train")
        self.make_program("cbmv_eval", "#!/bin/sh\nexit 1\n")
        self.make_folders(*self.DATA)
        self.rejects_with("cbmv_eval has failed", lines=2)  # after the command


class EvaluationReport(ScriptTest):
    def test_missing_report(self):
        report = self.folder / "none.json"
        self.rejects("evaluation_report", report, "--output", self.folder / "page.html",
                     says=f"{report} cannot be read")

    def test_something_else_than_a_report(self):
        report = self.folder / "report.json"
        report.write_text("{}")
        self.rejects("evaluation_report", report, "--output", self.folder / "page.html",
                     says=f"{report} is not a JSON report of this version of cbmv_eval")


class ConfidencePictures(ScriptTest):
    def test_missing_report(self):
        report = self.folder / "report.json"
        self.rejects("confidence_pictures", "--kitti", report, "--output", self.folder,
                     says=f"{report} cannot be read")

    def test_report_without_confidence(self):
        report = self.folder / "report.json"
        report.write_text('{"scenes": [{"scene": "Teddy"}]}', encoding="utf-8")
        self.rejects("confidence_pictures", "--kitti", report, "--output", self.folder,
                     says="has no confidence of every scene")

    def test_something_else_than_a_map(self):
        for name in ("depth_sigma.pfm", "disparity.pfm", "confidence.pfm"):
            (self.folder / name).write_text("P5 2 2", encoding="utf-8")
        self.rejects("confidence_pictures", "--maps", self.folder, self.folder, "--output",
                     self.folder, says="depth_sigma.pfm is not a map")


class Benchmark(ScriptTest):
    def rejects_with(self, says, *arguments, lines=1, **environment):
        self.rejects("benchmark", "--build", self.folder / "programs", "--output",
                     self.folder / "output", *arguments, says=says, lines=lines, **environment)

    def test_missing_program(self):
        self.rejects_with("there is no cbmv_benchmark")
        self.make_program("cbmv_benchmark")
        self.rejects_with("there is no cbmv_eval")

    def test_missing_data(self):
        self.make_program("cbmv_benchmark")
        self.make_program("cbmv_eval")
        self.rejects_with("CBMV_DATA is not set")
        self.rejects_with(self.folder / "middlebury_eval3_Q", CBMV_DATA=self.folder)
        self.make_folders("middlebury_eval3_Q")
        self.rejects_with(self.folder / "kitti2012", CBMV_DATA=self.folder)

    def test_missing_matplotlib(self):
        self.make_program("cbmv_benchmark")
        self.make_program("cbmv_eval")
        self.make_folders("middlebury_eval3_Q", "kitti2012")
        (self.folder / "matplotlib.py").write_text("raise ImportError('none here')\n")
        self.rejects_with("python3-matplotlib", CBMV_DATA=self.folder, PYTHONPATH=self.folder)

    def test_program_that_fails(self):
        self.make_program("cbmv_benchmark", "#!/bin/sh\nexit 1\n")
        self.make_program("cbmv_eval")
        self.make_folders("middlebury_eval3_Q", "kitti2012")
        self.rejects_with("cbmv_benchmark has failed", CBMV_DATA=self.folder)

    def test_measurements_that_are_not_there(self):
        self.make_folders("middlebury_eval3_Q", "kitti2012", "output")
        keep = ("--keep", "times", "memory", "poles", "accuracy", "kitti")
        self.rejects_with(self.folder / "output/benchmark.json", *keep, CBMV_DATA=self.folder)
        (self.folder / "output/benchmark.json").write_text("{")
        self.rejects_with("is not valid JSON", *keep, CBMV_DATA=self.folder)


CHECK = """#!/bin/sh
[ "$1" = check ] || exit 1
for last; do true; done
echo '{"frames": 90, "width": 640, "height": 480, "cpu_ms": 100.0, "problems": []}' > "$last"
"""


class Cluster(ScriptTest):
    """Tests planning and submitting with fake Slurm programs that record their arguments. cluster_test.py uses
    a real Slurm."""

    def setUp(self):
        super().setUp()
        self.bag, self.output = self.folder / "in.bag", self.folder / "out.bag"
        self.bag.write_text("bag")
        self.asked, self.queue = self.folder / "asked", self.folder / "queue"
        self.queue.write_text("")
        self.make_program("cbmv_bag", CHECK)
        self.make_program("sbatch", f'#!/bin/sh\necho "sbatch $*" >> {self.asked}\nwc -l < {self.asked}\n')
        self.make_program("scancel", f'#!/bin/sh\necho "scancel $*" >> {self.asked}\n')
        self.make_program("squeue", f"#!/bin/sh\ncat {self.queue}\n")
        self.path = f"{self.folder / 'programs'}:{os.environ['PATH']}"
        self.shards = self.folder / "out.bag.shards"

    def submit(self, *more):
        """Returns the output of the script and its Slurm commands."""
        self.asked.write_text("")
        done = subprocess.run([SCRIPTS / "cluster/submit", self.bag, self.output, "--shards", "4", *more],
                              env={**os.environ, "PATH": self.path}, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout, self.asked.read_text().splitlines()

    def submit_rejects(self, *arguments, says, path=None):
        self.rejects("cluster/submit", *arguments, says=says, PATH=path or self.path)

    def job_name(self):
        return next(word.partition("=")[2] for word in self.submit("--dry-run")[0].split()
                    if word.startswith("--job-name="))

    def test_array_and_merging(self):
        said, asked = self.submit("--cpus-per-task", "2", "--partition", "short", "--memory", "2G", "--copy")
        self.assertIn("90 frames of 640x480, about 1 s for each of 4 shards on 2 CPUs", said)
        for words in ("--array=1-4 ", "--cpus-per-task=2", "--partition=short", "--mem=2G", "--requeue",
                      "--time=11 "):
            self.assertIn(words, asked[0])
        self.assertIn("--dependency=afterok:1 ", asked[1])
        self.assertEqual(len(asked), 2)

    def test_dry_run_changes_nothing(self):
        said, asked = self.submit("--dry-run")
        self.assertIn("--array=1-4", said)
        self.assertEqual(asked, [])
        self.assertFalse(self.shards.exists())

    def test_only_what_is_missing(self):
        name = self.job_name()
        self.submit()
        self.queue.write_text(f"7_2|{name}|RUNNING|None\n8|{name}-merge|PENDING|Dependency\n")
        (self.shards / "shard-0001.bag").touch()
        said, asked = self.submit()
        self.assertIn("1 done, 1 in the queue, 2 submitted", said)
        self.assertIn("--array=3-4 ", asked[0])
        self.assertEqual(asked[1], "scancel 8")
        self.assertIn("--dependency=afterok:7_2:1 ", asked[2])

        self.queue.write_text("".join(f"9_{i}|{name}|PENDING|Resources\n" for i in (2, 3, 4)) +
                              f"10|{name}-merge|PENDING|Dependency\n")
        self.assertEqual(self.submit()[1], [])
        self.queue.write_text("")
        for number in (2, 3, 4):
            (self.shards / f"shard-000{number}.bag").touch()
        said, asked = self.submit()
        self.assertEqual(len(asked), 1)
        self.assertNotIn("--dependency", asked[0])
        self.output.touch()
        said, asked = self.submit()
        self.assertIn("complete already", said)
        self.assertEqual(asked, [])

    def test_other_settings(self):
        self.submit()
        self.submit_rejects(self.bag, self.output, "--shards", 3, says="other shards")
        self.submit_rejects(self.bag, self.output, "--copy", says="other options")
        self.bag.write_text("another bag")
        self.submit_rejects(self.bag, self.output, says="other bytes")

    def test_rejections(self):
        nothing = self.folder / "nothing"
        nothing.mkdir()
        for tool in ("env", "python3"):
            (nothing / tool).symlink_to(f"/usr/bin/{tool}")
        (nothing / "cbmv_bag").symlink_to(self.folder / "programs/cbmv_bag")
        self.submit_rejects(self.bag, self.output, says="sbatch is not on the PATH", path=nothing)
        self.submit_rejects(self.folder / "none.bag", self.output, says="none.bag does not exist")
        self.submit_rejects(self.bag, self.folder, says="is a folder")
        self.submit_rejects(self.bag, nothing / "none/out.bag", says="does not exist")
        self.submit_rejects(self.bag, self.output, "--shard", "1/2", says="--shard is set by submit")
        self.make_program("cbmv_bag", "#!/bin/sh\necho cbmv_bag: in.bag: no stereo pair >&2; exit 2\n")
        self.submit_rejects(self.bag, self.output, says="in.bag: no stereo pair")
        self.assertFalse(self.shards.exists())
        self.output.touch()
        self.submit_rejects(self.bag, self.output, says="out.bag exists")
        self.rejects("cluster/status", self.output, says="plan.json")


if __name__ == "__main__":
    unittest.main()
