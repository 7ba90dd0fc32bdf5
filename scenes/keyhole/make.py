"""A closed shed into which sun and sky shine through one hole of 4 cm only: hardly a ray finds it."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import book_stack, picture, round_table, rug, stool, vase
from scenekit import Scene, diffuse, room, skirting
from skykit import Sun, clear_sky, sky_image, sky_light

W, D, H, T = 3.0, 3.2, 2.4, .04
HOLE = (1.48, 1.52, 1.58, 1.62)  # in the north wall

scene = Scene("keyhole", "A closed shed into which sun and sky shine through one hole of 4 cm.", 480, 320, spp=64,
              maxdepth=9, iso=3200, whitebalance=5600)
scene.camera((2.72, .28, 1.45), (1.1, 2.5, .8), 62)
scene.material("lime", diffuse(.82, .81, .78))
scene.material("pale-floor", diffuse(.66, .6, .52))
sun = Sun(95, 39)
sky_light(scene, sky_image(128, clear_sky(sun), sun), 450, "the sky with the sun")

scene.add(room(W, D, H, {"n": [HOLE]}, T, floor="pale-floor", paint="lime", ceiling="lime"), "shed with a hole")
scene.add(skirting(W, D), "skirting")
scene.add(rug(1.5, 1.2, "carpet-red", "carpet-sand").at(1.2, 1.7, 0, 3), "rug")
scene.add(round_table(.38, .6, "oak").at(.75, 2.35, .001), "table")
scene.add(vase(.3, "ceramic-blue").at(.68, 2.42, .6015), "vase")
scene.add(book_stack(3, 5).at(.92, 2.22, .6015, 35), "books")
scene.add(stool(.18, .45).at(1.75, 2.25, .001), "stool")
scene.add(picture(.6, .45, "walnut", 12).turn(90).at(.0006, 1.6, 1.5), "picture")
scene.main(__file__)
