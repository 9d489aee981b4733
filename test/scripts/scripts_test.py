#!/usr/bin/python3
"""What the scripts say of wrong arguments: one sentence, exit status 2."""

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

    def refuses(self, script, *arguments, says, lines=1, **environment):
        """Checks for a refusal whose last line begins with the script's name and holds `says`."""
        variables = {name: value for name, value in os.environ.items() if name != "CBMV_DATA"}
        variables.update({name: str(value) for name, value in environment.items()})
        done = subprocess.run([SCRIPTS / script, *map(str, arguments)], env=variables, check=False,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), lines, done.stderr)
        last = done.stderr.splitlines()[-1]
        self.assertTrue(last.startswith(f"{script}: "), last)
        self.assertIn(str(says), last)


class Soak(ScriptTest):
    def test_wrong_arguments(self):
        self.refuses("soak", "--size", "640", says="--size is 640; WIDTHxHEIGHT")
        self.refuses("soak", "--factors", "1,x", says="--factors is 1,x; numbers")

    def test_missing_program(self):
        self.refuses("soak", "--build", self.folder, says=f"there is no {self.folder}/devel/lib/")


class Generalization(ScriptTest):
    DATA = ("data/middlebury_eval3_Q", "data/kitti2012", "data/kitti2015")

    def refuses_with(self, says, lines=1, output="output"):
        self.refuses("generalization", "--data", self.folder / "data", "--programs",
                     self.folder / "programs", "--output", self.folder / output, says=says,
                     lines=lines)

    def test_missing_program(self):
        self.refuses_with("there is no cbmv_train")
        self.make_program("cbmv_train")
        self.refuses_with("there is no cbmv_eval")

    def test_missing_folder(self):
        self.make_program("cbmv_train")
        self.make_program("cbmv_eval")
        self.refuses_with(self.folder / "data/middlebury_eval3_Q")
        self.make_folders(*self.DATA[:2])
        self.refuses_with(self.folder / "data/kitti2015")

    def test_folder_that_cannot_be_made(self):
        self.make_program("cbmv_train")
        self.make_program("cbmv_eval")
        self.make_folders(*self.DATA)
        (self.folder / "file").write_text("no folder")
        self.refuses_with(self.folder / "file", output="file/output")

    def test_program_that_fails(self):
        self.make_program("cbmv_train")
        self.make_program("cbmv_eval", "#!/bin/sh\nexit 1\n")
        self.make_folders(*self.DATA)
        self.refuses_with("cbmv_eval has failed", lines=2)  # after the command


class EvaluationReport(ScriptTest):
    def test_missing_report(self):
        report = self.folder / "none.json"
        self.refuses("evaluation_report", report, "--output", self.folder / "page.html",
                     says=f"{report} cannot be read")

    def test_something_else_than_a_report(self):
        report = self.folder / "report.json"
        report.write_text("{}")
        self.refuses("evaluation_report", report, "--output", self.folder / "page.html",
                     says=f"{report} is not a JSON report of cbmv_eval")


class Benchmark(ScriptTest):
    def refuses_with(self, says, *arguments, lines=1, **environment):
        self.refuses("benchmark", "--build", self.folder / "programs", "--output",
                     self.folder / "output", *arguments, says=says, lines=lines, **environment)

    def test_missing_program(self):
        self.refuses_with("there is no cbmv_benchmark")
        self.make_program("cbmv_benchmark")
        self.refuses_with("there is no cbmv_eval")

    def test_missing_data(self):
        self.make_program("cbmv_benchmark")
        self.make_program("cbmv_eval")
        self.refuses_with("CBMV_DATA is not set")
        self.refuses_with(self.folder / "middlebury_eval3_Q", CBMV_DATA=self.folder)

    def test_missing_matplotlib(self):
        self.make_program("cbmv_benchmark")
        self.make_program("cbmv_eval")
        self.make_folders("middlebury_eval3_Q")
        (self.folder / "matplotlib.py").write_text("raise ImportError('none here')\n")
        self.refuses_with("python3-matplotlib", CBMV_DATA=self.folder, PYTHONPATH=self.folder)

    def test_program_that_fails(self):
        self.make_program("cbmv_benchmark", "#!/bin/sh\nexit 1\n")
        self.make_program("cbmv_eval")
        self.make_folders("middlebury_eval3_Q")
        self.refuses_with("cbmv_benchmark has failed", CBMV_DATA=self.folder)

    def test_measurements_that_are_not_there(self):
        self.make_folders("middlebury_eval3_Q", "output")
        keep = ("--keep", "times", "memory", "accuracy")
        self.refuses_with(self.folder / "output/benchmark.json", *keep, CBMV_DATA=self.folder)
        (self.folder / "output/benchmark.json").write_text("{")
        self.refuses_with("is no JSON", *keep, CBMV_DATA=self.folder)


if __name__ == "__main__":
    unittest.main()
