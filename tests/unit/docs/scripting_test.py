"""What lightlab and pbrt write is what docs/guide/scripting describes, and the example reads it. Arguments: pbrt lightlab."""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import jsonschema
except ImportError:
    print("SKIPPED: the schemas of docs/guide/scripting were not tested: Debian's python3-jsonschema is missing")
    sys.exit(77)

PBRT, LIGHTLAB = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])
TOP = pathlib.Path(__file__).resolve().parents[3]
SCRIPTING = TOP / "docs/guide/scripting"
SCENE = TOP / "scenes/three-lights/three-lights.pbrt"


def schema(name):
    return json.loads((SCRIPTING / name).read_text())


def objects(node):
    """All descriptions of objects with given keys in a schema."""
    if isinstance(node, dict):
        if "properties" in node:
            yield node
        for value in node.values():
            yield from objects(value)
    elif isinstance(node, list):
        for value in node:
            yield from objects(value)


class Scripting(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        subprocess.run([LIGHTLAB, SCENE, "--spp", "2", "--seeds", "2", "--reference-spp", "4", "--divisor", "8", "--samplers",
                        "bvh,octree,bvh+mesh,oracle", "--selection-work", "1e5", "--quiet", "--cache", cls.folder / "cache", "--out",
                        cls.folder / "lab"], check=True, stdout=subprocess.DEVNULL)
        cls.path = cls.folder / "lab/results.json"
        cls.results = json.loads(cls.path.read_text())

    def validate(self, document, name):
        described = schema(name)
        jsonschema.Draft202012Validator.check_schema(described)
        validator = jsonschema.Draft202012Validator(described)
        return [f"{'/'.join(map(str, e.path))}: {e.message}" for e in validator.iter_errors(document)]

    def test_results_are_as_described(self):
        self.assertEqual(self.validate(self.results, "results.schema.json"), [])

    def test_a_timed_campaign_without_a_report_is_as_described(self):
        subprocess.run([LIGHTLAB, SCENE, "--time", "0.3", "--seeds", "1", "--reference-spp", "2", "--divisor", "16",
                        "--samplers", "power,bvh", "--selection-work", "0", "--no-report", "--quiet", "--cache",
                        self.folder / "cache", "--out", self.folder / "timed"], check=True, stdout=subprocess.DEVNULL)
        timed = json.loads((self.folder / "timed/results.json").read_text())
        self.assertEqual(self.validate(timed, "results.schema.json"), [])

    def test_departures_are_noticed(self):
        for spoil in (lambda r: r.pop("budget"), lambda r: r.update(extra=1), lambda r: r.update(schema=1),
                      lambda r: r["samplers"][0]["summary"].update(shadowRays="many"),
                      lambda r: r["samplers"][0]["summary"]["bias"].update(verdict="fair"),
                      lambda r: r["samplers"][1]["runs"][0]["rounds"][0]["metrics"].pop("relL2"),
                      lambda r: r["references"].clear()):
            spoilt = copy.deepcopy(self.results)
            spoil(spoilt)
            self.assertNotEqual(self.validate(spoilt, "results.schema.json"), [])

    def test_statistics_are_as_described(self):
        for flags in ([], ["--integrator", "randomwalk"]):
            done = subprocess.run([PBRT, "--quick", "--stats=json", *flags, "--outfile", self.folder / "p.exr", SCENE],
                                  capture_output=True, text=True, check=True)
            self.assertEqual(self.validate(json.loads(done.stdout), "stats.schema.json"), [])

    def test_every_key_is_explained(self):
        for name in ("results.schema.json", "stats.schema.json"):
            for described in objects(schema(name)):
                for key, value in described["properties"].items():
                    target = value
                    if "$ref" in value:
                        target = schema(name)["$defs"][value["$ref"].rsplit("/", 1)[1]]
                    self.assertTrue(target.get("description", "").strip(), f"{name}: {key}")
                self.assertIs(described.get("additionalProperties", None), False, f"{name}: other keys are allowed")

    def test_files_are_in_the_documented_places(self):
        for sampler in self.results["samplers"]:
            for key in ("picture", "pictureRange", "errorPicture"):
                self.assertTrue((self.path.parent / sampler[key]).is_file(), sampler[key])
            for run in sampler["runs"]:
                self.assertTrue((self.path.parent / run["image"]).is_file(), run["image"])

    def test_the_example_reads_them(self):
        done = subprocess.run([sys.executable, SCRIPTING / "read_results.py", self.path, self.path, "--against", "bvh"],
                              capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.count(f"three-lights: {self.results['conclusion']['headline']}"), 2)
        for sampler in self.results["samplers"]:
            self.assertIn(f"  {sampler['label']} ", done.stdout)
            ratio = sampler["summary"]["speedUps"].get("bvh")
            if ratio and not sampler["isOracle"]:
                self.assertRegex(done.stdout.split("All scenes")[1],
                                 rf"{sampler['label'].replace('+', '.')} +{ratio:.2f} times as fast as bvh \(2 scenes\)")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
