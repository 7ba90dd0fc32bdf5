"""A room that gets its light through a door left ajar: the lamp of the next room is not seen from here."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *
from furniture import *

scene = Scene("ajar", "Light behind a door that stands ajar: apart from a narrow strip everything is lit indirectly.",
              480, 360, maxdepth=8, iso=1400, whitebalance=3600)
scene.camera((1.3, 0.4, 1.42), (2.0, 3.4, 0.95), 50)
W, D, H, T = 4.0, 3.6, 2.6, 0.15
DOOR = (2.35, 3.25, 0, 2.02)
FAR = 3.0  # depth of the next room

scene.add(room(W, D, H, {"n": [DOOR]}, T, paint={"s": "wall", "n": "wall-blue", "w": "wall", "e": "wall"}), "this room")
for name, colour in (("plank-a", (.55, .4, .25)), ("plank-b", (.5, .36, .22)), ("plank-c", (.6, .45, .29))):
    scene.material(name, diffuse(*colour))  # light wood: what falls on it lights the room
scene.add(planks(0, 0, W, D), "floor boards")
scene.add(skirting(W, D, {"n": [(DOOR[0] - 0.07, DOOR[1] + 0.07)]}), "skirting")
scene.add(door_frame(0.9, 2.02, T).at(DOOR[0], D + T / 2), "door frame")
scene.add(door_leaf(0.872, 2.0).turn(180 + 42).at(DOOR[1] - 0.014, D + 0.022), "door, ajar")

beyond = Piece()
y0, y1 = D + T, D + T + FAR
beyond.add("floor", slab(-T, y0, W + T, y1 + T, -0.2, 0)).add("ceiling", slab(-T, y0, W + T, y1 + T, H, H + 0.2))
beyond.add("wall-warm", wall((-T, y1 + T / 2), (W + T, y1 + T / 2), T, H + 0.02, base=-0.02))
for x in (-T / 2, W + T / 2):
    beyond.add("wall-warm", wall((x, y0 - 0.02), (x, y1 + 0.02), T, H + 0.02, base=-0.02))
scene.add(beyond, "the next room")
scene.add(planks(0, D - 0.0 + T, W, y1, seed=4), "its floor boards")
scene.add(planks(DOOR[0] + 0.012, D, DOOR[1] - 0.012, D + T, width=0.15, seed=5), "threshold")
scene.add(bookcase(0.9, 1.95, seed=5).at(3.2, y1 - 0.146), "its bookcase")
scene.add(armchair("fabric-rust").at(1.2, y1 - 0.7, 0, 20), "its armchair")
tray = Piece(("steel", box((-0.65, -0.35, -0.05), (0.65, 0.35, 0.003))))
scene.add(tray.at(2.55, D + T + 0.85, H), "ceiling light of the next room, its tray")
scene.light(panel(1.2, 0.6, 2, 1, down=True).at(2.55, D + T + 0.85, H - 0.0515), 60, 3200, "ceiling of the next room")

# A still life on a table, as such scenes have.
scene.add(table(1.3, 0.72, 0.74, "oak").at(1.0, 2.3, 0, 6), "table")
scene.material("polished-brass", metal("CuZn", .08))
scene.add(vase(0.34, "ceramic-blue").at(0.72, 2.46, 0.7405), "vase")
scene.add(fruit_bowl(0.16).at(1.1, 2.22, 0.7405), "fruit bowl")
scene.add(vase(0.24, "polished-brass").at(1.42, 2.42, 0.7405), "brass vase")
scene.add(book_stack(3, 5).at(0.7, 2.12, 0.7405, 30), "books")
scene.add(cup().at(1.42, 2.14, 0.7405), "cup")
scene.add(chair("walnut", "fabric-mustard").at(0.95, 2.95, 0, 8), "chair")
scene.add(chair("walnut", "fabric-mustard").at(1.9, 3.25, 0, -10), "chair by the wall")
scene.add(plant(0.95, 14, 0.17, 4).at(0.42, D - 0.42), "plant")
scene.add(picture(0.72, 0.52, "oak", seed=12).at(1.35, D, 1.62), "picture")
scene.add(picture(0.45, 0.6, "walnut", seed=7).turn(90).at(0, 2.6, 1.55), "second picture")
scene.add(rug(1.5, 1.1, "carpet-sand", "carpet-red").at(2.75, 2.15, 0, 4), "rug")
scene.add(bookcase(0.9, 1.9, seed=9, wood="walnut").turn(-90).at(W - 0.146, 2.45), "bookcase")
scene.main(__file__)
