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
sys.path[:0] = [str(TOP / "docs/paper"), str(TOP / "docs/results")]
import data  # noqa: E402
import paper_numbers as paper  # noqa: E402

OWN_SCENES = ["three-lights", "lamp-like", "hotel", "white-room", "ajar"]


class PaperScripts(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.top = pathlib.Path(self.folder.name)
        self.out, self.kept, self.log = self.top / "out", self.top / "kept", self.top / "log"

    def run_script(self, *arguments, real="absent", **environment):
        command = [str(TOP / "docs/paper/run"), "--lightlab", str(HERE.parent / "stand_in_lightlab.py"), "--out",
                   str(self.out), "--results", str(self.kept), *arguments]
        settings = {"PBRT_REAL_SCENES": str(self.top / real), "STAND_IN_LOG": str(self.log), **environment}
        return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **settings})

    def commands(self):
        return self.log.read_text().splitlines() if self.log.exists() else []

    def rows(self, name, folder=None, **wanted):
        """Rows of a CSV file whose cells are these."""
        return [r for r in data.read((folder or self.out) / f"{name}.csv") if wanted.items() <= r.items()]

    def row(self, name, **wanted):
        found = self.rows(name, **wanted)
        self.assertEqual(len(found), 1, (name, wanted))
        return found[0]

    def expect(self, row, **cells):
        self.assertEqual({k: row[k] for k in cells}, cells)

    def test_all_pieces_with_the_papers_numbers_beside_ours(self):
        done = self.run_script("--quick")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.expect(self.row("fig3", scene="hotel", sampler="octree:model=paper"), paper_name="Ours", paper_relL2="0.0038",
                    relL2Abs="0.1", standard_error="0.01", trimmed="0.1", over_uniform="0.25", paper_samples="1024",
                    samples="64", paper_seconds="242.9", seconds="1", over_budget="0", bias="none detected")
        self.expect(self.row("fig3", scene="hotel", sampler="spatial"), seconds="3", over_budget="1")
        self.expect(self.row("fig3", scene="hotel", sampler="bvh"), paper_name="", paper_relL2="")
        self.expect(self.row("fig3-claims", scene="hotel", claim="Ours below NEE++"), answer="yes", times="7")
        self.expect(self.row("fig3-claims", scene="hotel", claim="Ours below NEE++ (7 times)"), answer="yes")
        self.expect(self.row("table1", scene="hotel", sampler="paper"), samples="1024", sample_generation_seconds="0.74",
                    octree_building_seconds="1.78", total_seconds="242.9", overhead_share="0.01037")
        self.expect(self.row("table1", scene="hotel", sampler="octree:model=paper"), samples="64",
                    sample_generation_seconds="0.02", rendering_seconds="0.95", overhead_share="0.05")
        self.expect(self.row("table2", scene="hotel", T="32768"), paper_leaves="38914", leaves="4321",
                    paper_relL2="0.0037", relL2Abs="0.12", paper_over_4096="0.9737", over_4096="1.2",
                    paper_kilobytes="2801", kilobytes="50", paper_seconds="2.99", seconds="0.05")
        self.expect(self.row("table2", scene="hotel", sampler="octree"), T="", leaves_before_pruning="77")
        self.expect(self.row("fig5", scene="ajar", sampler="spatial"), paper_relL2="0.104", relL2Abs="0.41",
                    paper_over_uniform="0.9811", over_uniform="1.025")
        curve = self.rows("fig4", scene="hotel", sampler="uniform+mesh")
        self.assertEqual([r["relL2Abs"] for r in curve], ["12.8", "6.4", "3.2", "1.6", "0.8", "0.4"])
        self.assertIn("# hotel: equal time", (self.out / "fig3.csv").read_text())

    def test_a_difference_below_two_standard_errors_is_noise(self):
        self.run_script("--only", "fig3")
        self.expect(self.row("fig3-claims", scene="white-room", claim="Uniform below Spatial"), answer="within noise")
        self.expect(self.row("fig3-claims", scene="white-room", claim="Uniform below NEE++"), answer="yes")

    def test_absent_scenes_are_skipped_loudly(self):
        done = self.run_script()
        for name, piece in (("lamp", "fig3"), ("veach-ajar", "fig5")):
            message = f"SKIPPED: {self.top}/absent/{name}/{name}.pbrt"
            self.assertIn(message, done.stderr)
            self.assertIn(f"# {name}: {message}", (self.out / f"{piece}.csv").read_text())
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

    def test_shared_experiments_run_once_and_a_second_run_has_the_same_commands(self):
        self.run_script()
        first = self.commands()
        self.assertEqual(len(first), 1 + 3 + 3 + 1)  # fig1, fig3, table2, fig5; fig4 and table1 share fig3's
        self.run_script()
        self.assertEqual(self.commands(), first * 2)

    def test_a_failed_experiment_is_reported_and_not_kept(self):
        done = self.run_script("--only", "fig1,table2", "--keep", STAND_IN_FAIL="table2-hotel")
        self.assertEqual(done.returncode, 1)
        self.assertIn("table2-hotel: FAILED", done.stderr)
        self.assertIn("# hotel: FAILED", (self.out / "table2.csv").read_text())
        self.assertEqual(len(self.rows("table2", scene="white-room")), 4)
        self.assertTrue((self.kept / "fig1.csv").exists())
        self.assertFalse((self.kept / "table2.csv").exists())

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
        self.assertIn("Interrupted. Rerun the command to resume.", process.communicate(timeout=20)[1])
        self.assertEqual((process.returncode, waits.read_text()), (130, "ended in good order"))
        self.assertEqual(len(self.commands()), 1)

    def test_biased_samplers_are_named(self):
        self.run_script("--only", "fig1", STAND_IN_BIASED="octree:model=paper")
        self.expect(self.row("fig1", sampler="octree:model=paper"), bias="biased")
        self.expect(self.row("fig1-claims", claim="Ours below Uniform"), biased="octree:model=paper")

    def test_tables_only_renders_nothing(self):
        done = self.run_script("--tables-only", "--only", "fig5")
        self.assertEqual((done.returncode, self.commands()), (0, []))
        self.assertIn("NOT RUN", (self.out / "fig5.csv").read_text())
        self.run_script("--only", "fig5")
        self.run_script("--tables-only", "--only", "fig5")
        self.expect(self.row("fig5", scene="ajar", sampler="uniform+mesh"), relL2Abs="0.4", standard_error="0.01")
        self.assertEqual(len(self.commands()), 1)

    def test_unknown_pieces_are_errors_that_list_the_choices(self):
        done = self.run_script("--only", "fig2")
        self.assertEqual(done.returncode, 2)
        self.assertIn("choose from fig1, fig3, fig4, table1, table2, fig5", done.stderr)

    def test_own_scenes_exist(self):
        for name in OWN_SCENES:
            self.assertTrue((TOP / "scenes" / name / f"{name}.pbrt").is_file(), name)

    def test_kept_files_have_the_heads_that_the_script_writes(self):
        import pieces
        for _, files in pieces.PIECES.values():
            for name, (head, _) in files.items():
                file = TOP / f"docs/paper/results/{name}.csv"
                lines = [line for line in file.read_text().splitlines() if not line.startswith("# ")]
                self.assertEqual(lines[0].split(","), head, file)


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
