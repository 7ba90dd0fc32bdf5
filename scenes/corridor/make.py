"""A corridor of 12 m between closed doors, lit by an overcast sky through the window at its far end."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (bench, cupboard, curtain, curtain_rod, door_frame, door_leaf, picture, plant, radiator, stool,
                       vase, window_frame)
from scenekit import Piece, Scene, box, diffuse, planks, quad, room, skirting
from skykit import overcast_sky, portal_variant, sky_image, sky_light

W, L, H, T = 2.1, 12.0, 2.6, .3
WINDOW = (.45, 1.65, .85, 2.35)                             # in the north wall: from, to, sill, top
DOORS = {"w": (1.3, 4.6, 7.9), "e": (2.4, 5.7, 9.0)}        # along y

ABOUT = "A corridor of 12 m between closed doors, lit by an overcast sky through the window at its far end"
scene = Scene("corridor", f"{ABOUT}.", 480, 320, spp=64, maxdepth=9, iso=12000, whitebalance=6500)
scene.camera((1.2, .3, 1.5), (1.02, 8, 1.18), 56)
scene.material("wall-paper", diffuse(.84, .81, .72))
scene.material("end-wall", diffuse(.8, .8, .77))
scene.material("lower-wall", diffuse(.6, .7, .66))
scene.material("door-paint", diffuse(.72, .7, .64))
for name, colour in (("plank-a", (.62, .5, .36)), ("plank-b", (.57, .45, .32)), ("plank-c", (.67, .55, .4))):
    scene.material(name, diffuse(*colour))
sky_light(scene, sky_image(64, overcast_sky()), label="the overcast sky")

scene.add(room(W, L, H, {"n": [WINDOW]}, T,
               paint={"s": "wall-paper", "w": "wall-paper", "n": "end-wall", "e": "wall-paper"}), "shell")
scene.add(planks(0, 0, W, L, width=.15, length=1.8, seed=8), "floor boards")
scene.add(window_frame(WINDOW[1] - WINDOW[0], WINDOW[3] - WINDOW[2], T, "paint-white", 2, 2)
          .at(WINDOW[0], L + T / 2, WINDOW[2]), "window")
scene.add(radiator(1.1, .45).at(1.05, L, .003), "radiator")
scene.add(Piece().include(curtain(.3, 2.2, 4, .035, seed=1).at(.28, L - .13, .1),
                          curtain(.3, 2.2, 4, .035, seed=2).at(1.82, L - .13, .1),
                          curtain_rod(1.9, "brass").at(1.05, L - .13, 2.42)), "curtains")

for side, turn, x, sign in (("w", 90, 0.0, 1), ("e", -90, W, -1)):
    gaps = [(y - .07, y + .97) for y in DOORS[side]]
    scene.add(skirting(W, L, {side: gaps}, .12, walls=side), f"skirting {side}")
    cuts = [0.0] + [c for gap in gaps for c in gap] + [L]
    panels = Piece()
    for a, b in zip(cuts[::2], cuts[1::2]):
        lo, hi = sorted((x - .002 * sign, x + .008 * sign))
        panels.add("lower-wall", box((lo, a, .119), (hi, b, .95)))
        lo, hi = sorted((x - .002 * sign, x + .022 * sign))
        panels.add("trim", box((lo, a, .949), (hi, b, 1.0)))
    scene.add(panels, f"lower wall {side}")
    doors = Piece()
    for y in DOORS[side]:
        start = y if side == "w" else y + .9
        doors.include(door_frame(.9, 2.02, .05).turn(turn).at(x + .015 * sign, start),
                      door_leaf(.874, 2.0, "door-paint", handles="brass").turn(turn)
                      .at(x + .022 * sign, start + .013 * sign, .004))
    scene.add(doors, f"doors {side}")

runner = Piece(("carpet-sand", box((.5, .3, -.002), (W - .5, L - .5, .008))),
               ("carpet-blue", quad((.57, .37, .0086), (W - .57, .37, .0086), (W - .57, L - .57, .0086),
                                   (.57, L - .57, .0086))))
for k in range(14):
    y = .75 + .8 * k
    runner.add("carpet-sand", quad((W / 2, y - .24, .0092), (W / 2 + .24, y, .0092), (W / 2, y + .24, .0092),
                                   (W / 2 - .24, y, .0092)))
scene.add(runner, "runner")
scene.add(bench(1.3, .36, .45, "oak").turn(90).at(.22, 3.35, .003), "bench")
scene.add(cupboard(1.0, .32, .82, "walnut", 2, 1).turn(-90).at(W - .19, 7.7, .003), "cupboard")
scene.add(vase(.34, "ceramic-blue").at(W - .18, 7.55, .8235), "vase")
scene.add(stool(.17, .45).at(.28, 6.9, .003), "stool")
scene.add(plant(1.1, 16, .17, 5).at(.32, 10.3, .003), "plant")
scene.add(plant(.7, 12, .14, 11).at(W - .3, 4.5, .003), "second plant")
for side, y, width, height, seed in (("w", 3.35, .8, .55, 3), ("w", 6.75, .45, .6, 7), ("e", 4.5, .5, .65, 12),
                                     ("e", 7.7, .7, .5, 14), ("w", 10.2, .6, .45, 6), ("e", 1.3, .7, .5, 21)):
    art = picture(width, height, "walnut", seed)
    scene.add(art.turn(90).at(.0006, y, 1.62) if side == "w" else art.turn(-90).at(W - .0006, y, 1.62),
              f"picture {side} {seed}")

# Clockwise as the sky sees it, in the outer plane of the wall.
portal_variant(scene, [(WINDOW[0], L + T, WINDOW[2]), (WINDOW[1], L + T, WINDOW[2]),
                       (WINDOW[1], L + T, WINDOW[3]), (WINDOW[0], L + T, WINDOW[3])], f"{ABOUT}; a portal in it.")
scene.main(__file__)
