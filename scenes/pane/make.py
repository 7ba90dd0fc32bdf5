"""A room whose windows hold thin slabs of glass: all its light is refracted twice, so no light sample gets in."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import armchair, book_stack, bookcase, picture, plant, round_table, rug, vase, window_frame
from scenekit import Piece, Scene, box, diffuse, planks, room, skirting
from skykit import Sun, clear_sky, sky_image, sky_light

W, D, H, T = 4.4, 4.0, 2.6, .3
WINDOWS = [(.7, 1.9), (2.5, 3.7)]  # in the north wall, along x
SILL, TOP, BAR = .85, 2.2, .045

scene = Scene("pane", "A room lit by sun and sky through two windows with panes of dielectric glass.", 480, 320, spp=64,
              maxdepth=12, iso=700, whitebalance=5600)
scene.camera((4.05, .35, 1.5), (1.75, 3.3, 1.0), 60)
scene.material("wall-soft", diffuse(.78, .75, .68))
scene.material("wall-sage", diffuse(.55, .62, .55))
sun = Sun(66, 38)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")

scene.add(room(W, D, H, {"n": [(a, b, SILL, TOP) for a, b in WINDOWS]}, T,
               paint={"s": "wall-soft", "w": "wall-sage", "n": "wall-soft", "e": "wall-soft"}), "shell")
scene.add(planks(0, 0, W, D, width=.16, length=1.9, seed=5), "floor boards")
scene.add(skirting(W, D), "skirting")
for k, (a, b) in enumerate(WINDOWS):
    scene.add(window_frame(b - a, TOP - SILL, T, "paint-white", 1, 1).at(a, D + T / 2, SILL), f"window {k + 1}")
    # The slab reaches a little into the frame, so that no light passes beside it.
    scene.add(box((a + BAR - .01, D + T / 2 - .004, SILL + BAR - .01),
                  (b - BAR + .01, D + T / 2 + .004, TOP - BAR + .01)),
              f"pane {k + 1}", "glass")
scene.add(rug(2.0, 1.5, "carpet-blue", "carpet-sand").at(1.8, 2.2, 0, 3), "rug")
scene.add(round_table(.4, .42, "walnut").at(1.55, 2.35, .0145), "low table")
scene.add(Piece().include(vase(.26, "ceramic-blue").at(1.5, 2.45, .4355), book_stack(3, 5).at(1.68, 2.2, .4355, 35)),
          "on the table")
scene.add(armchair("fabric-rust", "linen").at(.65, 3.2, .003, 40), "armchair")
scene.add(bookcase(.95, 1.95, seed=4).turn(90).at(.148, 1.7, .003), "bookcase")
scene.add(picture(.5, .66, "oak", 12).at(2.2, D - .0006, 1.6), "picture")
scene.add(plant(1.1, 16, .18, 7).at(3.3, 3.6, .003), "plant")
scene.main(__file__)
