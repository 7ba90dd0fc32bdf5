#!/usr/bin/env python3
"""Writes slit.pbrt: a study at night, a street lamp behind closed shutters."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (armchair, book_stack, bookcase, chair, cup, globe_lamp, picture, plant, round_table, rug, table,
                       table_lamp,
                       vase)
from scenekit import Piece, Scene, beveled_box, box, diffuse, planks, room, skirting, sphere

WIDTH, DEPTH, HEIGHT = 3.9, 4.3, 2.6
X0, X1, Z0, Z1 = 1.25, 2.55, .75, 2.15    # the window in the far wall
GAP, BOARD = .008, .008                   # between the shutter's boards, and their thickness

scene = Scene("slit", "A point light behind a wall with thin slits: a street lamp shines through 8 mm gaps of a"
              " shutter into a study. A weaker lamp lights the rest.", maxdepth=5, whitebalance=3900)
scene.camera((.42, .25, 1.5), (2.15, 3.2, .9), 48)
scene.material("shutter", diffuse(.16, .22, .2))
scene.material("plaster", diffuse(.6, .55, .47))
scene.raw("# A light sampler that never saw the street lamp through a slit and gives it probability 0 loses the"
          " stripes.\n"
          f'LightSource "point" "point3 from" [ {(X0 + X1) / 2 + .22:g} {DEPTH + 1.75:g} 2.75 ] '
          '"rgb I" [ 170 195 235 ]')
scene.lights += 1

scene.add(room(WIDTH, DEPTH, HEIGHT, {"n": [(X0, X1, Z0, Z1)]}, paint="plaster"), "room")
scene.add(planks(0, 0, WIDTH, DEPTH, width=.13, seed=2), "floor")
scene.add(skirting(WIDTH, DEPTH), "skirting")

# ---- the shutter: six boards on the outside of the opening, larger than it, with cross pieces
shutter, boards = Piece(), 6
left, right = X0 - .05, X1 + .05
step = (right - left + GAP) / boards
for k in range(boards):
    x = left + k * step
    shutter.add("shutter", box((x, DEPTH + .135, Z0 - .04), (x + step - GAP, DEPTH + .135 + BOARD, Z1 + .04)))
for z in (Z0 + .2, Z1 - .28):
    shutter.add("shutter", box((left, DEPTH + .115, z), (right, DEPTH + .136, z + .07)))
shutter.add("iron", box((X0 + .06, DEPTH + .108, Z0 + .62), (X1 - .06, DEPTH + .116, Z0 + .65)),
            box(((X0 + X1) / 2 - .03, DEPTH + .1, Z0 + .585), ((X0 + X1) / 2 + .03, DEPTH + .109, Z0 + .685)))
scene.add(shutter, "shutter")
frame = Piece()
for x in (X0 - .07, X1 - .004):
    frame.add("trim", beveled_box((x, DEPTH - .016, Z0 - .004), (x + .074, DEPTH + .004, Z1 + .07), .004))
frame.add("trim", beveled_box((X0 + .004, DEPTH - .016, Z1 - .004), (X1 - .004, DEPTH + .004, Z1 + .07), .004),
          beveled_box((X0 - .1, DEPTH - .09, Z0 - .035), (X1 + .1, DEPTH + .1, Z0 + .003), .006))
scene.add(frame, "window frame")

# ---- the study
scene.add(rug(2.1, 1.5, "carpet-red").at(1.95, 2.35, 0, 8), "rug")
scene.add(armchair("fabric-mustard", "fabric-rust").at(2.2, 2.95, .0125, -52), "armchair")
scene.add(Piece().include(bookcase(1.0, 2.0, seed=5, wood="walnut").at(WIDTH - .17, 1.5, .003, -90),
                          bookcase(1.0, 2.0, seed=8, wood="walnut").at(WIDTH - .17, 2.54, .003, -90)), "books")
scene.add(table(1.2, .6, wood="walnut").at(.45, 3.05, .003, 90), "desk")
scene.add(chair("walnut", "leather").at(1.08, 2.95, .003, 115), "chair")
scene.add(round_table(.3, .58, "walnut").at(3.02, 3.85, .0025), "side table")
lamp, at = globe_lamp(.4, .075, "paint-black")
scene.add(lamp.at(3.02, 3.85, .583), "lamp")
scene.light(sphere(.075, 1, smooth=False).at(3.02, 3.85, .583 + at[2]), 26, 2600, "table lamp")
scene.add(Piece().include(book_stack(4, 3).at(.42, 2.95, .744, 20), cup("ceramic").at(.62, 3.22, .744),
                          vase(.26, "ceramic").at((X0 + X1) / 2 + .37, DEPTH - .01, Z0 + .0035)), "small things")
scene.add(Piece(("paper", box((.5, 2.6, .7405), (.7, 2.88, .7445)))), "papers")
scene.add(Piece().include(picture(.62, .48, seed=4).turn(90).at(.0005, 2.75, 1.55),
                          picture(.4, .5, "oak", seed=9).at(3.2, DEPTH - .0005, 1.62)),
          "pictures")
scene.add(plant(1.1, 16, .16, seed=6).at(.5, 3.95, .003), "plant")

if __name__ == "__main__":
    scene.main(__file__)
