"""A street at night in thin fog: a lamp with a shade, two lit windows, a wall."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *

scene = Scene("street-lamp", "A street at night in thin fog: a lamp under a shade and three lit windows.", 360, 480, spp=16, maxdepth=6,
              integrator="volpath", iso=260, whitebalance=3600)
scene.camera((-1.5, -8.5, 1.7), (0.35, 0, 2.55), 44)
scene.fog('"string type" "homogeneous" "rgb sigma_s" [ .045 .045 .045 ] "rgb sigma_a" [ .001 .001 .001 ] "float g" .5')
scene.material("asphalt", diffuse(.09, .09, .1))
scene.material("kerb", diffuse(.3, .3, .29))
scene.material("brick", diffuse(.3, .15, .11))
scene.material("post", metal("Al", .3))
scene.material("shade", diffuse(.7, .7, .66))
scene.material("frame", diffuse(.6, .6, .55))
scene.add(slab(-30, -12, 30, 0.9, -.3, 0), "street", "asphalt")
scene.add(slab(-30, 0.9, 30, 3.2, -.3, .12), "pavement", "kerb")
openings = [(-2.2, 1.3), (1.9, 1.3), (1.9, 4.1)]
scene.add(box((-30, 3.2, 0), (30, 3.6, 9)), "house", "brick")
for k, (x, z) in enumerate(openings):
    scene.add(box((x - .58, 3.12, z - .08), (x + .58, 3.2, z)), f"sill {k}", "frame")
    pane = quad((x - .5, 3.19, z), (x + .5, 3.19, z), (x + .5, 3.19, z + 1.3), (x - .5, 3.19, z + 1.3))
    scene.light(pane, 1.5, 2900, f"window {k}")
scene.add(cylinder(.06, 0.12, 4.3), "post", "post")
scene.add(tube((0, 0, 4.25), (0, -.9, 4.45), .04), "arm", "post")
shade = lathe([(.3, 0), (.24, .14), (.06, .3), (0, .31)], 32)
inside = lathe([(0, .3), (.05, .29), (.23, .13), (.29, 0)], 32)
scene.add(join(shade, inside).at(0, -.95, 4.15), "shade", "shade")
scene.light(bulb(.07, 2).at(0, -.95, 4.24), 60, 3000, "lamp")
scene.main(__file__)
