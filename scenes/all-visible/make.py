#!/usr/bin/env python3
"""Writes all-visible.pbrt: a tea room under ten globe lamps."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from instancing import place_ply
from scenekit import (Piece, Random, Scene, beveled_box, box, coated, cylinder, diffuse, lathe, planks, quad, room,
                      skirting, sphere, tube)

WIDTH, DEPTH, HEIGHT = 6.4, 5.2, 2.9

scene = Scene("all-visible", "A tea room under ten globe lamps that see nearly every point: knowing what is hidden buys"
              " nothing here.", maxdepth=6, whitebalance=3900)
scene.camera((.75, .3, 1.66), (3.55, 3.1, 1.03), 52)
for name, text in {"clay": diffuse(.66, .55, .43), "clay-dark": diffuse(.34, .25, .2), "lattice": diffuse(.2, .12, .07),
                   "screen": diffuse(.82, .78, .68), "cushion-blue": diffuse(.08, .13, .25),
                   "cushion-red": diffuse(.42, .09, .07),
                   "cushion-straw": diffuse(.58, .47, .26), "tea-pot": coated(.05, .09, .085, .1),
                   "cup": coated(.6, .58, .52, .1),
                   "tray": coated(.25, .04, .03, .08), "table-top": coated(.24, .13, .07, .12)}.items():
    scene.material(name, text)

scene.add(room(WIDTH, DEPTH, HEIGHT, paint={"s": "clay", "w": "clay", "n": "clay", "e": "clay"}), "room")
scene.add(planks(0, 0, WIDTH, DEPTH, width=.18, length=2.1, seed=5), "floor")
scene.add(skirting(WIDTH, DEPTH, height=.1, material="lattice"), "skirting")


def cushion(material):
    return Piece((material, lathe([(0, 0), (.22, .004), (.285, .03), (.3, .06), (.285, .09), (.22, .112), (.03, .098),
                                   (0, .094)], 32, 60)))


def paper_wall(width, height, columns, rows):
    """A lattice of wood over pale paper, standing on z = 0 against y = 0, facing -y."""
    piece = Piece(("screen", box((.01, -.012, .01), (width - .01, .004, height - .01))))
    for i in range(columns + 1):
        x, w = width * i / columns, .03 if i in (0, columns) else .011
        piece.add("lattice", box((x - w, -.03, 0), (x + w, .002, height)))
    for j in range(rows + 1):
        z, w = height * j / rows, .03 if j in (0, rows) else .011
        piece.add("lattice", box((.02, -.027, z - w), (width - .02, .001, z + w)))
    return piece


def low_table(length, width, height):
    piece = Piece(("table-top", beveled_box((-length / 2, -width / 2, height - .045), (length / 2, width / 2, height),
                                            .008)))
    for sx in (-1, 1):
        x = sx * (length / 2 - .22)
        piece.add("walnut", beveled_box((x - .05, -width / 2 + .12, -.001), (x + .05, width / 2 - .12, height - .044),
                                        .006))
    return piece.add("walnut", box((-length / 2 + .2, -.03, height - .11), (length / 2 - .2, .03, height - .06)))


def tea_pot():
    piece = Piece(("tea-pot", lathe([(0, 0), (.06, 0), (.085, .025), (.095, .055), (.08, .09), (.04, .103),
                                     (.038, .108), (.012, .113),
                                     (.016, .124), (.01, .133), (0, .134)], 40, 50)))
    piece.add("tea-pot", tube((.08, 0, .045), (.15, 0, .1), .012, 12))
    points = [(.085 * math.cos(a), 0, .1 + .1 * math.sin(a)) for a in (math.pi * k / 12 for k in range(13))]
    return piece.add("brass", *[tube(a, b, .005, 8) for a, b in zip(points, points[1:])])


def cup():
    return Piece(("cup", lathe([(0, 0), (.02, 0), (.022, .006), (.036, .03), (.04, .062), (.037, .062), (.033, .03),
                                (.018, .011), (0, .01)], 32)))


def bamboo(random, height):
    """Stalks in a pot."""
    pot = lathe([(0, 0), (.15, 0), (.19, .3), (.2, .34), (.185, .34), (.17, .3), (0, .3)], 32)
    piece = Piece(("clay-dark", pot))
    for k in range(9):
        a, r = random.uniform(0, 2 * math.pi), random.uniform(.02, .13)
        foot = (r * math.cos(a), r * math.sin(a), .29)
        h = height * random.uniform(.6, 1)
        top = (foot[0] * 2.6, foot[1] * 2.6, .3 + h)
        piece.add("leaf-light", tube(foot, top, .009, 8))
        for i in range(16):
            t = random.uniform(.35, 1)
            p = tuple(f + (q - f) * t for f, q in zip(foot, top))
            b, l = random.uniform(0, 2 * math.pi), random.uniform(.14, .26)
            d = (math.cos(b), math.sin(b))
            tip = (p[0] + d[0] * l, p[1] + d[1] * l, p[2] - l * random.uniform(.1, .7))
            mid = tuple((p[i] + tip[i]) / 2 for i in range(2)) + ((p[2] + tip[2]) / 2 + .03,)
            w = .014
            side = (-d[1] * w, d[0] * w)
            left, right = (mid[0] + side[0], mid[1] + side[1], mid[2]), (mid[0] - side[0], mid[1] - side[1], mid[2])
            piece.add("leaf", quad(p, right, tip, left))
    return piece


scene.add(Piece().include(paper_wall(2.7, 2.1, 9, 7).at(.55, DEPTH, 0), paper_wall(2.7, 2.1, 9, 7).at(3.4, DEPTH, 0)),
          "paper walls")
scene.add(paper_wall(3.4, 2.1, 11, 7).turn(-90).at(WIDTH, DEPTH - .9, 0), "paper wall at the side")
scene.add(Piece().include(*[Piece(("lattice", box((x, -.01, HEIGHT - .13), (x + .12, DEPTH + .01, HEIGHT + .01))))
                            for x in (.9, 2.4, 3.9, 5.4)]), "beams")

TABLE = (3.45, 2.85, .37)
scene.add(low_table(2.5, .95, TABLE[2]).at(TABLE[0], TABLE[1]), "table")
seats, random = [], Random(8)
for k, x in enumerate((-.85, 0, .85)):
    for s in (-1, 1):
        seats.append((("blue", "straw", "red")[(k + (s > 0)) % 3], TABLE[0] + x + random.uniform(-.06, .06),
                      TABLE[1] + s * random.uniform(.82, .92), .0025))
for colour, x, y, z in seats + [("red", TABLE[0] + 1.68, TABLE[1] + .1, .0025), ("blue", 5.7, .9, .0025),
                                ("straw", 5.72, .92, .1155),
                                ("blue", 1.1, 4.55, .0025), ("red", 1.12, 4.53, .1155)]:
    place_ply(scene, "cushion", cushion(f"cushion-{colour}"), x, y, z)
things = Piece().include(tea_pot().at(TABLE[0] - .1, TABLE[1] + .05, TABLE[2] + .013, 200))
things.add("tray", lathe([(0, 0), (.2, 0), (.22, .022), (.214, .022), (.197, .008), (0, .008)], 48).stretch(1.25, .8,
                                                                                                            1).at(
    TABLE[0] - .06, TABLE[1] + .04, TABLE[2] + .001))
for x, y in ((.05, -.02), (-.72, .27), (-.9, -.28), (.1, .32), (.05, -.33), (.78, .28), (.86, -.27)):
    place_ply(scene, "cup", cup(), TABLE[0] + x, TABLE[1] + y, TABLE[2] + (.0095 if x == .05 and y > -.1 else .001))
things.add("ceramic-blue", lathe([(0, 0), (.05, 0), (.1, .03), (.13, .075), (.126, .075), (.095, .033), (.04, .008),
                                  (0, .007)], 40).at(
    TABLE[0] + .55, TABLE[1] - .02, TABLE[2] + .001))
for k in range(7):
    a = 2 * math.pi * k / 6
    r = .055 if k < 6 else 0
    things.add("fabric-rust", sphere(.031, 2).at(TABLE[0] + .55 + r * math.cos(a), TABLE[1] - .02 + r * math.sin(a),
                                                 TABLE[2] + (.058 if k < 6 else .085)))
scene.add(things, "on the table")
scene.add(bamboo(Random(3), 1.25).at(5.85, 4.65, .002), "bamboo")
scene.add(Piece().include(Piece(("oak", beveled_box((0, 0, 0), (.34, 1.5, .4), .006)), ("ceramic", lathe(
    [(0, .4), (.06, .4), (.11, .47), (.12, .56), (.07, .66), (.05, .7), (.062, .73), (.055, .73), (.043, .7),
     (0, .69)], 40).at(.17, .35)),
    ("clay-dark", lathe([(0, .4), (.09, .4), (.12, .46), (.09, .53), (.06, .54), (.055, .535), (.08, .5), (0, .48)],
                        40).at(.17, .95)))
    .at(.003, 2.4, .0025)), "sideboard")

# ---- ten lamps; no shade, nothing between them and the room
LAMPS = [  # x, y, z, radius, watts, kelvin
    (1.95, 1.75, 2.05, .08, 9, 2700), (2.35, 3.05, 1.88, .1, 14, 2900), (3.15, 2.35, 1.7, .07, 7, 2400),
    (3.7, 3.3, 2.05, .12, 18, 3000),
    (4.45, 2.55, 1.82, .09, 11, 2700), (5.3, 3.4, 2.2, .08, 8, 3400), (1.45, 4.2, 2.3, .09, 10, 2500),
    (4.9, 1.1, 2.25, .1, 14, 2700),
    (3.0, 4.35, 2.35, .07, 6, 4000), (2.95, 1.05, 2.4, .08, 9, 3200)]
cords = Piece()
for k, (x, y, z, radius, watts, kelvin) in enumerate(LAMPS):
    cords.add("paint-black", tube((x, y, z + radius + .03), (x, y, HEIGHT + .002), .004, 6),
              cylinder(.022, z + radius + .004, z + radius + .06, 12),
              cylinder(.045, HEIGHT - .02, HEIGHT + .004, 16))
    scene.light(sphere(radius, 1, smooth=False).at(x, y, z), 0.95 * watts, kelvin, f"globe {k + 1}")
scene.add(cords, "cords")

if __name__ == "__main__":
    scene.main(__file__)
