"""A room in which a mirror sphere stands in the sun of a window and throws it onto walls and ceiling."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import bench, picture, plant, rug, vase, window_frame
from scenekit import Scene, diffuse, lathe, planks, room, skirting
from skykit import Sun, clear_sky, sky_image, sky_light

W, D, H, T = 4.0, 4.0, 2.7, .3
WINDOW = (1.3, 2.7, .8, 2.2)  # in the north wall
BALL = (1.9, 2.45, .85, .38)   # centre and radius

scene = Scene("mirror-ball", "A mirror sphere in the sun of a window throws light onto walls and ceiling.", 480, 320,
              spp=64, maxdepth=8, iso=600, whitebalance=5600)
scene.camera((3.65, .35, 1.5), (1.45, 2.9, 1.0), 62)
scene.material("wall-soft", diffuse(.8, .78, .73))
scene.material("wall-deep", diffuse(.5, .57, .65))
sun = Sun(76, 38)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")

scene.add(room(W, D, H, {"n": [WINDOW]}, T,
               paint={"s": "wall-soft", "w": "wall-deep", "n": "wall-soft", "e": "wall-soft"}), "shell")
scene.add(planks(0, 0, W, D, width=.16, length=1.9, seed=5), "floor boards")
scene.add(skirting(W, D), "skirting")
scene.add(window_frame(WINDOW[1] - WINDOW[0], WINDOW[3] - WINDOW[2], T, "paint-white", 2, 2)
          .at(WINDOW[0], D + T / 2, WINDOW[2]), "window")
foot = [(0, 0), (.3, 0), (.3, .04), (.1, .08), (.08, .3), (.16, .46), (.2, .53), (0, .5)]
scene.add(lathe(foot, 36).at(BALL[0], BALL[1], .003), "foot of the ball", "walnut")
scene._use("mirror")
scene.raw(f'\n# the ball\nAttributeBegin Translate {BALL[0]} {BALL[1]} {BALL[2]} NamedMaterial "mirror" '
          f'Shape "sphere" "float radius" {BALL[3]} AttributeEnd')
scene.add(rug(1.9, 1.4, "carpet-sand", "carpet-blue").at(1.9, 1.7, 0, 4), "rug")
scene.add(bench(1.2, .38, .45, "oak", "fabric-rust").turn(90).at(.24, 2.0, .003), "bench")
scene.add(picture(.9, .62, "oak", 3).turn(90).at(.0006, 2.0, 1.55), "picture")
scene.add(plant(1.1, 16, .18, 7).at(.45, 3.5, .003), "plant")
scene.add(vase(.4, "ceramic").at(3.5, 3.6, .003), "vase")
scene.main(__file__)
