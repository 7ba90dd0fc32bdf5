"""A courtyard between houses of four storeys: sky and sun come in from above only, over the roofs."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import door_leaf, plant, window_frame
from instancing import define, place
from scenekit import (Mesh, Piece, Random, Scene, beveled_box, box, coated, cylinder, diffuse, lathe, sphere, tube,
                      wall)
from skykit import Sun, clear_sky, sky_image, sky_light

W, D, H, T = 8.0, 9.5, 11.5, .35
STOREY = 2.85

scene = Scene("courtyard", "A courtyard between high walls: sky and sun from above only.", 480, 320, spp=64, maxdepth=8,
              iso=180, whitebalance=5800)
scene.camera((6.9, .5, 1.65), (2.9, 7.0, 2.65), 62)
scene.material("plaster-a", diffuse(.68, .58, .42))
scene.material("plaster-b", diffuse(.66, .63, .57))
scene.material("plaster-c", diffuse(.62, .46, .36))
scene.material("base", diffuse(.36, .34, .32))
for name, c in (("sett-a", .34), ("sett-b", .3), ("sett-c", .39)):
    scene.material(name, diffuse(c, c * .96, c * .9))
scene.material("joints", diffuse(.16, .15, .13))
scene.material("dark-glass", coated(.03, .035, .04, .001))
scene.material("bark", diffuse(.22, .16, .11))
scene.material("stone", diffuse(.52, .5, .46))
scene.material("water", coated(.04, .07, .07, .001))
scene.material("door-green", diffuse(.1, .2, .15))
sun = Sun(-52, 61)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")
random = Random(19)

# ---- ground: setts on dark joints
scene.add(box((-T, -T, -.3), (W + T, D + T, 0)), "bed of the paving", "joints")
setts = Piece()
rows, columns = 34, 29
for j in range(rows):
    y = D * j / rows
    for i in range(-1, columns):
        x0, x1 = (i + .5 * (j % 2)) * W / columns, (i + 1 + .5 * (j % 2)) * W / columns
        x0, x1 = max(x0, 0), min(x1, W)
        if x1 - x0 < .05 or ((x0 + x1) / 2 - 3.3) ** 2 + (y + .14 - 4.6) ** 2 < .5:
            continue
        h = random.uniform(.006, .016)
        block = Mesh([(x0 + .008, y + .008, h), (x1 - .008, y + .008, h), (x1 - .008, y + D / rows - .008, h),
                      (x0 + .008, y + D / rows - .008, h)], [(0, 1, 2), (0, 2, 3)])
        setts.add(random.pick(("sett-a", "sett-b", "sett-c")), block)
scene.add(setts, "setts")

# ---- walls with recessed windows; what is behind them is dark
WINDOW = (1.05, 1.55)
define(scene, "window", Piece().include(window_frame(*WINDOW, T, "paint-white", 2, 2))
       .add("dark-glass", box((.02, .04, .02), (WINDOW[0] - .02, .06, WINDOW[1] - .02)))
       .add("stone", beveled_box((-.1, -T / 2 - .09, -.09), (WINDOW[0] + .1, -T / 2 + .12, -.001), .01)))
scene.raw("")
doors = Piece()
for side, length, paint, starts, door in (("n", W, "plaster-a", (.75, 2.6, 4.45, 6.3), 2),
                                          ("w", D, "plaster-b", (.9, 3.0, 5.3, 7.5), 1),
                                          ("e", D, "plaster-c", (1.0, 3.2, 5.4, 7.6), 2),
                                          ("s", W, "plaster-b", (.8, 2.6, 4.4, 6.2), 1)):
    # Walls run so that the court lies to the right of their direction, as the frames ask for it.
    start, end, turn = {"n": ((0, D + T / 2), (W, D + T / 2), 0), "w": ((-T / 2, 0), (-T / 2, D), 90),
                        "e": ((W + T / 2, D), (W + T / 2, 0), -90), "s": ((W, -T / 2), (0, -T / 2), 180)}[side]
    openings = []
    for storey in range(4):
        for k, a in enumerate(starts):
            z = .95 + storey * STOREY
            if storey == 0 and k == door:
                openings.append((a, a + 1.05, -.02, 2.15))
                leaf = Piece().include(door_leaf(1.05, 2.14, "door-green", handles="brass"))
                doors.include(leaf.at(a, 0, .005).turn(turn).at(*start, 0))
                continue
            openings.append((a, a + WINDOW[0], z, z + WINDOW[1]))
            angle = math.radians(turn)
            place(scene, "window", start[0] + a * math.cos(angle), start[1] + a * math.sin(angle), z, turn)
    scene.add(wall(start, end, T, H, openings, -.02), f"wall {side}", paint)
    trims = Piece(("stone", box((-.001, -T / 2 - .1, H - .25), (length + .001, T / 2 + .01, H + .02))))
    for storey in (1, 2, 3):
        z = storey * STOREY + .42
        trims.add("stone", box((0, -T / 2 - .035, z), (length, -T / 2 + .01, z + .12)))
    cuts = [0.0, starts[door], starts[door] + 1.05, length]
    for a, b in zip(cuts[::2], cuts[1::2]):
        trims.add("base", box((a, -T / 2 - .03, -.01), (b, -T / 2 + .01, .5)))
    scene.add(trims.turn(turn).at(*start), f"cornices {side}")
    scene.add(box((-T, T / 2 + .002, -.02), (length + T, T / 2 + .2, H)).turn(turn).at(*start), f"rooms behind {side}",
              "joints")
scene.add(doors, "doors")
corners = Piece()
for x in (-T / 2, W + T / 2):
    for y in (-T / 2, D + T / 2):
        corners.add("stone", box((x - T / 2 - .02, y - T / 2 - .02, -.02),
                                 (x + T / 2 - .001, y + T / 2 - .001, H + .01)))
scene.add(corners, "corners")

# ---- things in the court
basin = lathe([(0, .002), (.72, .002), (.72, .12), (.66, .14), (.66, .46), (.74, .48), (.74, .56), (.6, .56), (.6, .4),
               (0, .4)], 40)
column = lathe([(.1, .4), (.1, .9), (.14, .95), (.36, 1.02), (.38, 1.1), (.33, 1.1), (.1, 1.04), (.07, 1.04),
                (.06, 1.3), (0, 1.34)], 32)
scene.add(Piece(("stone", basin), ("stone", column), ("water", lathe([(.599, .5), (.099, .5)], 40)))
          .at(3.3, 4.6), "fountain")
bench = Piece(("oak", beveled_box((-.8, -.2, .42), (.8, .2, .47), .01)))
for x in (-.6, .6):
    bench.add("stone", box((x - .06, -.17, 0), (x + .06, .17, .4195)))
scene.add(bench.turn(90).at(.42, 5.7, .01), "bench")
tub = lathe([(0, 0), (.36, 0), (.46, .62), (.5, .62), (.5, .7), (.43, .7), (.42, .62), (0, .62)], 32)
tree = Piece(("terracotta", tub), ("bark", cylinder(.06, .6, 2.5, 9, .035)))
for k in range(26):
    a, r, up = 2.4 * k, .62 * math.sqrt((k + .5) / 26), random.uniform(-1, 1)
    leafy = sphere(random.uniform(.2, .34), 1, smooth=False)
    tree.add(random.pick(("leaf", "leaf", "leaf-light")), leafy.at(r * math.cos(a), r * math.sin(a), 2.75 + .45 * up))
    if k % 5 == 0:
        tree.add("bark", tube((0, 0, 1.9), (r * math.cos(a), r * math.sin(a), 2.6), .015, 5))
scene.add(tree.at(1.5, 7.8, .01), "tree in a tub")
scene.add(plant(.9, 14, .19, 4).at(5.05, 9.05, .01), "plant")
scene.add(plant(.8, 14, .17, 6).at(.4, 4.2, .01), "second plant")
for k, (x, y, turn) in enumerate(((6.6, 8.9, 12), (7.25, 8.75, -30), (6.9, 8.5, 50))):
    scene.add(box((-.25, -.2, 0), (.25, .2, .36)).turn(turn).at(x, y, .015), f"crate {k}", "pine")
scene.main(__file__)
