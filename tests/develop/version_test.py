#!/usr/bin/env python3
"""Version and commit are those of the build: write_version.cmake in checkouts of its own, and the programs just built.

usage: version_test.py CMAKE PROJECT_VERSION PROGRAM...
"""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
CMAKE, VERSION, *PROGRAMS = sys.argv[1:]


def run(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


class VersionText(unittest.TestCase):
    def setUp(self):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory())).resolve()
        self.checkout = folder / "checkout"
        self.checkout.mkdir()
        self.output = folder / "version.cpp"
        (self.checkout / "file").write_text("1")

    def git(self, *arguments):
        return run("git", "-c", "user.name=t", "-c", "user.email=t@t", *arguments, cwd=self.checkout).strip()

    def commit(self):
        self.git("init", "-q")
        self.git("add", "file")
        self.git("commit", "-q", "-m", "m")
        return self.git("rev-parse", "--short", "HEAD")

    def text(self, source=None):
        run(CMAKE, f"-DSOURCE={source or self.checkout}", "-DVERSION=1.2.3", f"-DOUTPUT={self.output}", "-P",
            TOP / "src/pbrt/core/write_version.cmake")
        return re.search('return "(.*)"', self.output.read_text()).group(1)

    def test_follows_commits_and_changes(self):
        first = self.commit()
        self.assertEqual(self.text(), f"pbrt_octree 1.2.3 (commit {first})")
        (self.checkout / "file").write_text("2")
        self.assertEqual(self.text(), f"pbrt_octree 1.2.3 (commit {first}, modified)")
        self.git("commit", "-q", "-a", "-m", "second")
        second = self.git("rev-parse", "--short", "HEAD")
        self.assertNotEqual(first, second)
        self.assertEqual(self.text(), f"pbrt_octree 1.2.3 (commit {second})")

    def test_writes_nothing_if_nothing_changed(self):
        self.commit()
        self.text()
        before = self.output.stat().st_mtime_ns
        self.text()
        self.assertEqual(self.output.stat().st_mtime_ns, before)

    def test_names_no_commit_outside_a_checkout(self):
        self.assertEqual(self.text(), "pbrt_octree 1.2.3 (commit unknown)")

    def test_ignores_the_checkout_around_an_archive(self):
        self.commit()
        archive = self.checkout / "archive"
        archive.mkdir()
        self.assertEqual(self.text(archive), "pbrt_octree 1.2.3 (commit unknown)")

    def test_programs_print_it(self):
        texts = {run(program, "--version") for program in PROGRAMS}
        self.assertEqual(len(texts), 1)
        self.assertRegex(texts.pop(), rf"^pbrt_octree {re.escape(VERSION)} \(commit (unknown|[0-9a-f]+(, modified)?)\)\n$")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
