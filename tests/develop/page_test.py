#!/usr/bin/env python3
"""The pages of docs/develop that add something: their code is the code that the tests compile, their commands work, and
their table of traits is that of the header."""
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
PAGES = {"adding-a-light-sampler.md": "nearest", "adding-an-integrator.md": "directlight"}


def text_of(page):
    return (TOP / "docs/develop" / page).read_text()


def sources(folder):
    return {path.relative_to(folder): path.read_text() for path in folder.rglob("*") if path.suffix in (".h", ".cpp")}


class Pages(unittest.TestCase):
    def test_code_is_that_of_the_tests(self):
        for page, folder in PAGES.items():
            for file, code in sources(TOP / "tests/develop" / folder).items():
                self.assertIn(f"```cpp\n{code.rstrip()}\n```", text_of(page), f"{page} differs from {folder}/{file}")

    def test_commands_add_the_files_to_the_build_and_to_the_layers(self):
        for page in PAGES:
            with self.subTest(page), tempfile.TemporaryDirectory() as folder:
                copy = Path(folder)
                for name in (".ci", "src", "docs/develop", "tests/develop"):
                    shutil.copytree(TOP / name, copy / name)
                shutil.copy(TOP / "CMakeLists.txt", copy)
                for command in self.commands(page):
                    edited = copy / command.split()[-1] if command.startswith("sed -i ") else None
                    before = edited and edited.read_text()
                    subprocess.run(command, shell=True, cwd=copy, check=True)
                    if edited:
                        self.assertNotEqual(edited.read_text(), before, f"{command} changes nothing")
                layers = subprocess.run(["python3", ".ci/check_layers.py"], cwd=copy, capture_output=True, text=True)
                self.assertEqual(layers.returncode, 0, layers.stdout)
                added = sources(copy / "src").keys() - sources(TOP / "src").keys()
                self.assertTrue(added)
                for file in added:
                    if file.suffix == ".cpp":
                        self.assertIn(file.name, (copy / "src" / file.parent / "CMakeLists.txt").read_text())
                    if file.parts[0] == "ext":
                        self.assertRegex((copy / "CMakeLists.txt").read_text(), rf"foreach\(folder .*\b{file.parts[1]}\b")

    def commands(self, page):
        """Those of the first shell block, except of the build itself."""
        block = re.search(r"^```sh\n(.*?)\n```$", text_of(page), re.M | re.S)[1].splitlines()
        commands = [line for line in block if not line.startswith("cmake ")]
        self.assertLess(len(commands), len(block))
        return commands

    def test_traits_are_those_of_the_header(self):
        header = (TOP / "src/pbrt/build/integrator_builder.h").read_text()
        members = re.findall(r"bool (\w+) = ", re.search(r"struct IntegratorTraits \{(.*?)\n\};", header, re.S)[1])
        table = re.search(r"\| trait \| effect \|\n\|---\|---\|\n((?:\|.*\n)+)", text_of("adding-an-integrator.md"))[1]
        self.assertGreater(len(members), 5)
        self.assertEqual(re.findall(r"^\| `(\w+)` \|", table, re.M), members)


if __name__ == "__main__":
    unittest.main()
