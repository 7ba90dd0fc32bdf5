"""Two headlights' cones in thin fog, seen from the side."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *

scene = Scene("headlight", "Two headlights' cones in thin fog, seen from the side; they end at a wall.", 480, 270, spp=16, maxdepth=5,
              integrator="volpath", iso=400, whitebalance=5000)
scene.camera((-0.5, -9, 1.5), (0, 0, .95), 38)
scene.fog('"string type" "homogeneous" "rgb sigma_s" [ .05 .05 .05 ] "rgb sigma_a" [ .001 .001 .001 ] "float g" .6')
scene.material("road", diffuse(.12, .12, .12))
scene.material("car", diffuse(.02, .05, .12))
scene.material("wall-grey", diffuse(.5, .48, .45))
scene.add(slab(-30, -12, 30, 12, -.3, 0), "road", "road")
scene.add(join(beveled_box((-7.3, -.85, .25), (-3.55, .85, .85), .08), beveled_box((-6.9, -.75, .8), (-4.7, .75, 1.4), .1)), "car", "car")
for x in (-6.4, -4.4):
    scene.add(join(cylinder(.32, -.1, .1).turn(90, "x").at(x, -.82, .32), cylinder(.32, -.1, .1).turn(90, "x").at(x, .82, .32)),
              f"wheels {x}", "road")
scene.add(box((5.2, -3, 0), (5.5, 3, 2.6)), "wall", "wall-grey")
scene.light(panel(8, 6, 1, 1, down=True).at(-2, -3, 7), 10, 7500, "a dim sky")
for y in (-.6, .6):
    scene.raw(f'\n# headlight\nLightSource "spot" "blackbody I" 5200 "float scale" 40 "point3 from" [ -3.5 {number(y)} .62 ] '
              f'"point3 to" [ 5 {number(y)} .45 ] "float coneangle" 14 "float conedeltaangle" 6')
scene.main(__file__)
