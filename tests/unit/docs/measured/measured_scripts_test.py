#!/usr/bin/python3
"""Tests docs/measured: its statistics on experiments whose truth is known, its scripts with a stand-in for lightlab."""
import csv
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[3]
MEASURED = TOP / "docs/measured"
sys.path.insert(0, str(MEASURED))
import experiments  # noqa: E402
from experiments import data  # noqa: E402


def load(name):
    loader = importlib.machinery.SourceFileLoader(f"measured_{name}", str(MEASURED / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


measured = load("run")
adaptive = load("adaptive")


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.top = pathlib.Path(folder.name)

    def experiment(self, errors, noise=0.0, biased=()):
        """errors: by label, one per seed. The first sampler makes the reference of all."""
        def sampler(label, values):
            mean = sum(values) / len(values)
            spread = (sum((v - mean) ** 2 for v in values) / max(1, len(values) - 1)) ** 0.5
            figure = {"mean": mean, "standardError": spread / len(values) ** 0.5}
            runs = [{"rounds": [{"metrics": {"relL2": v, "relL2Trimmed": v / 2}}]} for v in values]
            trimmed = {k: v / 2 for k, v in figure.items()}
            return {"label": label, "isOracle": label.startswith("oracle"), "reference": 0, "runs": runs,
                    "summary": {"metrics": {"relL2": figure, "relL2Trimmed": trimmed},
                                "bias": {"verdict": "biased" if label in biased else "clean"}}}
        file = self.top / "results.json"
        first = next(iter(errors))
        file.write_text(json.dumps({"seeds": len(errors[first]), "references": [{"noise": noise, "sampler": first}],
                                    "samplers": [sampler(*e) for e in errors.items()]}))
        return experiments.Experiment(file)


class Statistics(Folder):
    def test_students_tail_is_that_of_the_tables(self):
        for t, dof, p in ((6.314, 1, 0.05), (2.015, 5, 0.05), (3.365, 5, 0.01), (1.697, 30, 0.05), (0, 7, 0.5),
                          (-2.015, 5, 0.95)):
            self.assertAlmostEqual(measured.student_tail(t, dof), p, delta=2e-4)

    def test_noise_of_the_reference_is_taken_off_unless_it_is_most_of_the_figure(self):
        c = self.experiment({"bvh": [0.1, 0.1], "octree": [0.015, 0.015]}, noise=0.01)
        self.assertAlmostEqual(c.error("bvh").mean, 0.09)
        self.assertAlmostEqual(c.error("octree").mean, 0.015)
        self.assertAlmostEqual(c.error("bvh", "relL2Trimmed").mean, 0.045)

    def test_from_five_seeds_on_runs_are_compared_seed_by_seed(self):
        common = [1.0, 3.0, 2.0, 5.0, 4.0]
        c = self.experiment({"bvh": common, "octree": [0.5 * v for v in common]})
        self.assertAlmostEqual(c.ratio("octree", "bvh").mean, 0.5)
        self.assertAlmostEqual(c.ratio("octree", "bvh").error, 0)
        few = self.experiment({"bvh": common[:4], "octree": [0.5 * v for v in common[:4]]})
        self.assertGreater(few.ratio("octree", "bvh").error, 0.2)

    def test_ratios_of_adaptive_sampling_are_of_pairs(self):
        same = adaptive.ratio([1, 2, 4], [1, 2, 4], 0.5)
        self.assertEqual((same.mean, same.error), (1, 0))
        twice = adaptive.ratio([2.5, 3.5], [1, 2], 0.5)
        self.assertAlmostEqual(twice.mean, 2.5)
        self.assertAlmostEqual(twice.error, 0.75)

    def test_maps_of_samples_share_one_scale(self):
        import numpy
        from PIL import Image
        images = [Image.new("RGB", (adaptive.PANEL_WIDTH, h)) for h in (40, 60)]
        counts = [numpy.full((i.height, i.width), n) for i, n in zip(images, (16., 128.))]
        picture = adaptive.panels(images, counts, ["a", "b"])
        first, line = adaptive.sheet.LINE, adaptive.sheet.LINE + adaptive.sheet.GAP
        y = 60 + line + first + 20
        colors = [picture.getpixel((x, y)) for x in (10, adaptive.PANEL_WIDTH + adaptive.sheet.GAP + 10)]
        self.assertEqual(colors, [(68, 1, 84), (253, 231, 36)])  # the ends of viridis

    def test_verdicts(self):
        def verdict(own, other):
            return measured.verdict(self.experiment({"bvh": other, "octree": own}), "bvh")
        steady = [1.00, 1.02, 0.98, 1.01, 0.99, 1.0]
        self.assertEqual(verdict([0.8 * v for v in steady], steady), "better")
        self.assertEqual(verdict([1.01, 1.01, 1.0, 1.02, 0.98, 1.0], steady), "not worse")
        self.assertEqual(verdict([1.3 * v for v in steady], steady), "worse")
        self.assertEqual(verdict([0.2, 3.0, 0.5, 2.0, 0.4, 0.1], steady), "open")
        # The pictures are the same, so there is no noise at all, and one is not worse by 3 %.
        self.assertEqual(verdict(steady, steady), "not worse")
        # With two seeds only large differences are certain.
        self.assertEqual(verdict([1.0, 1.02], [1.1, 0.98]), "open")
        self.assertEqual(verdict([0.10, 0.101], [1.0, 1.02]), "better")

    def test_equal_samplers_are_called_better_at_most_at_the_level(self):
        numbers = random.Random(1)
        found = {seeds: 0 for seeds in (3, 6)}
        rounds = 400
        for seeds in found:
            for _ in range(rounds):
                shared = [numbers.gauss(0, 0.3) for _ in range(seeds)]
                def draw():
                    return [2.718 ** (s + numbers.gauss(0, 0.2)) for s in shared]
                found[seeds] += measured.verdict(self.experiment({"bvh": draw(), "octree": draw()}), "bvh") == "better"
        for seeds, alarms in found.items():
            # The mean is 20 and the standard deviation 4.4; treating shared noise as independent makes fewer alarms.
            self.assertLess(alarms, 36, seeds)
        self.assertGreater(found[6], 6)

    def test_the_best_other_is_no_oracle_and_not_biased(self):
        c = self.experiment({"bvh": [0.5], "uniform": [0.2], "oracle:samples=8": [0.01], "octree": [0.1]},
                          biased=["uniform"])
        self.assertEqual(c.best_other(), "bvh")
        self.assertIsNone(self.experiment({"octree": [0.1], "oracle": [0.1]}).best_other())

    def test_gap_closed(self):
        def gap(own, other, oracle):
            c = self.experiment({"bvh": [other] * 5, "octree": [own] * 5, "oracle": [oracle] * 5})
            return measured.gap_closed(c, "oracle", "relL2")
        self.assertAlmostEqual(gap(0.3, 1.1, 0.1).mean, 0.8)
        self.assertAlmostEqual(gap(0.05, 1.1, 0.1).mean, 1.05)
        self.assertIsNone(gap(0.1, 0.109, 0.1))

    def test_error_of_the_gap_is_that_of_independent_errors(self):
        # (b - o) / (b - l), with errors by linear propagation; three seeds are too few to compare in pairs.
        errors = {"bvh": [1.0, 1.1, 0.9], "octree": [0.30, 0.33, 0.27], "oracle": [0.1, 0.1, 0.1]}
        gap = measured.gap_closed(self.experiment(errors), "oracle", "relL2")
        b, o, least, sb, so = 1.0, 0.3, 0.1, 0.1 / 3 ** 0.5, 0.03 / 3 ** 0.5
        expected = ((sb * (o - least) / (b - least) ** 2) ** 2 + (so / (b - least)) ** 2) ** 0.5
        self.assertAlmostEqual(gap.error, expected)


class Scripts(Folder):
    def run_script(self, script, *arguments, **environment):
        self.log, self.csv = self.top / "log", self.top / "table.csv"
        command = [str(MEASURED / script), "--lightlab", str(HERE.parent / "stand_in_lightlab.py"), "--out",
                   str(self.top / "out"), "--csv", str(self.csv), *arguments]
        settings = {"PBRT_REAL_SCENES": str(self.top / "absent"), "STAND_IN_LOG": str(self.log), **environment}
        return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **settings})

    def commands(self):
        return self.log.read_text().splitlines() if self.log.exists() else []

    def rows(self):
        return data.read(self.csv)

    def row(self, **wanted):
        found = [r for r in self.rows() if wanted.items() <= r.items()]
        self.assertEqual(len(found), 1, wanted)
        return found[0]

    def test_run_compares_octree_with_the_best_other(self):
        done = self.run_script("run", "--only", "hotel,lamp", "--samplers", "bvh;octree:model=paper;octree",
                               "--equal-samples", "16", "--seeds", "5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("*** SKIPPED: lamp is not there", done.stdout)
        self.assertEqual(len(self.commands()), 1)
        self.assertIn("--samplers bvh,octree:model=paper,octree,oracle:samples=8", self.commands()[0])
        row = self.row(scene="hotel", sampler="octree")
        # The stand-in's errors are 0.3, 0.1, 0.05 and 0.5; 0.001 is the reference's noise.
        self.assertEqual(row["relL2"], "0.049")
        self.assertEqual((row["best_other"], f"{float(row['over_best']):.2f}"), ("octree:model=paper", "0.49"))
        self.assertEqual((f"{float(row['over_best_trimmed']):.2f}", row["verdict"]), ("0.49", "better"))
        self.assertEqual((row["bias"], row["gap_closed"], row["oracle_light_samples"]), ("none detected", "", "8"))
        self.assertEqual(f"{float(row['over_bvh']):.2f}", "0.16")
        self.assertEqual(self.row(sampler="bvh")["over_bvh"], "1")
        text = self.csv.read_text()
        self.assertIn("# commit: abc1234\n# machine: Example CPU\n", text)
        self.assertIn("--equal-samples 16 --seeds 5", text)
        self.assertIn("\n# seeds: 5\n", text)

    def test_run_names_what_is_biased_and_does_not_compare_with_it(self):
        self.run_script("run", "--only", "hotel", "--samplers", "bvh;octree:model=paper;octree", "--time", "1",
                        STAND_IN_BIASED="octree:model=paper")
        self.assertEqual(self.row(sampler="octree:model=paper")["bias"], "biased")
        self.assertEqual(self.row(sampler="octree")["best_other"], "bvh")

    def test_ablation_has_a_row_a_scene_and_their_mean(self):
        done = self.run_script("ablation", "--only", "hotel,slit", "--variants", "model=paper")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([r["scene"] for r in self.rows()], ["hotel", "slit", "geometric mean"])
        # 0.1 over 0.05, without a noise of 0.001.
        self.assertEqual({f"{float(r['relL2']):.2f}" for r in self.rows()}, {"2.02"})

    def test_granularity_compares_with_the_coarsest_tree(self):
        done = self.run_script("granularity", "--only", "hotel", "--leaves", "512,32768", "--prepassspp", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(f"{float(self.row(parameter='leaves=32768')['over_coarsest']):.2f}", "0.80")

    def test_bias_doubles_the_runs_until_all_verdicts_are_there(self):
        done = self.run_script("bias", "--only", "hotel", "--direct", STAND_IN_CLEAN_FROM="40")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([c.split("--seeds ")[1].split()[0] for c in self.commands()], ["12", "24", "48"])
        self.assertTrue(all("--direct" in c and "--spp 256" in c and "--divisor 8" in c for c in self.commands()))
        self.assertEqual([list(r.values())[2:] for r in self.rows()], [["48", "none detected", "4.2", "0.7"]] * 3)

    def test_bias_ends_at_most_seeds_and_states_the_detectable_bias(self):
        self.run_script("bias", "--only", "hotel", "--most-seeds", "24", STAND_IN_CLEAN_FROM="40",
                        STAND_IN_BIASED="bvh")
        self.assertEqual(len(self.commands()), 2)
        self.assertEqual([list(r.values())[2:] for r in self.rows()],
                         [["24", "biased", "", ""]] + [["24", "unknown", "8.3", "5"]] * 2)

    def test_a_failed_experiment_is_reported(self):
        for script in ("bias", "run"):
            done = self.run_script(script, "--only", "hotel,slit", STAND_IN_FAIL="hotel")
            self.assertEqual((done.returncode, {r["scene"] for r in self.rows()}), (1, {"slit"}))
            self.assertIn("*** hotel: lightlab ended with status 1 ***", done.stdout)

    def test_tables_only_measures_nothing(self):
        done = self.run_script("run", "--tables-only", "--only", "hotel")
        self.assertEqual((done.returncode, self.commands()), (1, []))
        self.assertIn("SKIPPED: no experiment of hotel", done.stdout)

    def test_tables_only_skips_experiments_without_a_sampler(self):
        self.run_script("run", "--only", "hotel", "--samplers", "octree;bvh")
        done = self.run_script("run", "--tables-only", "--only", "hotel", "--samplers", "octree;bvh;neepp")
        self.assertEqual((done.returncode, done.stderr), (1, ""))
        self.assertIn("neepp", done.stdout)

    def test_octree_must_be_among_the_samplers(self):
        done = self.run_script("run", "--samplers", "bvh;uniform")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "octree .*compared")


class Results(Folder):
    """docs/results/make on the CSV files of the repository, and those files themselves."""

    def test_every_csv_file_has_its_command(self):
        for file in [*(TOP / "docs/results").glob("*.csv"), *(TOP / "docs/paper/results").glob("*.csv")]:
            known = {line.partition(":")[0] for line in file.read_text().splitlines() if line.startswith("# ")}
            self.assertLessEqual({"# commit", "# machine", "# date", "# command"}, known, file)
            if file.parent.name == "results" and file.parents[1].name == "docs":  # the paper's files name them by scene
                self.assertIn("# seeds", known, file)
            self.assertTrue(data.read(file), file)

    def test_kept_files_have_the_heads_that_the_scripts_write(self):
        for name in ("direct", "full", "oracle-direct", "oracle-full"):
            self.assertEqual(list(data.read(TOP / f"docs/results/{name}.csv")[0]), measured.HEAD, name)

    def test_make_draws_charts_and_writes_the_table(self):
        done = subprocess.run([str(TOP / "docs/results/make"), "--out", str(self.top), "--only", "direct"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("slit", (self.top / "direct.svg").read_text())
        with open(TOP / "docs/results/direct.csv") as file:
            rows = csv.DictReader(line for line in file if not line.startswith("#"))
            hotel = next(row for row in rows if (row["scene"], row["sampler"]) == ("hotel", "octree"))
        self.assertIn(f"| hotel | {float(hotel['over_bvh']):.2f} |", (self.top / "summary.md").read_text())


if __name__ == "__main__":
    unittest.main()
