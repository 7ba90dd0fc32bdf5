"""Tests what charts.py and report.py write into a synthetic output folder, and how they fail."""
import html
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

sys.dont_write_bytecode = True
import synthetic_results as synthetic  # noqa: E402

SCRIPTS = pathlib.Path(os.environ.get("LIGHTLAB_REPORT")
                       or pathlib.Path(__file__).resolve().parents[6] / "src/ext/lab/lightlab/report")
sys.path.insert(0, str(SCRIPTS))
import lab_results  # noqa: E402
import table  # noqa: E402

CHARTS = ["chart-error-time", "chart-error-samples", "chart-speed-accuracy", "chart-overhead", "chart-crops"]


def run(script, *arguments, **environment):
    return subprocess.run([sys.executable, str(SCRIPTS / script), *map(str, arguments)], capture_output=True, text=True,
                          env={**os.environ, **environment})


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.out = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "out"

    def page(self):
        done = run("report.py", self.out)
        self.assertEqual(done.returncode, 0, done.stderr)
        return (self.out / "report.html").read_text()


class Files(WithFolder):
    def test_ChartsAreWellFormedAndRepeatableAndOldOnesGo(self):
        results = synthetic.make(self.out)
        first = run("charts.py", self.out)
        self.assertEqual((first.returncode, first.stderr), (0, ""))
        before = {}
        for name in CHARTS:
            xml.etree.ElementTree.parse(self.out / f"{name}.svg")
            self.assertEqual((self.out / f"{name}.png").read_bytes()[:4], b"\x89PNG")
            before[name] = (self.out / f"{name}.svg").read_bytes()
        results["crops"] = []
        (self.out / "results.json").write_text(json.dumps(results))
        self.assertEqual(run("charts.py", self.out).returncode, 0)
        for name in CHARTS[:4]:
            self.assertEqual((self.out / f"{name}.svg").read_bytes(), before[name], name)
        self.assertFalse((self.out / "chart-crops.svg").exists())

    def test_PageIsOneFileWithoutOutsideReferences(self):
        synthetic.make(self.out)
        run("charts.py", self.out)
        page = self.page()
        for name in CHARTS[:4]:
            self.assertIn(f'id="{name}"', page)
        attributes = re.findall(r'(?:\ssrc|\shref|url\()\s*=?\s*["\']?([^"\')\s>]+)', page)
        self.assertEqual([a for a in attributes if not a.startswith(("data:", "#"))], [])
        ids = re.findall(r'\sid="([^"]+)"', page)
        self.assertEqual(len(ids), len(set(ids)), "ids must be unique in the page")

    def test_MissingMatplotlibIsOneSentence(self):
        synthetic.make(self.out)
        (self.out / "matplotlib.py").write_text("raise ModuleNotFoundError('no', name='matplotlib')")
        done = run("charts.py", self.out, PYTHONPATH=str(self.out))
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn("python3-matplotlib", done.stderr)
        self.assertIn("There are no charts", self.page())

    def test_MissingOrForeignResultsAreOneSentence(self):
        self.out.mkdir()
        for text in (None, "{", "[]", '{"schema": 1}', '{"schema": 2, "samplers": []}'):
            if text is not None:
                (self.out / "results.json").write_text(text)
            for script in ("charts.py", "report.py"):
                done = run(script, self.out)
                self.assertEqual(done.returncode, 1, text)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_UnknownNumbersAndMissingPicturesAreSurvived(self):
        results = synthetic.make(self.out, ["uniform", "octree"], seeds=1, rounds=1, winner=None)
        uniform, octree = results["samplers"]
        uniform["summary"] = {"metrics": {"relL2": {"mean": None}}, "bias": None}
        uniform["runs"] = []
        octree["runs"][0]["rounds"][0]["metrics"]["relL2"] = None
        results.update(machine=None, references=[], crops=[])
        (self.out / octree["errorPicture"]).unlink()
        (self.out / octree["pictureRange"]).unlink()
        (self.out / "results.json").write_text(json.dumps(results))
        done = run("charts.py", self.out)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertFalse((self.out / "chart-error-time.svg").exists())
        self.assertIn("uniform", self.page())

    def test_OneSeedHasNoStandardError(self):
        for seeds in (1, 2):
            synthetic.make(self.out, ["uniform", "octree"], seeds=seeds, rounds=1, winner=None)
            self.assertEqual(re.search(r"\d ± \d", self.page()) is not None, seeds > 1)

    def test_TextOfTheRunCannotBecomeMarkup(self):
        results = synthetic.make(self.out, ["uniform", "octree"])
        evil = '</script><img src=x onerror=alert(1)>&"'
        results["commandLine"] = results["sceneName"] = results["samplers"][0]["label"] = evil
        results["samplers"][0]["structure"] = results["samplers"][0]["report"]["a"] = evil
        (self.out / "results.json").write_text(json.dumps(results))
        page = self.page()
        self.assertNotIn("<img src=x", page)
        self.assertEqual(page.count("</script>"), 2)

    def test_ConclusionIsShownWordByWordAndNothingElseIsConcluded(self):
        for winner in ("octree", None):
            results = synthetic.make(self.out, winner=winner)
            page, text = self.page(), (self.out / "table.md").read_text()
            for sentence in results["conclusion"]["sentences"]:
                self.assertIn(html.escape(sentence), page)
                self.assertIn(table.escape(sentence), text)
            outcome = page[page.index('class="outcome"'):page.index("</section>")]
            self.assertEqual(outcome.count("<p"), len(results["conclusion"]["sentences"]))

    def test_UndecidedHasNoWinnerAnywhere(self):
        synthetic.make(self.out, winner=None)
        page, text = self.page(), (self.out / "table.md").read_text()
        for part in ("has the lowest error", 'class="tag win"', 'class="winner"'):
            self.assertNotIn(part, page)
        self.assertIn("lowest mean, undecided", page)
        self.assertNotIn("has the lowest error", text)
        self.assertNotIn("**octree**", text)

    def test_ResultsWithoutConclusionAreUndecided(self):
        results = synthetic.make(self.out)
        del results["conclusion"]
        (self.out / "results.json").write_text(json.dumps(results))
        page = self.page()
        self.assertIn("Undecided", page)
        self.assertNotIn('class="tag win"', page)

    def test_MarkdownHasOneRowPerSamplerByError(self):
        synthetic.make(self.out)
        self.page()
        rows = [line for line in (self.out / "table.md").read_text().splitlines() if line.startswith("|")]
        self.assertEqual({row.count("|") for row in rows}, {rows[0].count("|")})
        names = [row.split("|")[1].strip().strip("*") for row in rows[2:]]
        self.assertEqual(names, ["neepp", "octree", "octree:leaves=512", "bvh", "power",
                                 "oracle (measuring instrument)", "uniform"])
        self.assertIn("**biased**", rows[2])


    def test_ColumnsAreNamedAsInTheTableOfTheProgram(self):
        self.assertLessEqual({"efficiency", "speed-up", "x oracle", "prepass s", "build s", "cost", "blocked", "bias"},
                             {column.name for column in table.COLUMNS})

    def test_ErrorColoursAreThoseOfTheErrorPictures(self):
        source = SCRIPTS.parents[4] / "src/pbrt/images/false_color.cpp"
        if not source.exists():
            source = pathlib.Path(__file__).resolve().parents[6] / "src/pbrt/images/false_color.cpp"
        stops = source.read_text().split("kColors", 1)[1].split(";", 1)[0]
        colours = ["#" + "".join(f"{int(255 * float(v) + 0.5):02x}" for v in rgb)
                   for rgb in re.findall(r"Rgb\(([\d.]+)f, ([\d.]+)f, ([\d.]+)f\)", stops)]
        self.assertEqual(lab_results.ERROR_RAMP, colours)


class Reading(WithFolder):
    def load(self, **options):
        synthetic.make(self.out, **options)
        return lab_results.Results(self.out)

    def test_ColoursBelongToNamesNotToRuns(self):
        all_ = {s.label: s.colour for s in self.load().samplers}
        some = {s.label: s.colour for s in self.load(labels=["octree", "power"]).samplers}
        self.assertEqual(len(set(all_.values())), len(all_))
        for label, colour in some.items():
            self.assertEqual(colour, all_[label])

    def test_InterpolationIsStraightInLogLog(self):
        points = [(1.0, 8.0), (4.0, 2.0)]
        self.assertAlmostEqual(lab_results.interpolate(points, 2.0), 4.0)
        self.assertAlmostEqual(lab_results.interpolate(points, 4.0), 2.0)
        self.assertIsNone(lab_results.interpolate(points, 0.5))
        self.assertIsNone(lab_results.interpolate(points, 5.0))

    def test_BandIsTheSeedsMeanAndRange(self):
        rows = lab_results.band([[(1, 4.0), (2, 2.0)], [(1, 2.0), (2, 1.0), (4, 0.5)]])
        self.assertEqual([round(v, 9) for v in rows[0]], [1, 3, 2, 4])
        self.assertEqual([round(v, 9) for v in rows[-1]], [2, 1.5, 1, 2])

    def test_ParetoFrontLeavesOutBiasedOracleAndBeaten(self):
        import chart_pareto
        results = self.load()
        common, points = chart_pareto.points_of(results)
        self.assertEqual(common, 64)
        front = chart_pareto.front_of(points)
        names = [s.label for s, _, _ in front]
        self.assertIn("octree", names)
        self.assertNotIn("neepp", names)
        self.assertNotIn("oracle", names)
        for s, t, e in points:
            beaten = any(t2 < t and e2 < e for o, t2, e2 in points if o.mayWin)
            self.assertFalse(beaten and s.label in names, s.label)

    def test_LaggardDoesNotDecideWhereAllAreCompared(self):
        import chart_pareto
        results = self.load()
        bvh = next(s for s in results.samplers if s.label == "bvh")
        for run_ in bvh.entry["runs"]:
            del run_["rounds"][2:]
        common, points = chart_pareto.points_of(results)
        self.assertEqual(common, 64)
        _, seconds, error = next(p for p in points if p[0] is bvh)
        self.assertEqual((seconds, error), (bvh.time_at(2), bvh.error_at("samples", 2)))
        uniform = next(s for s in results.samplers if s.label == "uniform")
        for s in results.samplers:
            for run_ in s.entry["runs"] if s is not uniform else []:
                del run_["rounds"][5:]
        self.assertEqual(chart_pareto.points_of(results)[0], 16)

    def test_LabelsNeverOverlapAndKeepTheirOrder(self):
        import chart_style
        for wanted in ([0.5, 0.5, 0.5, 0.52], [0.0, 0.01, 0.99, 1.0], [0.9] * 9, [0.3, 0.1]):
            placed = chart_style.spread_labels(wanted, 0.1, 0, 1)
            order = sorted(range(len(wanted)), key=lambda i: wanted[i])
            for a, b in zip(order, order[1:]):
                self.assertGreaterEqual(placed[b] - placed[a], 0.1 - 1e-9)
            self.assertGreaterEqual(min(placed), -1e-9)
            self.assertLessEqual(max(placed), 1 + 1e-9)

    def test_BestIsChosenAmongThoseThatMayWin(self):
        results = self.load()
        column = next(c for c in table.COLUMNS if c.key == "relL2")
        self.assertEqual([s.label for s in table.best_of(column, results.samplers)], ["octree"])

    def test_FiguresStayShort(self):
        for value, text in ((0.0123456, "0.0123"), (123.456, "123"), (12.0, "12.0"), (0, "0"), (None, "–"),
                            (1.5e-9, "1.50e-09"), (49504.0, "49\u202f504"), (-0.00456, "-0.00456")):
            self.assertEqual(lab_results.figures(value), text)


if __name__ == "__main__":
    unittest.main()
