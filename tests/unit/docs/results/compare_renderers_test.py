#!/usr/bin/python3
"""Tests docs/results/compare_renderers with stand-ins for stock pbrt-v4: our own program behind scripts.

usage: compare_renderers_test.py PBRT IMGTOOL
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

sys.dont_write_bytecode = True
TOP = pathlib.Path(__file__).resolve().parents[4]
sys.path.insert(0, str(TOP / "docs/results"))
import data  # noqa: E402

PBRT, IMGTOOL = sys.argv[1:3]
RADIANCE = 9
SCENE = """LookAt 0 -4 1  0 0 .8  0 0 1
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 16 "integer yresolution" 12 "string filename" "tiny.exr"
Sampler "zsobol" "integer pixelsamples" 16
Integrator "path" "integer maxdepth" 2
WorldBegin
LightSource "infinite" "rgb L" [ .4 .5 .6 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 9 8 6 ]
Translate 1.5 -1 2.5
Shape "sphere" "float radius" .3
AttributeEnd
Material "diffuse" "rgb reflectance" [ .5 .4 .3 ]
Shape "bilinearmesh" "point3 P" [ -8 -8 0  8 -8 0  -8 8 0  8 8 0 ]
Translate 0 0 .8
Shape "sphere" "float radius" .8
"""


class CompareRenderers(unittest.TestCase):
    def setUp(self):
        self.top = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.scene = self.top / "tiny.pbrt"
        self.scene.write_text(SCENE)

    def script(self, text, name="stock"):
        file = self.top / name
        file.write_text(f"#!/bin/bash\nset -eu\n{text}\n")
        file.chmod(0o755)
        return file

    def compare(self, stock, *arguments, scenes=None):
        command = [TOP / "docs/results/compare_renderers", "--stock", stock, "--ours", PBRT, "--imgtool", IMGTOOL,
                   "--seeds", "3", "--spp", "32", "--few", "4", "--reference-spp", "128", *arguments, *(scenes or [self.scene])]
        return subprocess.run([str(c) for c in command], capture_output=True, text=True, cwd=self.top)

    def rows(self, stock, *arguments, **options):
        done = self.compare(stock, "--csv", self.top / "out.csv", *arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return data.read(self.top / "out.csv"), done.stdout

    def fails(self, stock, *arguments, **options):
        """What the script writes to standard error, which is no traceback."""
        done = self.compare(stock, *arguments, **options)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertTrue(done.stderr.splitlines()[-1])
        self.assertNotIn("Traceback", done.stderr)
        return done.stderr

    def test_a_stand_in_with_other_seeds_agrees(self):
        stock = self.script(f"""arguments=()
while [ $# -gt 0 ]; do
  if [ "$1" = --seed ]; then arguments+=(--seed $(($2 + 500))); shift; else arguments+=("$1"); fi
  shift
done
exec {PBRT} "${{arguments[@]}}" """)
        rows, printed = self.rows(stock, "--also", "power", "--chart", self.top / "out.png", "--folder", self.top / "kept")
        self.assertEqual([r["renderer"] for r in rows], ["stock", "ours", "ours, power"])
        for r in rows:
            self.assertGreater(data.number(r, "cpu_per_sample"), 0)
            self.assertIn(r["renderer"], printed)
        for r in rows[1:]:
            self.assertEqual(r["agreement"], "agree")
            self.assertLess(abs(data.number(r, "mean_difference")), 0.1)
            self.assertGreater(data.number(r, "relL2_over_stock_error"), 0)
        self.assertAlmostEqual(data.number(rows[1], "relL2_over_stock"), 1, delta=0.5)
        ratio = data.number(rows[1], "cpu_over_stock") * data.number(rows[1], "relL2_over_stock")
        self.assertAlmostEqual(data.number(rows[1], "efficiency") * ratio, 1, delta=0.01)
        text = (self.top / "out.csv").read_text()
        for key in ("commit", "machine", "date", "command", "stock", "seeds", "samples"):
            self.assertIn(f"# {key}: ", text)
        self.assertEqual((self.top / "out.png").read_bytes()[:4], b"\x89PNG")
        self.assertEqual(len(list((self.top / "kept/tiny").glob("stock-*.exr"))), 3)

    def test_a_stand_in_with_other_lights_differs(self):
        stock = self.script(f"""scene="${{@: -1}}"
sed 's/"rgb L" \\[ {RADIANCE} /"rgb L" [ {4 * RADIANCE} /' "$scene" > {self.top}/brighter.pbrt
exec {PBRT} "${{@:1:$#-1}}" {self.top}/brighter.pbrt""")
        rows, _ = self.rows(stock)
        self.assertEqual(rows[1]["agreement"], "differ")
        self.assertLess(data.number(rows[1], "mean_difference"), -0.02)

    def test_a_given_reference_has_no_noise_taken_off(self):
        reference = self.top / "reference.exr"
        subprocess.run([PBRT, "--quiet", "--spp", "256", "--seed", "77", "--outfile", reference, self.scene], check=True)
        rows, _ = self.rows(PBRT, "--reference", reference)
        self.assertEqual(rows[1]["reference_noise"], "")
        # The program stands in for itself: the same images.
        self.assertEqual(data.number(rows[1], "relL2_over_stock"), 1)
        self.assertEqual(data.number(rows[1], "mean_difference"), 0)

    def test_programs_that_fail(self):
        self.assertIn("no such program", self.fails(self.top / "absent"))
        (self.top / "plain").write_text("")
        self.assertIn("not executable", self.fails(self.top / "plain"))
        error = self.fails(self.script('echo "tiny.pbrt:3: Unknown film" >&2; exit 3'))
        self.assertIn("ended with status 3", error)
        self.assertIn("Unknown film", error)
        self.assertIn("signal 9", self.fails(self.script("kill -9 $$")))
        self.assertIn("wrote no", self.fails(self.script("exit 0")))

    def test_images_that_cannot_be_compared(self):
        small = self.script(f"""scene="${{@: -1}}"
sed 's/xresolution" 16/xresolution" 20/' "$scene" > {self.top}/wider.pbrt
exec {PBRT} "${{@:1:$#-1}}" {self.top}/wider.pbrt""")
        self.assertIn("imgtool", self.fails(small))
        self.scene.write_text(SCENE.replace('"integer pixelsamples" 16', '"integer pixelsamples" 16 "integer seed" 3'))
        self.assertIn("equal for different seeds", self.fails(PBRT))

    def test_arguments(self):
        self.assertIn("no such file", self.fails(PBRT, scenes=[self.top / "absent.pbrt"]))
        self.assertIn("there is no folder", self.fails(PBRT, "--csv", self.top / "absent/out.csv"))
        for wrong in (("--seeds", "1"), ("--few", "32"), ("--chart", "out.svg")):
            done = self.compare(PBRT, *wrong)
            self.assertEqual(done.returncode, 2)
            self.assertIn("error: --", done.stderr)

    def test_a_missing_library_is_reported_before_the_renders(self):
        (self.top / "numpy.py").write_text("raise ImportError('numpy is absent')")
        stock = self.script(f"touch {self.top}/rendered")
        with unittest.mock.patch.dict(os.environ, PYTHONPATH=str(self.top)):
            self.assertIn("python3-numpy", self.fails(stock))
        self.assertFalse((self.top / "rendered").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
