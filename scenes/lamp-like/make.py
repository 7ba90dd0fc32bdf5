"""A desk lamp and a ceiling light: the bulb is seen only from above and below its shade."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *
from furniture import *

scene = Scene("lamp-like", "Two lights: a bulb inside the shade of a desk lamp, and one on the ceiling; most points see "
              "only one of them.", 480, 360, maxdepth=8, iso=420, whitebalance=3300)
scene.camera((2.0, 0.75, 1.42), (2.06, 3.4, 1.02), 41)
W, D, H = 4.2, 3.6, 2.6

scene.add(room(W, D, H, floor="floor", paint={"s": "wall", "n": "wall-green", "w": "wall", "e": "wall"}), "shell")
scene.add(planks(0, 0, W, D), "floor boards")
scene.add(skirting(W, D), "skirting")
TOP = 0.76
scene.add(table(1.7, 0.75, TOP, "walnut", 0.06).at(2.05, 3.15), "desk")
scene.add(chair("walnut", "fabric-rust").at(2.65, 2.55, 0, 200), "chair")
lamp, at = table_lamp(0.56, "shade-dense", "ceramic-blue", 0.12, 0.2, 0.25)
scene.add(lamp.at(1.62, 3.18, TOP + 0.0005), "desk lamp")
scene.light(bulb(0.03).at(1.62, 3.18, TOP + at[2]), 13, 2700, "bulb in the shade")
scene.add(book_stack(4, 3).at(2.22, 3.22, TOP + 0.0005, 15), "stack of books")
scene.add(cup("ceramic").at(1.95, 2.95, TOP + 0.0005), "cup")
scene.add(fruit_bowl(0.13).at(2.62, 3.15, TOP + 0.0005), "fruit bowl")
scene.add(candlestick(0.2).at(2.42, 3.36, TOP + 0.0005), "candlestick")
open_book = Piece(("book-a", box((-0.158, -0.117, -0.004), (0.158, 0.117, -0.0005))))
open_book.add("paper", box((-0.15, -0.11, 0), (-0.002, 0.11, 0.014)), box((0.002, -0.11, 0), (0.15, 0.11, 0.012)))
scene.add(open_book.at(1.62, 2.93, TOP + 0.0045, 8), "open book")
scene.add(picture(0.62, 0.46, "walnut", seed=12).at(2.2, D, 1.62), "picture")
scene.add(wall_shelf(0.9, seed=5).at(3.05, D, 1.55), "shelf")
scene.add(vase(0.2, "terracotta").at(3.36, D - 0.1, 1.5505), "vase")
scene.add(plant(0.85, 14, 0.15, 5).at(0.8, 3.25), "plant")
scene.add(clock(0.13).at(1.35, D, 1.95), "clock")

disc = lathe([(0.2, -0.055), (0.2, 0.0), (0.0, 0.0)], 32)
scene.add(disc.at(2.6, 1.9, H + 0.001), "rim of the ceiling light", "steel")
octagon = Mesh([(0, 0, 0)] + [(0.18 * math.cos(k * math.pi / 4), 0.18 * math.sin(k * math.pi / 4),
                               0) for k in range(8)],
               [(0, 1 + (k + 1) % 8, 1 + k) for k in range(8)])
scene.light(octagon.at(2.6, 1.9, H - 0.03), 7, 3500, "ceiling light")
scene.main(__file__)
