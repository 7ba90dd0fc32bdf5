#!/usr/bin/python3
"""Tests docs/measured: its statistics on campaigns whose truth is known, its scripts with a stand-in for lightlab."""
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
import tables  # noqa: E402


def load(name):
    loader = importlib.machinery.SourceFileLoader(f"measured_{name}", str(MEASURED / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


measured = load("run")


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.top = pathlib.Path(folder.name)

    def campaign(self, errors, noise=0.0, biased=()):
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
        return tables.Campaign(file)


class Statistics(Folder):
    def test_students_tail_is_that_of_the_tables(self):
        for t, dof, p in ((6.314, 1, 0.05), (2.015, 5, 0.05), (3.365, 5, 0.01), (1.697, 30, 0.05), (0, 7, 0.5),
                          (-2.015, 5, 0.95)):
            self.assertAlmostEqual(measured.student_tail(t, dof), p, delta=2e-4)

    def test_noise_of_the_reference_is_taken_off_unless_it_is_most_of_the_figure(self):
        c = self.campaign({"bvh": [0.1, 0.1], "octree": [0.015, 0.015]}, noise=0.01)
        self.assertAlmostEqual(c.error("bvh").mean, 0.09)
        self.assertAlmostEqual(c.error("octree").mean, 0.015)
        self.assertAlmostEqual(c.error("bvh", "relL2Trimmed").mean, 0.045)

    def test_from_five_seeds_on_runs_are_compared_seed_by_seed(self):
        common = [1.0, 3.0, 2.0, 5.0, 4.0]
        c = self.campaign({"bvh": common, "octree": [0.5 * v for v in common]})
        self.assertAlmostEqual(c.ratio("octree", "bvh").mean, 0.5)
        self.assertAlmostEqual(c.ratio("octree", "bvh").error, 0)
        few = self.campaign({"bvh": common[:4], "octree": [0.5 * v for v in common[:4]]})
        self.assertGreater(few.ratio("octree", "bvh").error, 0.2)

    def test_verdicts(self):
        def verdict(own, other):
            return measured.verdict(self.campaign({"bvh": other, "octree": own}), "bvh")
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

    def test_equal_samplers_are_called_better_as_rarely_as_the_level_says(self):
        numbers = random.Random(1)
        found = {seeds: 0 for seeds in (3, 6)}
        rounds = 400
        for seeds in found:
            for _ in range(rounds):
                shared = [numbers.gauss(0, 0.3) for _ in range(seeds)]
                def draw():
                    return [2.718 ** (s + numbers.gauss(0, 0.2)) for s in shared]
                found[seeds] += measured.verdict(self.campaign({"bvh": draw(), "octree": draw()}), "bvh") == "better"
        for seeds, alarms in found.items():
            # The mean is 20 and the standard deviation 4.4; treating shared noise as independent makes fewer alarms.
            self.assertLess(alarms, 36, seeds)
        self.assertGreater(found[6], 6)

    def test_the_best_other_is_no_oracle_and_not_biased(self):
        c = self.campaign({"bvh": [0.5], "uniform": [0.2], "oracle:samples=8": [0.01], "octree": [0.1]},
                          biased=["uniform"])
        self.assertEqual(c.best_other(), "bvh")
        self.assertIsNone(self.campaign({"octree": [0.1], "oracle": [0.1]}).best_other())

    def test_gap_closed(self):
        def gap(own, other, oracle):
            c = self.campaign({"bvh": [other] * 5, "octree": [own] * 5, "oracle": [oracle] * 5})
            return measured.gap_closed(c, "oracle", "relL2")
        self.assertAlmostEqual(gap(0.3, 1.1, 0.1).mean, 0.8)
        self.assertAlmostEqual(gap(0.05, 1.1, 0.1).mean, 1.05)
        self.assertIsNone(gap(0.1, 0.109, 0.1))

    def test_error_of_the_gap_is_that_of_independent_errors(self):
        # (b - o) / (b - l), with errors by linear propagation; three seeds are too few to compare in pairs.
        errors = {"bvh": [1.0, 1.1, 0.9], "octree": [0.30, 0.33, 0.27], "oracle": [0.1, 0.1, 0.1]}
        gap = measured.gap_closed(self.campaign(errors), "oracle", "relL2")
        b, o, least, sb, so = 1.0, 0.3, 0.1, 0.1 / 3 ** 0.5, 0.03 / 3 ** 0.5
        expected = ((sb * (o - least) / (b - least) ** 2) ** 2 + (so / (b - least)) ** 2) ** 0.5
        self.assertAlmostEqual(gap.error, expected)


class Scripts(Folder):
    def run_script(self, script, *arguments, **environment):
        self.log, self.table = self.top / "log", self.top / "table.md"
        command = [str(MEASURED / script), "--lightlab", str(HERE.parent / "stand_in_lightlab.py"), "--out",
                   str(self.top / "out"), "--table", str(self.table), *arguments]
        settings = {"PBRT_REAL_SCENES": str(self.top / "absent"), "STAND_IN_LOG": str(self.log), **environment}
        return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **settings})

    def commands(self):
        return self.log.read_text().splitlines() if self.log.exists() else []

    def rows(self):
        lines = [line for line in self.table.read_text().splitlines() if line.startswith("| ")]
        return [[c.strip() for c in line.strip("|").split("|")] for line in lines]

    def test_run_compares_octree_with_the_best_other(self):
        chart = self.top / "chart.svg"
        done = self.run_script("run", "--only", "hotel,lamp", "--samplers", "bvh;octree:model=paper;octree",
                               "--equal-samples", "16", "--seeds", "5", "--chart", str(chart))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("*** SKIPPED: lamp is not there", done.stdout)
        self.assertEqual(len(self.commands()), 1)
        self.assertIn("--samplers bvh,octree:model=paper,octree,oracle:samples=8", self.commands()[0])
        head, hotel = self.rows()[:2]
        row = dict(zip(head, hotel))
        # The stand-in's errors are 0.3, 0.1, 0.05 and 0.5; 0.001 is the reference's noise.
        self.assertEqual(row["octree"], "0.049")
        self.assertTrue(row["octree against the best other"].startswith("0.49 +- "), hotel)
        self.assertTrue(row["octree against the best other"].endswith("(octree:model=paper)"), hotel)
        self.assertEqual((row["trimmed"], row["verdict"]), ("0.49", "better"))
        self.assertEqual((row["bias"], row["gap closed"]), ("none seen", "n/a"))
        self.assertIn("octree / bvh (without the worst 0.1 % of the pixels): hotel 0.16 +- 0.00 (0.16)", done.stdout)
        self.assertIn("hotel", chart.read_text())

    def test_run_redraws_the_chart_of_a_page(self):
        samplers = ("--samplers", "bvh;octree")
        page, chart = self.top / "page.md", self.top / "chart.svg"
        row = "| {} | 0.5! | {} | none seen | 0.20 +- 0.01 (bvh) | 0.20 | better |\n"
        head = "| scene | bvh | octree | bias | octree against the best other | trimmed | verdict |\n|---|---|\n"
        page.write_text("# Page\n\n" + head + row.format("hotel", "0.1") + row.format("slit", "0.05") + "\nText.\n")
        redraw = ("--redraw", str(page), "--chart", str(chart), *samplers)
        done = self.run_script("run", "--direct", *redraw)
        self.assertEqual((done.returncode, self.commands()), (0, []), done.stderr)
        self.assertIn("slit", chart.read_text())
        second = self.run_script("run", *redraw)
        self.assertEqual(second.returncode, 1)
        self.assertIn("no table 2", second.stderr)
        ratios = measured.ratios_on(page, 0, ["bvh", "octree"], "bvh")
        self.assertEqual({name: round(r["octree"].mean, 3) for name, r in ratios.items()}, {"hotel": 0.2, "slit": 0.1})

    def test_run_names_what_is_biased_and_does_not_compare_with_it(self):
        self.run_script("run", "--only", "hotel", "--samplers", "bvh;octree:model=paper;octree", "--time", "1",
                        STAND_IN_BIASED="octree:model=paper")
        row = dict(zip(*self.rows()[:2]))
        self.assertEqual(row["bias"], "octree:model=paper")
        self.assertTrue(row["octree against the best other"].endswith("(bvh)"), row)

    def test_bias_doubles_the_runs_until_all_verdicts_are_there(self):
        done = self.run_script("bias", "--only", "hotel", "--direct", STAND_IN_CLEAN_FROM="40")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([c.split("--seeds ")[1].split()[0] for c in self.commands()], ["12", "24", "48"])
        self.assertTrue(all("--direct" in c and "--spp 256" in c and "--divisor 8" in c for c in self.commands()))
        self.assertEqual(self.rows()[1], ["hotel", "48"] + ["clean (4.2 % / 0.7 %)"] * 3)

    def test_bias_ends_at_most_seeds_and_says_what_could_have_been_seen(self):
        self.run_script("bias", "--only", "hotel", "--most-seeds", "24", STAND_IN_CLEAN_FROM="40",
                        STAND_IN_BIASED="bvh")
        self.assertEqual(len(self.commands()), 2)
        self.assertEqual(self.rows()[1], ["hotel", "24", "biased (- / -)"] + ["unknown (8.3 % / 5 %)"] * 2)

    def test_a_failed_campaign_is_told(self):
        done = self.run_script("bias", "--only", "hotel", STAND_IN_FAIL="hotel")
        self.assertEqual(done.returncode, 1)
        self.assertIn("*** hotel: lightlab ended with status 1 ***", done.stdout)

    def test_tables_only_measures_nothing(self):
        done = self.run_script("run", "--tables-only", "--only", "hotel")
        self.assertEqual((done.returncode, self.commands()), (1, []))
        self.assertIn("SKIPPED: no campaign of hotel", done.stdout)

    def test_octree_must_be_among_the_samplers(self):
        done = self.run_script("run", "--samplers", "bvh;uniform")
        self.assertEqual(done.returncode, 2)
        self.assertIn("octree is what the others are compared with", done.stderr)


if __name__ == "__main__":
    unittest.main()
