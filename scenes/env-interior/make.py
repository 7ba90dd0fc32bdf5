#!/usr/bin/env python3
"""Writes env-interior.pbrt and its sky: a living room lit by the sky through a window, and by lamps further inside."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (armchair, book_stack, cupboard, curtain, curtain_rod, door_frame, door_leaf, fruit_bowl,
                       globe_lamp, globe_pendant, picture, plant, radiator, round_table, rug, sofa, vase, window_frame)
from instancing import place_ply
from scenekit import (Mesh, Piece, Random, Scene, box, cylinder, diffuse, normalized, number, numbers, planks, quad,
                      room,
                      skirting, sphere)
from skykit import sky_image

WIDTH, DEPTH, HEIGHT = 5.4, 4.6, 2.7
WALL = .3
WIN = (1.15, 3.15, .72, 2.38)        # in the west wall: from, to (y), sill, top
DOOR = (4.0, 4.86)                   # in the north wall (x)
SKY = 88                             # pixels along one side


def sky(direction):
    """Radiance of the sky towards a direction, z up: a bright horizon, a blue zenith, a low sun in haze."""
    x, y, z = direction
    sun = normalized((-.86, -.2, .5))
    c = max(min(x * sun[0] + y * sun[1] + z * sun[2], 1.0), -1.0)
    angle = math.degrees(math.acos(c))
    disc = 2900 / (1 + math.exp((angle - 2.0) / .3))
    glow = 2.2 * math.exp(-angle / 9) + .6 * math.exp(-angle / 30)
    t = max(z, 0) ** .45
    haze = max(0.0, 1 + 2 * min(z, 0))  # below the horizon it darkens slowly: the garden hides that part
    base = tuple(haze * (a + (b - a) * t) for a, b in zip((.86, .93, 1.0), (.24, .42, .9)))
    return tuple(b + glow * g + disc * d for b, g, d in zip(base, (1, .82, .55), (1, .86, .66)))


scene = Scene("env-interior", "A living room lit through its window by a hazy sun and sky (infinite light), and by four"
              " lamps, one of them in the passage.", maxdepth=7, iso=130, whitebalance=5200)
scene.camera((5.0, .32, 1.5), (2.0, 3.15, 1.0), 58)
scene.material("paint-soft", diffuse(.7, .68, .62))
scene.material("grass", diffuse(.1, .17, .045))
scene.material("roof", diffuse(.24, .11, .08))
scene.material("paint-sage", diffuse(.43, .5, .43))
scene.files["env-interior-sky.pfm"] = sky_image(SKY, sky)
scene.raw('# light 1: the sky\nLightSource "infinite" "string filename" "env-interior-sky.pfm" "float scale" 1.15')
scene.lights += 1

# ---- living room and passage
scene.add(room(WIDTH, DEPTH, HEIGHT, {"w": [WIN], "n": [(*DOOR, 0, 2.05)]}, thickness=WALL,
               paint={"s": "paint-soft", "w": "paint-soft", "n": "paint-sage", "e": "paint-soft"}), "living room")
scene.add(room(3.2, 1.7, HEIGHT - .005, thickness=.15, walls="nwe", floor=None,
               paint="wall-warm").at(3.0, DEPTH + WALL), "passage")
scene.add(Piece(("floor", box((2.95, DEPTH + WALL + .001, -.19), (6.25, DEPTH + WALL + 1.75, -.001)))), "its floor")
scene.add(planks(0, 0, WIDTH, DEPTH, width=.2, length=2.3, seed=6), "boards")
scene.add(planks(3.0, DEPTH, 6.2, DEPTH + WALL + 1.7, width=.2, length=2.3, seed=7), "boards of the passage")
scene.add(skirting(WIDTH, DEPTH, {"n": [(DOOR[0] - .07, DOOR[1] + .07)]}), "skirting")
scene.add(Piece().include(door_frame(DOOR[1] - DOOR[0], 2.05, WALL).at(DOOR[0], DEPTH + WALL / 2),
                          door_leaf(DOOR[1] - DOOR[0] - .03, 2.02).at(DOOR[0] + .015, DEPTH + WALL + .03, .004, 82)),
          "door")
w, h = WIN[1] - WIN[0], WIN[3] - WIN[2]
scene.add(window_frame(w, h, WALL, columns=3, rows=2).turn(90).at(-WALL / 2, WIN[0], WIN[2]), "window")
scene.add(Piece().include(curtain(.5, 2.32, 5, .05, seed=1).turn(90).at(.12, WIN[0] - .22, .06),
                          curtain(.5, 2.32, 5, .05, seed=2).turn(90).at(.12, WIN[1] + .22, .06),
                          curtain_rod(w + 1.1).turn(90).at(.12, (WIN[0] + WIN[1]) / 2, 2.41)), "curtains")
scene.add(radiator(1.2, .42).turn(90).at(.0, (WIN[0] + WIN[1]) / 2, .003), "radiator")

# ---- the garden, as far as the window shows it
random = Random(31)
LAWN = -.55


def tree(random, x, y, height, crown):
    """A trunk and a crown of many spheres."""
    scene.add(Piece(("walnut", cylinder(height * .03, -.1, height * .6, 10))).at(x, y, LAWN), "tree")
    for _ in range(42):
        a, r, up = random.uniform(0, 2 * math.pi), crown * math.sqrt(random.unit()), random.uniform(-1, 1)
        r *= math.sqrt(1 - .8 * up * up)
        leaf = random.pick(("leaf", "leaf", "leaf-light"))
        scene._use(leaf)
        p = (x + r * math.cos(a), y + r * math.sin(a), LAWN + height * (.72 + .24 * up))
        scene.raw(f'AttributeBegin Translate {numbers(p)} '
                  f'NamedMaterial "{leaf}" Shape "sphere" "float radius" '
                  f'{number(crown * random.uniform(.14, .3), 3)} AttributeEnd')


def house(width, depth, eaves, ridge, paint):
    """The ridge runs along y; windows look to +x."""
    x, y = depth / 2, width / 2
    piece = Piece((paint, box((-x, -y, -.5), (x, y, eaves))),
                  ("roof", quad((x + .4, -y - .3, eaves - .3), (x + .4, y + .3, eaves - .3),
                  (0, y + .3, ridge), (0, -y - .3, ridge))),
                  ("roof", quad((-x - .4, y + .3, eaves - .3), (-x - .4, -y - .3, eaves - .3),
                                                                        (0, -y - .3, ridge), (0, y + .3, ridge))))
    for s in (-1, 1):
        gable = Mesh([(-x, s * y, eaves - .02), (x, s * y, eaves - .02), (0, s * y, ridge - .12)],
                     [(0, 1, 2) if s < 0 else (1, 0, 2)])
        piece.add(paint, gable)
    for k in range(3):
        for z in (1.0, 3.4):
            c = (k - 1) * width * .3
            piece.add("paint-white", box((x - .01, c - .65, z), (x + .05, c + .65, z + 1.5)))
            for i in (0, 1):
                piece.add("paint-black", box((x, c - .57 + i * .59, z + .08), (x + .055, c - .02 + i * .59, z + 1.42)))
    return piece


scene.add(quad((-40, -14, LAWN), (-WALL - .02, -14, LAWN), (-WALL - .02, 32, LAWN), (-40, 32, LAWN)), "lawn", "grass")
scene.add(Piece().include(house(9, 7, 5.2, 8.2, "wall-warm").at(-33, 9.5, LAWN),
                          house(8, 7, 5.0, 7.8, "wall-red").at(-34, 20.5, LAWN),
                          house(8, 7, 5.0, 7.6, "wall").at(-33.5, -1, LAWN)), "houses")
scene.add(Piece(("leaf", box((-21.2, -14, LAWN - .1), (-20, 32, LAWN + 1.35)))), "hedge")
for x, y, height, crown in ((-14, 5.6, 5.5, 1.8), (-24, 14.6, 7, 2.3), (-11, 8.6, 4, 1.2)):
    tree(random, x, y, height, crown)

# ---- furniture
scene.add(rug(2.5, 1.8, "carpet-blue", "carpet-sand").at(2.35, 2.55, 0, 3), "rug")
scene.add(sofa(2.1, .9, "fabric-green", 3, ("fabric-mustard", "fabric-rust")).at(2.3, 4.02, .003), "sofa")
scene.add(armchair("fabric-rust", "linen").at(.95, 3.2, .003, 50), "armchair")
scene.add(round_table(.46, .42, "walnut").at(2.3, 2.72, .0145), "low table")
scene.add(Piece().include(fruit_bowl(.14).at(2.2, 2.8, .4355), book_stack(3, 5).at(2.52, 2.62, .4355, 35)),
          "on the table")
scene.add(round_table(.21, .5, "oak", 32).at(.93, 4.2, .003), "side table")
scene.add(Piece().include(plant(1.35, 18, .2, 3).at(.4, 3.95, .003), plant(.42, 12, .08, 8).at(-.1, 1.5, WIN[2] + .005),
                          vase(.27, "ceramic-blue").at(-.08, 2.85, WIN[2] + .005)), "plants, vase")
scene.add(Piece().include(picture(.9, .62, "walnut", 3).at(1.95, DEPTH - .0006, 1.62),
                          picture(.42, .52, "oak", 6).at(2.65, DEPTH - .0006, 1.62),
                          picture(.8, .6, "walnut", 14).at(4.6, DEPTH + WALL + 1.6994, 1.55)), "pictures")
scene.add(cupboard(.9, .34, .8, "oak", 2, 1).at(5.2, DEPTH + WALL + 1.5, .003), "cupboard in the passage")

# ---- lamps
def lamp(piece_and_place, label, radius, x, y, z, watts, kelvin):
    piece, at = piece_and_place
    place_ply(scene, label.replace(" ", "-"), piece, x, y, z)
    scene.light(sphere(radius, 1, smooth=False).at(x + at[0], y + at[1], z + at[2]), watts, kelvin, label)


lamp(globe_lamp(1.5, .09, "paint-black"), "floor lamp", .09, 3.66, 4.15, .0035, 11, 2700)
lamp(globe_lamp(.36, .06, "paint-black"), "side lamp", .06, .93, 4.2, .5035, 7, 2600)
lamp(globe_pendant(.78, .13, "paint-black"), "pendant", .13, 2.3, 2.72, HEIGHT, 9, 2800)
lamp(globe_lamp(.42, .065, "paint-black"), "passage lamp", .065, 5.0, DEPTH + WALL + 1.5, .8035, 20, 2600)

if __name__ == "__main__":
    scene.main(__file__)
