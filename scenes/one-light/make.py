"""A dining corner with a single lamp: with one light there is nothing to choose."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *
from furniture import *

scene = Scene("one-light", "A dining corner under one pendant lamp: with a single light nothing can be gained by "
              "choosing.",
              480, 360, maxdepth=6, iso=230, whitebalance=3300)
scene.camera((0.55, 0.4, 1.62), (2.55, 3.3, 0.9), 50)
W, D, H = 4.6, 4.2, 2.6

scene.add(room(W, D, H, {"w": [(1.2, 2.1, 0, 2.02)]}, paint={"s": "wall", "n": "wall-red", "w": "wall", "e": "wall"}),
          "shell")
scene.add(planks(0, 0, W, D, length=1.6), "floor boards")
scene.add(skirting(W, D, {"w": [(1.1, 2.2)]}), "skirting")
scene.add(door_frame(0.9, 2.02).turn(90).at(-0.075, 1.2), "door frame")
scene.add(door_leaf(0.88, 2.0).turn(90).at(-0.06, 1.21), "door, shut")
scene.add(rug(2.6, 2.0, "carpet-blue", "carpet-sand").at(2.5, 2.35), "rug")
scene.add(table(1.6, 0.9, 0.75, "oak").at(2.5, 2.35, 0.0138), "dining table")
for k, (x, y, turn) in enumerate(((2.1, 1.72, 178), (2.9, 1.68, 186), (2.12, 3.0, 2), (2.92, 3.02, -6),
                                  (3.62, 2.32, -84))):
    scene.add(chair("walnut", "fabric-mustard").at(x, y, 0.014, turn), f"chair {k}")
Z = 0.7642
scene.add(fruit_bowl(0.16).at(2.5, 2.38, Z), "fruit bowl")
for k, (x, y) in enumerate(((2.1, 2.08), (2.9, 2.1), (2.1, 2.63), (2.95, 2.62))):
    plate = lathe([(0, 0), (0.07, 0), (0.115, 0.014), (0.115, 0.018), (0.07, 0.006), (0, 0.006)], 28)
    scene.add(plate.at(x, y, Z), f"plate {k}", "ceramic")
    scene.add(cup("ceramic-blue").at(x + 0.17, y + (0.1 if y < 2.4 else -0.1), Z), f"cup {k}")
scene.add(bottle(0.3).at(2.28, 2.4, Z), "bottle")
scene.add(cupboard(1.5, 0.45, 0.85, "walnut", 3, 1).at(2.7, D - 0.24), "sideboard")
scene.add(vase(0.34, "ceramic").at(2.2, D - 0.26, 0.8505), "vase")
scene.add(candlestick(0.22).at(3.1, D - 0.28, 0.8505), "candlestick")
scene.add(candlestick(0.28).at(3.26, D - 0.22, 0.8505), "candlestick, taller")
scene.add(book_stack(4, 4).at(2.62, D - 0.24, 0.8505, 100), "books")
scene.add(picture(0.95, 0.65, "oak", seed=21).at(2.7, D, 1.62), "picture")
scene.add(bookcase(0.9, 1.95, seed=6).turn(-90).at(W - 0.146, 3.1), "bookcase")
scene.add(plant(1.0, 15, 0.17, 2).at(0.6, 3.6), "plant")
scene.add(picture(0.5, 0.65, "walnut", seed=13).at(1.05, D, 1.55), "second picture")
scene.add(clock(0.15).turn(-90).at(W, 1.9, 1.9), "clock")

lamp, at = globe_pendant(1.03, 0.14, metal="paint-black", brim=0.52)
scene.add(lamp.at(2.5, 2.35, H), "pendant")
scene.light(bulb(0.14, 2).at(2.5, 2.35, H + at[2]), 20, 2700, "opal globe")
scene.main(__file__)
