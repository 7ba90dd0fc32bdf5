#!/usr/bin/python3
"""Tests docs/check on small repositories: one without faults, and copies of it that are broken in one place each."""
import pathlib
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

CHECK = pathlib.Path(__file__).resolve().parents[4] / "docs/check"

FILES = {
    "README.md": """# Title

See [the guide](docs/guide.md#how-to-render-it), [changes](docs/changelog.md) and ![a chart](docs/chart.svg).

    pbrt --spp 4 scene.pbrt         # four samples
    nice -n 10 pbrt --spp 4 scene.pbrt && imgtool diff --metric relL2 a.exr b.exr

Make it with `docs/make --size 3`. The word `--other` alone is no command.
""",
    "docs/guide.md": """# Guide

## How to render it

```sh
lightlab scene.pbrt --time 2 --samplers \\
    bvh,octree
```

A link in `code [like](this.md)` is none. See docs/guide.md.

| a | b |
|---|---|
| 1 | 2 |
""",
    "docs/make": """#!/usr/bin/python3
import argparse
parser = argparse.ArgumentParser()
parser.add_argument("--size")
parser.parse_args()
""",
    "docs/chart.svg": "<svg/>",
    "docs/changelog.md": "# Changes\n\n- docs/gone.md went; ../shared was named.\n",
    "docs/figures.txt": "docs/chart.svg | docs/guide.md#how-to-render-it | docs/make | -\n",
    "docs/budgets.txt": "# words and pages\n40 README.md\n40 docs/guide.md\n20 docs/changelog.md\n",
    "src/a.cpp": "// As docs/guide.md says.\n",
}
PROGRAMS = {"pbrt": "  --spp INT\n", "lightlab": "  --time S\n  --samplers LIST\n",
            "imgtool": "  --metric NAME\n"}


class Check(unittest.TestCase):
    def setUp(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.top, self.programs = folder / "top", folder / "programs"
        for name, text in FILES.items():
            self.write(name, text)
        for name, help_text in PROGRAMS.items():
            file = self.programs / name / name
            file.parent.mkdir(parents=True)
            known = "case \"$1\" in nothing) exit 1;; esac\n" if name == "imgtool" else ""
            file.write_text(f"#!/bin/sh\n{known}cat <<'E'\n{help_text}E\n")
            file.chmod(file.stat().st_mode | stat.S_IXUSR)
        self.assertEqual(self.run_check("--stamp", "docs/chart.svg").returncode, 0)

    def write(self, name, text):
        file = self.top / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def replace(self, name, old, new):
        text = (self.top / name).read_text()
        self.assertIn(old, text)
        self.write(name, text.replace(old, new))

    def run_check(self, *arguments):
        return subprocess.run([sys.executable, CHECK, "--top", self.top, "--programs", self.programs, *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def faults(self):
        done = self.run_check()
        found = [line for line in done.stdout.splitlines()[:-1] if not line.startswith("words:")]
        self.assertEqual(done.returncode, 1 if found else 0, done.stdout)
        return found

    def expect(self, place, *words):
        found = self.faults()
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(place), found)
        for word in words:
            self.assertIn(word, found[0])

    def test_reports_nothing_without_faults(self):
        self.assertEqual(self.faults(), [])
        self.assertIn("5 commands", self.run_check().stdout)

    def test_works_in_a_git_repository(self):
        for words in (["init", "-q"], ["add", "-A"]):
            subprocess.run(["git", "-C", self.top, *words], check=True)
        self.assertEqual(self.faults(), [])

    def test_one_fault_is_reported_at_its_place(self):
        for name, old, new, place, word in (
                ("README.md", "#how-to-render-it", "#how-to-print-it", "README.md:3", "#how-to-print-it"),
                ("README.md", "See [", "See [it](../elsewhere/a.md) and [", "README.md:3", "outside"),
                ("docs/guide.md", "See docs", "As ../shared/notes says. See docs", "docs/guide.md:10", "outside"),
                ("README.md", "pbrt --spp 4 scene.pbrt  ", "pbrt --samples 4 scene.pbrt  ", "README.md:5",
                 "pbrt has no flag --samples"),
                ("README.md", "--metric relL2", "--measure relL2", "README.md:6", "imgtool has no flag --measure"),
                ("docs/guide.md", "    bvh,octree", "    bvh,octree --quickly", "docs/guide.md:6", "--quickly"),
                ("README.md", "imgtool diff", "imgtool nothing", "README.md:6", "nothing"),
                ("README.md", "docs/make --size 3", "docs/make --width 3", "README.md:8", "docs/make has no flag --width"),
                ("docs/figures.txt", "docs/make", "docs/draw", "docs/figures.txt:1", "docs/draw"),
                ("docs/guide.md", "See docs", "Short words. " * 20 + "See docs", "docs/guide.md:1", "words, budget 40"),
                ("docs/budgets.txt", "40 docs/guide.md\n", "", "docs/guide.md:1", "no line in docs/budgets.txt"),
                ("docs/changelog.md", "went", "went. " + "Short words. " * 6, "docs/changelog.md:1", "words, budget 20")):
            with self.subTest(new=new):
                before = (self.top / name).read_text()
                self.replace(name, old, new)
                self.expect(place, word)
                self.write(name, before)

    def test_dead_link(self):
        (self.top / "docs/guide.md").rename(self.top / "docs/other.md")
        self.assertTrue(any("README.md:3" in f and "docs/guide.md" in f for f in self.faults()))

    def test_mention_in_a_source(self):
        self.write("src/a.cpp", "// As docs/method.md says.\n")
        self.expect("src/a.cpp:1", "docs/method.md")

    def test_source_that_a_page_mentions(self):
        self.replace("docs/guide.md", "See docs", "It is in `src/a.cpp`. See docs")
        self.assertEqual(self.faults(), [])
        self.replace("docs/guide.md", "src/a.cpp", "src/b.cpp")
        self.expect("docs/guide.md:10", "src/b.cpp")

    def test_page_without_a_link_to_it(self):
        self.write("docs/lost.md", "# Lost\n")
        self.replace("docs/budgets.txt", "40 README.md", "40 README.md\n9 docs/lost.md")
        self.expect("docs/lost.md:1", "no page links here")

    def test_script_that_is_gone(self):
        self.replace("README.md", "docs/make --size 3", "docs/draw --size 3")
        self.assertTrue(any("no script docs/draw" in f for f in self.faults()))

    def test_figure_older_than_its_data(self):
        self.replace("docs/guide.md", "| 1 | 2 |", "| 1 | 3 |")
        self.expect("docs/figures.txt:1", "docs/chart.svg is older than its data")
        self.run_check("--stamp", "docs/chart.svg")
        self.assertEqual(self.faults(), [])

    def test_figure_older_than_the_program(self):
        self.replace("docs/figures.txt", "| docs/guide.md#how-to-render-it", "| VERSION docs/guide.md#how-to-render-it")
        for version in ("1.2.3", "1.3.0"):
            self.write("CMakeLists.txt", f"project(renderer VERSION {version} LANGUAGES CXX)\n")
            self.assertTrue(any("docs/chart.svg is older" in f for f in self.faults()))
            self.run_check("--stamp", "docs/chart.svg")
            self.assertFalse(any("docs/chart.svg" in f for f in self.faults()))

    def test_text_around_the_table_makes_no_figure_old(self):
        self.replace("docs/guide.md", "is none.", "is not one.")
        self.assertEqual(self.faults(), [])

    def test_figure_without_data(self):
        self.write("docs/figures.txt", "")
        self.expect("README.md:3", "has no line in docs/figures.txt")

    def test_prints_words(self):
        self.assertRegex(self.run_check("--only", "words").stdout, r"words: +\d+ of +40  docs/guide.md\n")

    def test_written_pages_and_blocks_do_not_count(self):
        self.replace("docs/guide.md", "See docs", "\n<!-- table -->\n" + "Short words. " * 20 + "\n<!-- end -->\n\nSee docs")
        self.assertEqual(self.faults(), [])
        self.replace("docs/guide.md", "See docs", "Nobody writes " + "short words " * 20 + "See docs")
        self.replace("docs/budgets.txt", "40 docs/guide.md", "0 docs/guide.md")
        self.assertEqual(self.faults(), [])

    def test_total_over_the_limit(self):
        self.replace("docs/budgets.txt", "40 docs/guide.md", "40000 docs/guide.md")
        self.replace("docs/guide.md", "See docs", "Short words. " * 15001 + "See docs")
        self.expect("docs/budgets.txt:1", "at most 30000")

    def test_banned_phrases(self):
        for phrase in ("nobody has it", "the same by\nitself", "each find", "its balls", "it is so much"):
            self.write("docs/guide.md", FILES["docs/guide.md"].replace("See docs", f"Here {phrase}. See docs"))
            self.expect("docs/guide.md:10", "is banned")
        self.write("docs/guide.md", FILES["docs/guide.md"].replace("| 1 |", "| so much |"))
        self.assertTrue(any("docs/guide.md:14" in f and "so much" in f for f in self.faults()))

    def test_banned_phrases_in_code_do_not_count(self):
        self.replace("docs/guide.md", "See docs", "The class `so much`.\n\n    so much\n\nIt finds light. See docs")
        self.assertEqual(self.faults(), [])

    def test_long_sentence(self):
        words = "and a [link](changelog.md) of `one word`\n" * 5
        self.replace("docs/guide.md", "See docs", f"\n\n- Short.\n- Words {words}here. See docs")
        self.replace("docs/budgets.txt", "40 docs/guide.md", "90 docs/guide.md")
        self.expect("docs/guide.md:13", "a sentence of 27 words")

    def test_sentences_end_at_items_and_stops(self):
        self.replace("docs/guide.md", "See docs", "\n\n- " + "ten words " * 5 + "\n- " + "ten words " * 9
                     + "end. `Then` " + "ten words " * 9 + "\n\nSee docs")
        self.replace("docs/budgets.txt", "40 docs/guide.md", "90 docs/guide.md")
        self.assertEqual(self.faults(), [])

    def test_versions_that_differ(self):
        self.write("CMakeLists.txt", "project(renderer VERSION 1.2.3 LANGUAGES CXX)\n")
        self.write("CITATION.cff", "version: 1.2.3\n")
        self.replace("README.md", "See [the", "Version 1.2.3. See [the")
        self.replace("docs/changelog.md", "- docs", "## Unreleased\n\n## 1.2.3\n\n- docs")
        self.assertEqual(self.faults(), [])
        self.replace("CITATION.cff", "1.2.3", "1.2.2")
        self.expect("CITATION.cff:1", "names version 1.2.2, CMakeLists.txt 1.2.3")

    def test_missing_programs_are_reported(self):
        shutil.rmtree(self.programs / "pbrt")
        self.assertIn("not checked: flags of pbrt", self.run_check().stdout)


if __name__ == "__main__":
    unittest.main()
