#!/usr/bin/python3
"""Tests the scripts of docs/paper with a stand-in for lightlab whose errors are known."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[3]
sys.path.insert(0, str(TOP / "docs/paper"))
import paper_numbers as paper  # noqa: E402

OWN_SCENES = ["three-lights", "lamp-like", "hotel", "white-room", "ajar"]


class PaperScripts(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.top = pathlib.Path(self.folder.name)
        self.out, self.kept, self.log = self.top / "out", self.top / "kept", self.top / "log"

    def run_script(self, *arguments, script="run", real="absent", **environment):
        command = [str(TOP / "docs/paper" / script), "--lightlab", str(HERE.parent / "stand_in_lightlab.py"), "--out",
                   str(self.out), "--results", str(self.kept), *arguments]
        settings = {"PBRT_REAL_SCENES": str(self.top / real), "STAND_IN_LOG": str(self.log), **environment}
        return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **settings})

    def commands(self):
        return self.log.read_text().splitlines() if self.log.exists() else []

    def page(self, name, folder=None):
        return ((folder or self.out) / f"{name}.md").read_text()

    def row(self, page, first, second=""):
        """The cells of the first table row that begins with the given text."""
        for line in page.splitlines():
            cells = [c.strip() for c in line.strip("|").split("|")]
            if len(cells) > 1 and cells[0] == first and cells[1].startswith(second):
                return cells
        self.fail(f"no row {first} {second} in:\n{page}")

    def test_all_pieces_with_the_papers_numbers_beside_ours(self):
        done = self.run_script("--quick")
        self.assertEqual(done.returncode, 0, done.stderr)
        fig3 = self.page("fig3").split("## hotel")[1].split("## white-room")[0]
        ours = self.row(fig3, "`octree:model=paper`")
        self.assertEqual(ours[1:6], ["Ours", "0.0038", "0.100 ± 0.010", "0.100", "0.25"])
        self.assertEqual(ours[6:11], ["1024", "64", "242.9", "1.00", "clean"])
        self.assertEqual(self.row(fig3, "`spatial`")[9], "3.00 (over)")
        self.assertEqual(self.row(fig3, "`bvh`")[1:3], ["not in the paper", "–"])
        self.assertEqual(self.row(fig3, "Ours below NEE++")[2], "yes (7.0 times)")
        self.assertIn("Why they differ: the paper's Hotel on an AMD Ryzen 3900X", fig3)
        table1 = self.page("table1")
        self.assertEqual(self.row(table1, "Hotel (paper)"),
                         ["Hotel (paper)", "Ours", "1024", "0.74", "1.78", "240.4", "242.9", "1.04 %"])
        self.assertEqual(self.row(table1, "hotel (here)")[2:], ["64", "0.020", "0.030", "0.950", "1.00", "5 %"])
        table2 = self.page("table2").split("## hotel")[1]
        self.assertEqual(self.row(table2, "32768"), ["32768", "38914", "4321", "0.0037", "0.120 ± 0.010", "0.120",
                                                     "0.974", "1.20", "2801", "50.0", "2.99", "0.050"])
        self.assertIn("into 77 cells", table2)
        fig5 = self.page("fig5")
        self.assertEqual(self.row(fig5, "`spatial`")[2:7], ["0.104", "0.410 ± 0.010", "0.410", "0.981", "1.02"])
        fig4 = self.page("fig4")
        self.assertEqual(self.row(fig4, "`uniform+mesh`")[2:], ["12.8", "6.40", "3.20", "1.60", "0.800", "0.400"])
        self.assertIn("Ours is 6 of 6 times below Uniform", fig4)
        for title in ("## Fig. 1", "## Fig. 3", "## Fig. 4", "## Table 1", "## Table 2", "## Fig. 5"):
            self.assertIn("\n" + title, self.page("README"))

    def test_a_difference_below_two_standard_errors_is_noise(self):
        self.run_script("--only", "fig3")
        page = self.page("fig3").split("## white-room")[1]
        self.assertTrue(self.row(page, "Uniform below Spatial")[2].startswith("within noise"))
        self.assertTrue(self.row(page, "Uniform below NEE++")[2].startswith("yes"))

    def test_absent_scenes_are_skipped_loudly(self):
        done = self.run_script()
        for name, page in (("lamp", "fig3"), ("veach-ajar", "fig5")):
            self.assertIn(f"SKIPPED: {self.top}/absent/{name}/{name}.pbrt", done.stderr)
            self.assertIn(f"SKIPPED: {self.top}/absent/{name}/{name}.pbrt", self.page(page))
        self.assertEqual(sum("/absent/" in c for c in self.commands()), 0)

    def test_present_real_scenes_are_run(self):
        for name in ("lamp", "veach-ajar"):
            (self.top / "real" / name).mkdir(parents=True)
            (self.top / "real" / name / f"{name}.pbrt").touch()
        done = self.run_script(real="real")
        self.assertNotIn("SKIPPED", done.stderr)
        self.assertEqual(sum("/real/" in c for c in self.commands()), 3)

    def test_efforts(self):
        self.run_script("--full", "--scale", "0.5", "--only", "fig1,table2")
        fig1, table2 = self.commands()[0], self.commands()[-1]
        self.assertIn("--time 10 --seeds 5 --divisor 1 --reference-spp 2048", fig1)
        self.assertIn("--direct", fig1)
        self.assertIn("octree:model=paper,leaves=512,octree:model=paper,octree:model=paper,leaves=32768,octree "
                      "--spp 64", table2)
        self.assertNotIn("--direct", table2)

    def test_shared_campaigns_run_once_and_a_second_run_asks_for_the_same(self):
        self.run_script()
        first = self.commands()
        self.assertEqual(len(first), 1 + 3 + 3 + 1)  # fig1, fig3, table2, fig5; fig4 and table1 share fig3's
        self.run_script()
        self.assertEqual(self.commands(), first * 2)

    def test_a_failed_campaign_is_told_and_not_kept(self):
        done = self.run_script("--only", "fig1,table2", "--keep", STAND_IN_FAIL="table2-hotel")
        self.assertEqual(done.returncode, 1)
        self.assertIn("table2-hotel: FAILED", done.stderr)
        self.assertIn("FAILED", self.page("table2"))
        self.assertIn("0.0081", self.page("table2"))  # the other scenes are there
        self.assertTrue((self.kept / "fig1.md").exists())
        self.assertFalse((self.kept / "table2.md").exists())

    def test_an_interrupt_reaches_lightlab_and_ends_the_run(self):
        waits = self.top / "waits"
        command = [str(TOP / "docs/paper/run"), "--lightlab", str(HERE.parent / "stand_in_lightlab.py"), "--out",
                   str(self.out)]
        process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                                   env={**os.environ, "STAND_IN_LOG": str(self.log), "STAND_IN_WAIT": str(waits)})
        for _ in range(500):
            if waits.exists():
                break
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        self.assertIn("Interrupted. The same command goes on from there.", process.communicate(timeout=20)[1])
        self.assertEqual((process.returncode, waits.read_text()), (130, "ended in good order"))
        self.assertEqual(len(self.commands()), 1)

    def test_biased_samplers_are_named(self):
        self.run_script("--only", "fig1", STAND_IN_BIASED="octree:model=paper")
        self.assertIn("**Biased by the lab's check: octree:model=paper.**", self.page("fig1"))
        self.assertIn("BIASED", self.row(self.page("fig1"), "Ours below Uniform")[2])

    def test_kept_pages_link_only_to_kept_files(self):
        self.run_script("--only", "fig4", "--keep")
        self.assertIn("report.html", self.page("fig4"))
        page = self.page("fig4", self.kept)
        self.assertNotIn("report.html", page)
        self.assertIn("](fig3-hotel/chart-error-time.svg)", page)
        self.assertTrue((self.kept / "fig3-hotel/chart-error-time.svg").is_file())

    def test_tables_only_renders_nothing(self):
        done = self.run_script("--tables-only", "--only", "fig5")
        self.assertEqual((done.returncode, self.commands()), (0, []))
        self.assertIn("NOT RUN", self.page("fig5"))
        self.run_script("--only", "fig5")
        self.run_script("--tables-only", "--only", "fig5")
        self.assertIn("0.400 ± 0.010", self.page("fig5"))
        self.assertEqual(len(self.commands()), 1)

    def test_every_script_runs_alone(self):
        for name in ("fig1", "fig3", "fig4", "fig5", "table1", "table2"):
            done = self.run_script("--tables-only", script=f"{name}.py")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((self.out / f"{name}.md").is_file())

    def test_unknown_pieces_are_refused_with_the_choices(self):
        done = self.run_script("--only", "fig2")
        self.assertEqual(done.returncode, 2)
        self.assertIn("choose from fig1, fig3, fig4, table1, table2, fig5", done.stderr)

    def test_own_scenes_exist(self):
        for name in OWN_SCENES:
            self.assertTrue((TOP / "scenes" / name / f"{name}.pbrt").is_file(), name)


class PaperNumbers(unittest.TestCase):
    def test_tables_are_those_of_the_text(self):
        file = TOP.parent / "shared/paper.txt"
        if not file.is_file():
            self.skipTest(f"SKIPPED: {file} is absent")
        rows = [line.split("\t") for line in file.read_text(encoding="utf-8").splitlines()]
        for scene, b in paper.TABLE1.items():
            self.assertIn([scene, str(b.spp), f"{b.sampleGeneration:.2f}", f"{b.octreeBuilding:.2f}",
                           f"{b.rendering:.1f}", f"{b.total:.1f}"], rows)
        for scene, of_t in paper.TABLE2.items():
            for t, g in of_t.items():
                self.assertIn([scene if t == 512 else "", str(t), str(g.leaves), f"{g.relL2:.4f}", str(g.kilobytes),
                               f"{g.seconds:.2f}"], rows)
        text = " ".join(file.read_text(encoding="utf-8").split())
        for value in (*paper.FIG5.values(), *(f"{100 * s:.3f}%" for s in paper.OVERHEAD_SHARE)):
            self.assertIn(str(value), text)
        self.assertIn("in twenty secs", text)


if __name__ == "__main__":
    unittest.main()
