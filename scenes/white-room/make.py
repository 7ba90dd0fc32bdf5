"""A white living room by day: three windows, three panels in the ceiling, a pendant and a lamp in an alcove."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *
from furniture import *

scene = Scene("white-room", "A white living room with eight area lights: daylight in three windows, three ceiling "
              "panels, a pendant, a lamp in an alcove.", 640, 360, maxdepth=7, iso=50, whitebalance=5000)
W, D, H, T = 6.6, 5.6, 2.7, 0.3
scene.material("white", diffuse(.82, .82, .8))
scene.material("white-floor", diffuse(.62, .58, .52))
for name, colour in (("plank-a", (.58, .5, .4)), ("plank-b", (.54, .46, .36)), ("plank-c", (.62, .54, .44))):
    scene.material(name, diffuse(*colour))
scene.camera((5.75, 0.45, 1.5), (2.4, 5.0, 1.02), 52)

WINDOWS = [(0.7, 2.0), (2.5, 3.8)]  # in the west wall, along y
scene.add(room(W, D, H, {"w": [(a, b, 0.45, 2.35) for a, b in WINDOWS], "n": [(0.55, 2.0, 0.45, 2.35)]}, T,
               paint="white", floor="white-floor", ceiling="white"), "shell")
scene.add(planks(0, 0, W, D, width=0.18, length=1.9), "floor boards")
scene.add(skirting(W, D, {"e": [(3.9, 5.6)]}, 0.1), "skirting")

# An alcove in the north-east corner, behind a wall that stands out into the room.
scene.add(wall((4.55, D + 0.02), (4.55, 3.75), 0.14, H + 0.02, base=-0.02), "wall of the alcove", "white")
scene.add(wall((5.75, 3.82), (W + 0.02, 3.82), 0.14, H + 0.02, base=-0.02), "second wall of the alcove", "white")
scene.add(wall((4.62, 3.82), (5.76, 3.82), 0.14, H + 0.02, base=2.1), "lintel of the alcove", "white")

# Windows: frames in the reveals, a lit pane behind each as sky.
for k, (a, b) in enumerate(WINDOWS):
    frame = window_frame(b - a, 1.9, T, "paint-white", 2, 3)
    scene.add(frame.turn(90).at(-T / 2, a, 0.45), f"window {k}")
    pane = quad((-T - 0.12, a - 0.2, 0.3), (-T - 0.12, b + 0.2, 0.3), (-T - 0.12, b + 0.2, 2.5),
                (-T - 0.12, a - 0.2, 2.5))
    scene.light(pane, 130, 6500, f"daylight, window {k + 1}")
scene.add(window_frame(1.45, 1.9, T, "paint-white", 2, 3).at(0.55, D + T / 2, 0.45), "window 2")
pane = quad((.35, D + T + .12, .3), (2.2, D + T + .12, .3), (2.2, D + T + .12, 2.5), (.35, D + T + .12, 2.5))
scene.light(pane, 110, 7000, "daylight, north window")
for y0, seed in ((0.45, 1), (2.25, 2), (4.05, 3)):
    scene.add(curtain(0.42, 2.35, 5, 0.04, "curtain", seed).turn(90).at(0.16, y0, 0.03), f"curtain {seed}")
scene.add(curtain_rod(4.4, "steel").turn(90).at(0.16, 2.25, 2.42), "curtain rod")

# Ceiling panels in white trays, a pendant over the dining table, a lamp in the alcove.
for k, (x, y) in enumerate(((4.6, 1.5), (4.6, 2.9), (2.0, 1.6))):
    scene.add(box((x - .33, y - .33, H - .05), (x + .33, y + .33, H + .003)), f"tray {k}", "paint-white")
    scene.light(panel(0.6, 0.6, 2, 2, down=True).at(x, y, H - .0515), 25, 4500, f"ceiling panel {k + 1}")
lamp, at = globe_pendant(0.85, 0.14, "steel")
scene.add(lamp.at(3.2, 4.35, H), "pendant")
scene.light(bulb(0.14, 2).at(3.2, 4.35, H + at[2]), 20, 3200, "pendant")
lamp, at = globe_lamp(0.42, 0.08, "steel")
scene.add(lamp.at(5.75, D - 0.3, 0.7805), "lamp of the alcove")
scene.light(bulb(0.08, 2).at(5.75, D - 0.3, 0.7805 + at[2]), 16, 2900, "lamp of the alcove")

# Furniture.
scene.add(sofa(2.1, 0.9, "linen", 3, ("fabric-blue", "fabric-mustard")).turn(90).at(1.05, 2.25), "sofa")
scene.add(rug(2.4, 1.9, "fabric-grey", "linen").at(2.7, 2.2), "rug")
scene.add(round_table(0.5, 0.4, "oak").at(2.55, 2.3, 0.014), "low table")
scene.add(vase(0.3, "ceramic-blue").at(2.66, 2.42, 0.4145), "vase")
scene.add(book_stack(3, 4).at(2.36, 2.2, 0.4145, 40), "books")
scene.add(armchair("fabric-blue", "linen").at(3.8, 2.7, 0, -72), "armchair")
scene.add(table(1.7, 0.9, 0.75, "oak").at(3.2, 4.35), "dining table")
for k, (x, y, turn) in enumerate(((2.8, 3.72, 180), (3.6, 3.7, 176), (2.8, 5.0, 0), (3.6, 5.02, 4), (2.1, 4.35, 92))):
    scene.add(chair("paint-white", "linen").at(x, y, 0, turn), f"chair {k}")
scene.add(fruit_bowl(0.17).at(3.2, 4.35, 0.7505), "fruit bowl")
scene.add(picture(1.1, 0.75, "oak", seed=12).at(3.2, D, 1.6), "picture")
scene.add(plant(1.15, 16, 0.19, 7).at(0.55, 4.85), "plant")
scene.add(plant(0.8, 12, 0.15, 9).at(4.2, 5.2), "second plant")
scene.add(cupboard(1.5, 0.42, 0.78, "oak", 3, 1).at(5.6, D - 0.22), "chest in the alcove")
scene.add(picture(0.6, 0.45, "walnut", seed=3).at(5.25, D, 1.55), "picture in the alcove")
scene.add(book_stack(4, 9).at(5.25, D - 0.24, 0.7805, 80), "books in the alcove")
scene.main(__file__)
