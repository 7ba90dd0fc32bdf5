"""A hotel corridor, the doors of its rooms open or ajar; nine lights, most of them behind a wall from most points."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from scenekit import *
from furniture import *

scene = Scene("hotel", "A hotel corridor between six rooms, nine mesh lights: two in the corridor, one in each room, "
              "one at the far end.", 480, 360, maxdepth=6, iso=300, whitebalance=3300)
W, H, T = 2.0, 2.7, 0.14        # the corridor: x from 0 to W
LENGTH, ROOM = 10.5, 3.5        # its length; the length of a room along it
DEEP = 3.2                      # how far the rooms reach
scene.camera((0.62, 0.35, 1.58), (1.5, 4.4, 1.25), 60)
X0, X1 = -T - DEEP, W + T + DEEP

scene.add(Piece(("floor", slab(X0 - T, -T, X1 + T, LENGTH + T, -0.2, 0)),
                ("ceiling", slab(X0 - T, -T, X1 + T, LENGTH + T, H, H + 0.2))), "floor and ceiling")
outer = Piece()
for y in (-T / 2, LENGTH + T / 2):
    outer.add("wall", wall((X0 - T, y), (X1 + T, y), T, H + 0.02, base=-0.02))
for x in (X0 - T / 2, X1 + T / 2):
    outer.add("wall", wall((x, -0.02), (x, LENGTH + 0.02), T, H + 0.02, base=-0.02))
for k in (1, 2):
    for a, b in ((X0 - 0.02, -T + 0.02), (W + T - 0.02, X1 + 0.02)):
        outer.add("wall-warm", wall((a, k * ROOM), (b, k * ROOM), T, H + 0.02, base=-0.02))
scene.add(outer, "outer walls and walls between the rooms")

DOORS = {"w": ((2.2, .94), (5.3, .94), (8.6, .94)), "e": ((1.6, 1.5), (4.9, .94), (8.2, .94))}  # from, width
ANGLES = {"w": (62, 40, 75), "e": (0, 58, 30)}  # how far each door stands open; the first one right has none
scene.material("wainscot", diffuse(.3, .2, .12))
scene.material("wall-paper", diffuse(.56, .5, .38))
for side, x in (("w", -T / 2), ("e", W + T / 2)):
    holes = [(y + 0.02, y + 0.02 + w, -0.02, 2.04) for y, w in DOORS[side]]
    scene.add(wall((x, -0.02), (x, LENGTH + 0.02), T, H + 0.02, holes, -0.02), f"corridor wall, {side}", "wall-paper")
    inner = 0 if side == "w" else W
    boards = Piece()
    cuts = [0.0] + [c for y, w in DOORS[side] for c in (y - 0.07, y + w + 0.07)] + [LENGTH]
    for a, b in zip(cuts[::2], cuts[1::2]):
        lo, hi = sorted((inner - 0.002 * (1 if side == "w" else -1), inner + 0.012 * (1 if side == "w" else -1)))
        boards.add("wainscot", box((lo, a, -0.002), (hi, b, 0.9)))
        lo, hi = sorted((inner + 0.0115 * (1 if side == "w" else -1), inner + 0.03 * (1 if side == "w" else -1)))
        boards.add("wainscot", box((lo, a, 0.86), (hi, b, 0.91)), box((lo, a, -0.002), (hi, b, 0.12)))
        n = max(1, round((b - a) / 0.62))
        for k in range(n + 1):
            c = a + 0.03 + (b - a - 0.06) * k / n
            boards.add("wainscot", box((lo, c - 0.03, 0.1199), (hi - 0.006 if side == "w" else hi, c + 0.03, 0.8601)))
    scene.add(boards, f"wainscot, {side}")
    for k, (y, width) in enumerate(DOORS[side]):
        scene.add(door_frame(width, 2.04, T, "wainscot").turn(90).at(x, y), f"door frame {side}{k}")
        sill = planks(-T if side == "w" else W, y + 0.012, 0 if side == "w" else W + T, y + width - 0.012, width=0.15,
                      seed=k + 20)
        scene.add(sill, f"threshold {side}{k}")
        if not ANGLES[side][k]:
            continue
        leaf = door_leaf(width - 0.028, 2.02, "walnut", handles="brass")
        turned_leaf = leaf.turn(90 + ANGLES[side][k]) if side == "w" else leaf.turn(90 - ANGLES[side][k])
        scene.add(turned_leaf.at(x + (-T / 2 + 0.024 if side == "w" else T / 2 - 0.024), y + 0.014), f"door {side}{k}")

runner = Piece(("carpet-sand", box((0.3, 0.05, -0.002), (W - 0.3, LENGTH - 0.25, 0.008))),
               ("carpet-red", quad((0.36, 0.11, 0.0086), (W - 0.36, 0.11, 0.0086), (W - 0.36, LENGTH - 0.31, 0.0086),
                                   (0.36, LENGTH - 0.31, 0.0086))))
for k in range(12):
    y = 0.75 + 0.82 * k
    runner.add("carpet-sand", quad((W / 2, y - 0.26, .0092), (W / 2 + .26, y, .0092), (W / 2, y + .26, .0092),
                                   (W / 2 - .26, y, .0092)))
    runner.add("carpet-blue", quad((W / 2, y - 0.17, .0098), (W / 2 + .17, y, .0098), (W / 2, y + .17, .0098),
                                   (W / 2 - .17, y, .0098)))
scene.add(runner, "runner")
for x0, x1 in ((0, 0.3), (W - 0.3, W)):
    boards = planks(x0, 0, x1, LENGTH, width=0.15, length=1.2, seed=3, materials=("walnut", "plank-b"))
    scene.add(boards, f"boards at x = {number(x0)}")

# Corridor: two ceiling lights of opal glass, pictures, a table at the end with a lamp.
for k, y in enumerate((3.1, 7.6)):
    dome = lathe([(0, -0.12), (0.1, -0.11), (0.17, -0.08), (0.205, -0.035), (0.215, 0)], 24)
    scene.light(dome.at(W / 2, y, H), 5, 2900, f"corridor ceiling, {'near' if k == 0 else 'far'}")
for x, y, turn, seed in ((0, 4.3, 90, 3), (0, 7.4, 90, 9), (W, 3.75, -90, 12), (W, 6.9, -90, 4), (W, 1.1, -90, 21)):
    scene.add(picture(0.5, 0.62, "brass", seed=seed).turn(turn).at(x, y, 1.62), f"picture {seed}")
scene.add(table(0.95, 0.36, 0.8, "walnut", 0.045).at(W / 2, LENGTH - 0.2), "hall table")
lamp, at = globe_lamp(0.42, 0.08, "paint-black")
scene.add(lamp.at(W / 2, LENGTH - 0.2, 0.8005), "hall lamp")
scene.light(bulb(0.08, 2).at(W / 2, LENGTH - 0.2, 0.8005 + at[2]), 9, 2700, "hall lamp")
scene.add(picture(0.9, 0.6, "brass", seed=30).at(W / 2, LENGTH, 1.75), "picture at the end")
scene.add(plant(0.9, 13, 0.15, 6).at(0.22, LENGTH - 0.35), "plant")

# Rooms: a bed, a lamp, something on the wall; the lamps differ.
COLOURS = (("fabric-blue", "wall-warm"), ("fabric-rust", "wall-warm"), ("fabric-green", "wall-warm"))
for side in "we":
    out = -1 if side == "w" else 1
    far = X0 if side == "w" else X1
    for k in range(3):
        name = f"room {side}{k}"
        y0, y1 = k * ROOM + (0 if k == 0 else T / 2), (k + 1) * ROOM - (0 if k == 2 else T / 2)
        xa, xb = (far, -T) if side == "w" else (W + T, far)
        scene.add(planks(xa, y0, xb, y1, seed=10 + k, width=0.24, length=1.8), f"boards of {name}")
        blanket = COLOURS[k if side == "e" else 2 - k][0]
        bed_y = y0 + 1.05
        if (side, k) == ("e", 0):
            scene.add(bed(1.5, 2.0, "walnut", blanket).at(3.75, y1 - 1.07), f"bed of {name}")
            scene.add(cupboard(0.45, 0.4, 0.5, "walnut", 1, 1).at(2.62, y1 - 0.21), f"night table of {name}")
            lamp, at = globe_lamp(0.4, 0.07, "paint-black")
            scene.add(lamp.at(2.62, y1 - 0.22, 0.5005), f"lamp of {name}")
            scene.light(bulb(0.07, 2).at(2.62, y1 - 0.22, 0.5005 + at[2]), 14, 2700, f"{name}, night table")
            scene.add(picture(1.0, 0.6, "oak", seed=5).at(3.75, y1, 1.65), f"picture of {name}")
            scene.add(rug(1.5, 1.0, "carpet-blue").at(W + T + 0.95, y0 + 1.45), f"rug of {name}")
        elif (side, k) in (("w", 0), ("e", 2)):
            scene.add(box((min(far, far - out * 1.6), bed_y - .75, 0), (max(far, far - out * 1.6), bed_y + .75, .55)),
                      f"bed of {name}", "linen")
            lamp, at = pendant(0.7, "paint-teal", 0.22)
            x, y = (xa + xb) / 2, (y0 + y1) / 2 + 0.3
            scene.add(lamp.at(x, y, H), f"lamp of {name}")
            scene.light(bulb(0.03).at(x, y, H + at[2]), 20, 2700, f"{name}, pendant")
        else:
            scene.add(sofa(1.7, fabric=blanket, seats=2).turn(90 * -out).at(far - out * 0.46, (y0 + y1) / 2),
                      f"sofa of {name}")
            scene.add(picture(0.9, 0.6, "oak", seed=11 + k).turn(90 * -out).at(far, (y0 + y1) / 2, 1.65),
                      f"picture of {name}")
            if side == "e":
                lamp, at = globe_lamp(1.5, 0.1, "paint-black")
                x, y = far - 0.35, y1 - 0.55
                scene.add(lamp.at(x, y), f"lamp of {name}")
                scene.light(bulb(0.1, 2).at(x, y, at[2]), 18, 2700, f"{name}, floor lamp")
            else:
                x, y = (xa + xb) / 2 + 0.3, (y0 + y1) / 2
                scene.add(box((x - .3, y - .3, H - .045), (x + .3, y + .3, H + .003)), f"lamp of {name}", "steel")
                scene.light(panel(0.54, 0.54, 2, 2, down=True).at(x, y, H - 0.0465), 30, 4000 if k == 1 else 3200,
                            f"{name}, ceiling panel")
scene.world_apart = True
scene.main(__file__)
