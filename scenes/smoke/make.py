"""A camp fire at night: its smoke and its flames are a grid of densities and temperatures that make_grid.cpp makes."""
import math
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *

here = pathlib.Path(__file__).resolve().parent
if not (here / "smoke.nvdb").exists():  # delete it to have it made again
    program = here / "make_grid"
    subprocess.run(["g++", "-std=c++17", "-O2", "-DNANOVDB_USE_ZIP", here / "make_grid.cpp", "-lz", "-o", program], check=True)
    subprocess.run([program, here / "smoke.nvdb"], check=True)
    program.unlink()

scene = Scene("smoke", "A camp fire between a wall and three logs at night; its smoke is lit by the fire and by lamps behind the wall.", 360,
              480, spp=16, maxdepth=12, integrator="volpath", iso=400, whitebalance=3200)
scene.camera((-1.2, -6.2, 1.7), (.45, 0, 1.45), 40)
scene.material("soil", diffuse(.2, .16, .12))
scene.material("stone", diffuse(.4, .38, .36))
scene.material("log", diffuse(.23, .14, .08))
scene.add(slab(-20, -12, 20, 12, -.2, 0), "ground", "soil")
scene.add(box((-3, 1.6, 0), (1.2, 1.9, 2.3)), "wall", "stone")
for k in range(9):
    a = 2 * math.pi * k / 9
    scene.add(sphere(.1, 2).at(.42 * math.cos(a), .42 * math.sin(a), .06), f"stone {k}", "stone")
for k, (x, y, turn) in enumerate([(-1.5, .2, 80), (1.5, -.1, 100), (.2, 1.1, 5)]):
    scene.add(cylinder(.13, -.5, .5, 20).turn(90, "y").turn(turn).at(x, y, .13), f"log {k}", "log")
# Shadow rays do not find the light of flames; only paths that pass through the flames do.
scene.raw('MakeNamedMedium "smoke" "string type" "nanovdb" "string filename" "smoke.nvdb" "rgb sigma_s" [ 4 4 4 ] "rgb sigma_a" [ 1.5 1.6 1.8 ] "float g" .2 '
          '"float Lescale" 6 "float temperaturecutoff" 400')
scene.raw('AttributeBegin\nMediumInterface "smoke" ""\nMaterial "interface"')
lo, hi = (-.85, -1.05, .01), (2.25, 1.05, 3.62)
scene.raw(f'Shape "trianglemesh" "point3 P" [ {"  ".join(numbers(v) for v in box(lo, hi).vertices)} ]\n'
          f'  "integer indices" [ {"  ".join("%d %d %d" % f for f in box(lo, hi).faces)} ]')
scene.raw("AttributeEnd")
for k, (x, y, z) in enumerate([(-2.4, 2.3, 1.4), (-.9, 2.3, 2.0), (.8, 2.4, 1.2), (2.9, -2.2, .3)]):
    scene.light(bulb(.05, 2).at(x, y, z), (25, 25, 25, 6)[k], (2700, 3600, 2400, 5200)[k], f"lamp {k}")
scene.light(panel(8, 8, 1, 1, down=True).at(0, 0, 9), 2, 9000, "the night sky")
scene.main(__file__)
