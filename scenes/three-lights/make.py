"""Three lights in three niches of one room; partitions hide each from the other two. See the paper's Fig. 1."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *
from furniture import *

scene = Scene("three-lights", "Three lights in three niches of a living room: each part of the picture sees only some "
              "of them.", 480, 360, maxdepth=6, iso=420, whitebalance=3300)
scene.camera((3.15, 0.25, 1.6), (2.98, 5, 1.02), 52)
W, D, H = 6.0, 6.6, 2.6
NICHE, LEFT, RIGHT, T = 4.0, 2.0, 4.0, 0.12

scene.add(room(W, D, H, floor="floor", paint={"s": "wall", "n": "wall-blue", "w": "wall", "e": "wall-warm"}), "shell")
scene.add(planks(0, 0, W, D, length=1.7), "floor boards")
scene.add(skirting(W, D), "skirting")
walls = Piece()
for x in (LEFT, RIGHT):
    walls.add("wall", wall((x, NICHE), (x, D + 0.02), T, H + 0.02, base=-0.02))
    for side in (-1, 1):
        a, b = sorted((x + side * (T / 2 - 0.002), x + side * (T / 2 + 0.015)))
        walls.add("trim", box((a, NICHE - 0.015, -0.002), (b, D - 0.016, 0.08)))
    walls.add("trim", box((x - T / 2 + 0.002, NICHE - 0.015, -0.002), (x + T / 2 - 0.002, NICHE + 0.002, 0.08)))
scene.add(walls, "partitions")

# West: a small dining place under a metal pendant.
scene.add(round_table(0.46, 0.74).at(0.95, 5.35), "dining table")
for x, y, turn in ((0.38, 5.05, 120), (1.2, 4.72, 195), (1.5, 5.8, -60)):
    scene.add(chair("oak", "fabric-green").at(x, y, 0, turn), f"chair {turn}")
scene.add(fruit_bowl(0.13).at(0.95, 5.38, 0.7405), "fruit")
scene.add(cup().at(0.72, 5.2, 0.7405), "cup")
scene.add(cup("ceramic-blue").at(1.18, 5.22, 0.7405), "second cup")
scene.add(picture(0.7, 0.5, seed=4).at(0.72, D, 1.5), "picture, west")
lamp, at = pendant(0.95, "paint-teal", 0.2, 0.15)
scene.add(lamp.at(0.95, 5.35, H), "pendant")
# Well inside the bell: a bulb that the camera saw would decide every error measure by a few pixels.
scene.light(bulb().at(0.95 + at[0], 5.35 + at[1], H + at[2] + 0.035), 16, 2700, "bulb in the pendant")

# Middle: books and a bench under a ceiling panel.
scene.add(bookcase(0.86, 2.0, seed=3, wood="walnut").at(2.6, D - 0.146), "bookcase, left")
scene.add(bookcase(0.86, 2.0, seed=7, wood="walnut").at(3.46, D - 0.146), "bookcase, right")
scene.add(bench(0.95, 0.36, 0.45, "walnut", "leather").at(3.0, 5.55), "bench")
scene.add(book_stack(3, 5).at(2.75, 5.55, 0.4605), "books on the bench")
frame = Piece()
for lo, hi in (((-0.3, -0.3), (0.3, -0.26)), ((-0.3, 0.26), (0.3, 0.3)), ((-0.3, -0.26), (-0.26, 0.26)),
               ((0.26, -0.26), (0.3, 0.26))):
    frame.add("steel", box((*lo, -0.05), (*hi, 0.005)))
scene.add(frame.at(3.0, 5.5, H), "frame of the panel")
scene.light(panel(0.5, 0.5, 2, 2, down=True).at(3.0, 5.5, H - 0.03), 9, 3600, "ceiling panel")

# East: a desk with a lamp whose shade is tin.
scene.add(table(1.3, 0.62, 0.74, "oak", 0.05).turn(90).at(5.66, 5.55), "desk")
scene.add(chair("walnut", "fabric-rust").at(5.08, 5.6, 0, 75), "desk chair")
lamp, at = table_lamp(0.44, "paint-black", "ceramic", 0.09, 0.15, 0.18)
scene.add(lamp.at(5.66, 5.9, 0.7405), "desk lamp")
scene.light(bulb(0.028).at(5.66, 5.9, 0.7405 + at[2]), 14, 2700, "bulb in the desk lamp")
scene.add(book_stack(4, 8).at(5.7, 5.25, 0.7405, 20), "books on the desk")
scene.add(picture(0.55, 0.7, "oak", seed=9).at(4.85, D, 1.55), "picture, east")
scene.add(wall_shelf(0.8, seed=11).turn(-90).at(W, 5.55, 1.75), "shelf over the desk")

# In front of the niches, where two or three of the lights meet.
scene.add(rug(2.3, 1.5, "carpet-blue", "carpet-sand").at(3.0, 3.1), "rug")
scene.add(armchair("fabric-rust", "fabric-mustard").at(1.2, 3.3, 0, 112), "armchair")
scene.add(armchair("fabric-grey").at(4.8, 3.1, 0, -125), "second armchair")
scene.add(round_table(0.38, 0.42, "oak").at(3.0, 3.15, 0.014), "low table")
scene.add(vase(0.26, "ceramic-blue").at(3.08, 3.22, 0.4345), "vase")
scene.add(book_stack(2, 2).at(2.86, 3.08, 0.4345, 30), "books on the low table")
scene.add(plant(0.8, 13, 0.14, 3).at(4.35, 4.25), "plant")
scene.main(__file__)
