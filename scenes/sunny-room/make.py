"""A living room whose only light is the sky with its sun behind two windows; a second file gives it a portal."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (armchair, book_stack, bookcase, cupboard, curtain, curtain_rod, door_frame, door_leaf,
                       fruit_bowl, picture, plant, radiator, round_table, rug, sofa, vase, window_frame)
from scenekit import Piece, Scene, diffuse, planks, room, skirting
from skykit import Sun, clear_sky, portal_variant, sky_image, sky_light

W, D, H, T = 6.0, 5.0, 2.8, .3
WINDOWS = [(1.25, 2.35), (3.55, 4.65)]  # in the north wall, along x
SILL, TOP = .9, 2.2
DOOR = (1.9, 2.8)                       # in the west wall, along y, closed

ABOUT = "A living room lit by the sky and its sun alone, through two windows of 1.1 x 1.3 m"
scene = Scene("sunny-room", f"{ABOUT}.", 480, 320, spp=64, maxdepth=7, iso=800, whitebalance=5600)
scene.camera((5.55, .32, 1.5), (2.35, 4.05, .98), 58)
scene.material("paint-soft", diffuse(.82, .79, .73))
scene.material("paint-sage", diffuse(.6, .67, .6))
for name, colour in (("plank-a", (.6, .46, .31)), ("plank-b", (.55, .42, .28)), ("plank-c", (.65, .5, .35))):
    scene.material(name, diffuse(*colour))
sun = Sun(62, 38)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")

scene.add(room(W, D, H, {"n": [(a, b, SILL, TOP) for a, b in WINDOWS]}, T,
               paint={"s": "paint-soft", "w": "paint-sage", "n": "paint-soft", "e": "paint-soft"}), "shell")
scene.add(planks(0, 0, W, D, width=.18, length=2.1, seed=3), "floor boards")
scene.add(skirting(W, D, {"w": [(DOOR[0] - .07, DOOR[1] + .07)]}, .1), "skirting")
for k, (a, b) in enumerate(WINDOWS):
    scene.add(window_frame(b - a, TOP - SILL, T, "paint-white", 2, 1).at(a, D + T / 2, SILL), f"window {k + 1}")
    scene.add(Piece().include(curtain(.36, 2.28, 4, .04, seed=2 * k + 1).at(a - .22, D - .13, .05),
                              curtain(.36, 2.28, 4, .04, seed=2 * k + 2).at(b + .22, D - .13, .05),
                              curtain_rod(b - a + .9, "steel").at((a + b) / 2, D - .13, 2.36)), f"curtains {k + 1}")
    scene.add(radiator(.9, .45).at((a + b) / 2, D, .002), f"radiator {k + 1}")
scene.add(Piece().include(door_frame(.9, 2.02, .06).turn(90).at(.02, DOOR[0]),
                          door_leaf(.874, 2.0).turn(90).at(.03, DOOR[0] + .013, .004)), "door")

scene.add(sofa(2.0, .9, "fabric-blue", 3, ("fabric-mustard", "linen")).turn(90).at(.6, 3.95, .003), "sofa")
scene.add(rug(2.5, 1.8, "carpet-sand", "carpet-red").at(2.55, 3.3, 0, 2), "rug")
scene.add(round_table(.42, .42, "walnut").at(1.95, 3.75, .0145), "low table")
scene.add(Piece().include(fruit_bowl(.14).at(1.88, 3.84, .4355), book_stack(3, 5).at(2.12, 3.6, .4355, 35)),
          "on the table")
scene.add(armchair("fabric-rust", "linen").at(4.45, 3.85, .003, -48), "armchair")
scene.add(cupboard(1.05, .38, .8, "oak", 2, 1).at(2.95, D - .21, .003), "cupboard")
scene.add(vase(.32, "ceramic-blue").at(2.75, D - .22, .8035), "vase")
scene.add(book_stack(4, 9).at(3.2, D - .22, .8035, 80), "books")
scene.add(picture(.62, .8, "walnut", 12).at(2.95, D - .0006, 1.72), "picture between the windows")
scene.add(bookcase(.95, 1.95, seed=4).turn(90).at(.148, 1.05, .003), "bookcase")
scene.add(picture(.9, .62, "oak", 3).turn(90).at(.0006, 3.95, 1.62), "picture over the sofa")
scene.add(plant(1.3, 16, .2, 7).at(5.35, 4.45, .003), "plant")
scene.add(plant(.4, 12, .08, 8).at(1.5, D + .03, SILL + .006), "plant on the sill")

# Clockwise as the sky sees it: one rectangle for both windows, in the outer plane of their wall.
portal_variant(scene, [(WINDOWS[0][0], D + T, SILL), (WINDOWS[1][1], D + T, SILL),
                       (WINDOWS[1][1], D + T, TOP), (WINDOWS[0][0], D + T, TOP)],
               f"{ABOUT}; one portal for both.")
scene.main(__file__)
