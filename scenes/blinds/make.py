"""A study under sun and sky: one window behind venetian blinds, the other behind a curtain that lets light through."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (armchair, book_stack, bookcase, candlestick, chair, cup, curtain, curtain_rod, picture, plant,
                       rug, table, vase, wall_shelf, window_frame)
from scenekit import Piece, Scene, beveled_box, box, cloth, diffuse, planks, room, skirting, tube
from skykit import Sun, clear_sky, sky_image, sky_light

W, D, H, T = 4.4, 3.8, 2.6, .3
BLIND, CURTAIN = (.55, 1.95), (2.85, 3.95)  # windows of the north wall, along x
SILL, TOP = .86, 2.16

scene = Scene("blinds", "A study under sun and sky: a window behind venetian blinds, another behind a curtain.",
              480, 320, spp=64, maxdepth=9, iso=600, whitebalance=5600)
scene.camera((3.75, .35, 1.5), (1.75, 3.6, 1.02), 60)
scene.material("paint-soft", diffuse(.8, .76, .68))
scene.material("paint-blue", diffuse(.52, .62, .68))
scene.material("slat", diffuse(.8, .78, .72))
scene.material("thin-curtain", cloth((.5, .46, .38), (.24, .2, .13)))
sun = Sun(74, 34, radius=.8)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")

scene.add(room(W, D, H, {"n": [(a, b, SILL, TOP) for a, b in (BLIND, CURTAIN)]}, T,
               paint={"s": "paint-soft", "w": "paint-blue", "n": "paint-soft", "e": "paint-soft"}), "shell")
for name, colour in (("plank-a", (.5, .36, .23)), ("plank-b", (.45, .32, .2)), ("plank-c", (.55, .41, .27))):
    scene.material(name, diffuse(*colour))
scene.add(planks(0, 0, W, D, width=.16, length=1.9, seed=5), "floor boards")
scene.add(skirting(W, D, height=.1), "skirting")
for label, (a, b) in (("window with blinds", BLIND), ("window with a curtain", CURTAIN)):
    scene.add(window_frame(b - a, TOP - SILL, T, "paint-white", 2, 1).at(a, D + T / 2, SILL), label)


def blinds(width, height, deep=.05, pitch=.044, tilt=45.0):
    """Slats along x from 0 to width, hanging from z = height to 0 about y = 0; the outer edges (+y) are raised."""
    piece = Piece(("slat", beveled_box((0, -deep / 2, height - .045), (width, deep / 2, height), .004)))
    count = int((height - .05) / pitch)
    slat = box((0, -deep / 2, -.0005), (width, deep / 2, .0005)).turn(tilt, "x")
    for k in range(count):
        piece.add("slat", slat.at(0, 0, height - .07 - k * pitch))
    for x in (width * .14, width * .86):
        for side in (-1, 1):
            y = side * (deep / 2 + .001)
            piece.add("linen", tube((x, y, height - .05), (x, y, height - .07 - (count - 1) * pitch), .0012, 5))
    return piece


scene.add(blinds(BLIND[1] - BLIND[0] - .012, TOP - SILL - .012).at(BLIND[0] + .006, D + .07, SILL + .008), "blinds")
scene.add(curtain(1.62, 2.22, 11, .045, "thin-curtain", 4).at(sum(CURTAIN) / 2, D - .11, .06), "curtain")
scene.add(curtain_rod(1.8, "brass").at(sum(CURTAIN) / 2, D - .11, 2.31), "curtain rod")

scene.add(table(1.5, .72, .74, "walnut").at(1.25, D - .48, .003), "desk")
scene.add(Piece().include(book_stack(4, 6).at(.72, D - .34, .7435, 15), cup("ceramic-blue").at(1.62, D - .62, .7435),
                          candlestick(.22).at(1.86, D - .3, .7435), vase(.26, "ceramic").at(1.0, D - .28, .7435)),
          "on the desk")
scene.add(Piece(("paper", box((1.15, D - .72, .7435), (1.36, D - .42, .7465))),
                ("paper", box((-.105, -.15, 0), (.105, .15, .002)).turn(12).at(1.5, D - .36, .7435))), "papers")
scene.add(chair("walnut", "leather").at(1.3, 2.62, .003, 194), "chair")
scene.add(rug(1.9, 1.3, "carpet-blue", "carpet-sand").at(1.7, 1.95, 0, 4), "rug")
scene.add(armchair("fabric-green", "fabric-mustard").at(3.35, 2.75, .003, -32), "armchair")
scene.add(bookcase(1.0, 2.0, seed=7, wood="walnut").turn(90).at(.148, 2.05, .003), "bookcase")
scene.add(wall_shelf(.9, .22, "walnut", 9).turn(90).at(0, 3.15, 1.62), "shelf")
scene.add(picture(.5, .66, "oak", 12).at(2.4, D - .0006, 1.6), "picture")
scene.add(plant(.95, 14, .16, 3).at(2.4, 3.48, .003), "plant")
scene.main(__file__)
