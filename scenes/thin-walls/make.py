#!/usr/bin/env python3
"""Writes thin-walls.pbrt: desks in a loft, parted by plywood 1 cm thick."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (book_stack, bookcase, chair, cup, cupboard, globe_lamp, picture, plant, rug, table,
                       wall_shelf)
from instancing import define, place, place_ply
from scenekit import Piece, Random, Scene, beveled_box, box, cylinder, diffuse, planks, room, skirting, sphere, wall

WIDTH, DEPTH, HEIGHT = 8.6, 8.8, 5.2
PLY, TALL = .01, 1.75                      # the partitions
COLUMNS = (1.5, 3.85, 6.2, 8.55)           # x of the cross walls
ROWS = ((1.9, 3.75), (3.75, 5.6), (7.0, 8.8))

scene = Scene("thin-walls", "Nine desks parted by plywood 1 cm thick, a lamp close to it on either side:"
              " thinner than any voxel, so a cell holds points of both sides.", maxdepth=5, whitebalance=4100)
scene.camera((.9, .25, 4.95), (4.5, 4.6, .25), 50)
scene.material("ply", diffuse(.63, .52, .38))
scene.material("brick", diffuse(.45, .27, .21))
scene.material("screen-dark", diffuse(.03, .03, .035))

scene.add(room(WIDTH, DEPTH, HEIGHT, paint={"s": "brick", "w": "brick", "n": "brick", "e": "brick"}), "loft")
scene.add(planks(0, 0, WIDTH, DEPTH, width=.2, length=2.4, seed=3), "floor")
scene.add(skirting(WIDTH, DEPTH, material="trim"), "skirting")
scene.add(Piece().include(*[Piece(("pine", box((x, -.01, HEIGHT - .24), (x + .16, DEPTH + .01, HEIGHT + .01))))
                            for x in (1, 3.1, 5.2, 7.3)]), "beams")

# ---- partitions: the spine between the first two rows, cross walls, and the far row's
t = PLY / 2
ply = Piece(("ply", wall((COLUMNS[0] - t, 3.75), (WIDTH + .01, 3.75), PLY, TALL, base=-.01)))
for x in COLUMNS[:-1]:
    for y0, y1 in ((1.9, 3.75 - t + .001), (3.75 + t - .001, 5.6), (7.0, DEPTH + .01)):
        ply.add("ply", wall((x, y0), (x, y1), PLY, TALL, base=-.01))
scene.add(ply, "partitions")
posts = Piece()
for x in COLUMNS[:-1]:
    for y in (1.9, 5.6, 7.0):
        posts.add("iron", box((x - .02, y - .02, -.01), (x + .02, y + .02, TALL + .012)))
scene.add(posts, "posts")

# ---- things that stand there more than once
SEATS = ("fabric-grey", "fabric-rust", "fabric-blue")
for fabric in SEATS:
    define(scene, f"chair-{fabric}", chair("oak", fabric))
define(scene, "desk", table(1.55, .66, .74, "oak", .05))
define(scene, "monitor", Piece(("screen-dark", beveled_box((-.29, -.02, .12), (.29, .012, .47), .006)),
                               ("steel", box((-.025, .012, .002), (.025, .03, .3))),
                               ("steel", beveled_box((-.11, -.07, 0), (.11, .09, .01), .003))))
define(scene, "keyboard", Piece(("paint-white", beveled_box((-.21, -.065, 0), (.21, .065, .016), .004))))
define(scene, "drawers", cupboard(.42, .5, .6, "paint-white", 1, 3, legs=.05))
define(scene, "bin", Piece(("paint-teal", cylinder(.12, 0, .3, 24, .15))))

# ---- nine desks; each lamp stands a hand's breadth from the wood
random, small = Random(21), Piece()
for i in range(3):
    x0, x1 = COLUMNS[i], COLUMNS[i + 1]
    for j, (y0, y1) in enumerate(ROWS):
        cold = (i + j) % 2 == 1
        toward = 1 if j != 1 else -1             # the side on which the desk stands: +y or -y
        edge = (3.75, 3.75, DEPTH)[j] - toward * (.012 if j < 2 else .025)
        y = edge - toward * .335
        x = (x0 + x1) / 2 + random.uniform(-.12, .12)
        turn = 0 if toward > 0 else 180
        place(scene, "desk", x, y, .0025, turn)
        place(scene, f"chair-{SEATS[(i * 2 + j) % 3]}", x + random.uniform(-.15, .2),
              y - toward * random.uniform(.52, .68), .0025,
              turn + 180 + random.uniform(-50, 50))
        place(scene, "monitor", x + .05, y + toward * .12, .743, turn + random.uniform(-9, 9))
        place(scene, "keyboard", x + .03, y - toward * .16, .743, turn + random.uniform(-5, 5))
        place(scene, "drawers", x + toward * .52, y + toward * .03, .0025, turn)
        place(scene, "bin", x - toward * .95, y - toward * .1, .0025)
        lx, ly = x - toward * .6, edge - toward * .17
        lamp, at = globe_lamp(.43, .055, "paint-black")
        place_ply(scene, "desk-lamp", lamp, lx, ly, .7425)
        scene.light(sphere(.055, 1, smooth=False).at(lx, ly, .7425 + at[2]), random.uniform(19, 30),
                    6200 if cold else 2600, "desk lamp")
        small.include(cup(("ceramic", "ceramic-blue", "terracotta")[(i + j) % 3]).at(x + toward * .38,
                                                                                     y - toward * .12, .7425),
                      book_stack(random.integer(3) + 2, 7 * i + j).at(x + toward * .62, y + toward * .1, .7425,
                                                                      random.uniform(0, 90)))
        if (i + j) % 3 == 0:
            small.include(plant(.34, 9, .055, 5 + i + j).at(x - toward * .35, y + toward * .2, .7425))
        if j == 2 or i == 1:
            small.include(picture(.5, .4, ("walnut", "oak")[i % 2], 3 * i + j).turn(0 if toward > 0 else 180).at(
                x + .1, (DEPTH if j == 2 else 3.75 - toward * t) - toward * .0006, 1.45))
        if j < 2 and i != 1:
            shelf = wall_shelf(.9, .2, "oak", 5 * i + j + 2).turn(0 if toward > 0 else 180)
            small.include(shelf.at(x + toward * .1, 3.75 - toward * (t + .0005), 1.4))

# ---- second lamps, low and close to the cross walls, one on either side
for x, y, watts, kelvin in ((COLUMNS[1] - .13, 2.35, 13, 2400), (COLUMNS[1] + .13, 2.35, 13, 6800),
                            (COLUMNS[2] - .13, 5.15, 13, 2400),
                            (COLUMNS[2] + .13, 5.15, 13, 6800), (COLUMNS[1] - .13, 7.5, 12, 7500),
                            (COLUMNS[1] + .13, 7.5, 12, 2400)):
    lamp, at = globe_lamp(1.15, .045, "paint-black")
    place_ply(scene, "floor-lamp", lamp, x, y, .0025)
    scene.light(sphere(.045, 1, smooth=False).at(x, y, .0025 + at[2]), watts, kelvin, "floor lamp")

scene.add(small, "on the desks and walls")
scene.add(Piece().include(rug(1.9, 1.2, "carpet-blue").at(3.4, .95, 0, 4),
                          rug(2.4, .9, "carpet-sand", "carpet-red").at(5.6, 6.3, 0, -1)), "rugs")
scene.add(Piece().include(plant(1.25, 18, .19, 3).at(.5, 5.1, .0025), plant(1.1, 16, .17, 4).at(8.15, 6.3, .0025),
                          plant(1.3, 18, .19, 9).at(.55, 8.3, .0025)),
          "plants")
scene.add(Piece().include(bookcase(1.1, 1.9, seed=4).at(.17, 6.7, .0025, 90),
                          picture(1.3, .9, "walnut", 8).turn(-90).at(WIDTH - .0006, 4.6, 2.9),
                          picture(.9, 1.2, "oak", 5).turn(-90).at(WIDTH - .0006, 2.4, 2.8),
                          picture(1.4, 1.0, "oak", 12).at(4.2, DEPTH - .0006, 2.75)), "along the walls")

if __name__ == "__main__":
    scene.main(__file__)
