"""A kitchen in which nearly everything is coated and carries an image: tiles, wood, paint and metal in 31 pictures."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (bowl, chair, cup, cupboard, door_frame, door_leaf, fruit_bowl, globe_pendant, picture, sofa,
                       stool, table, vase, wall_shelf, window_frame)
from scenekit import (Piece, Random, Scene, beveled_box, box, bulb, cylinder, lathe, number, panel, planks, quad, room,
                      skirting, sphere, tube)
from texturekit import bricks, brushed, clouds, glazed, grain, image, image_texture, ramp, textured

W, D, H, T = 5.2, 4.4, 2.7, .25
scene = Scene("coated-room", "A kitchen of coated materials with 31 image textures: tiles, wood, paint, metal.", 480,
              320, spp=64, maxdepth=7, iso=150, whitebalance=4500)
scene.camera((4.85, .3, 1.55), (1.55, 3.5, .98), 56)
random = Random(41)


def coat(name, colour, roughness, more=""):
    """A coated material whose reflectance and roughness are images, if they have names of files, else numbers."""
    def parameter(kind, parameter_name, value, texture, metres, options=""):
        if not isinstance(value, str):
            return f'"float {parameter_name}" {number(value)}'
        image_texture(scene, texture, kind, value, metres, options)
        return f'"texture {parameter_name}" "{texture}"'
    file, metres, options = colour
    text = parameter("spectrum", "reflectance", file, f"{name}-colour", metres, options)
    scene.material(name, f'"string type" "coateddiffuse" {text} '
                   + parameter("float", "roughness", roughness, f"{name}-roughness", metres,
                               ' "string encoding" "linear"') + more)


# Wood: five boards, three kinds of furniture.
WOODS = {"plank-a": ((92, 58, 34), (150, 103, 64)), "plank-b": ((84, 52, 30), (136, 92, 56)),
         "plank-c": ((104, 68, 42), (166, 117, 75)), "oak": ((140, 100, 60), (196, 152, 102)),
         "walnut": ((66, 40, 25), (116, 78, 52)), "pine": ((176, 132, 82), (222, 184, 130)),
         "cherry": ((112, 52, 30), (170, 92, 58))}
polish = image(scene, "polish", clouds(random, 6, 5), ramp((8, 8, 8), (46, 46, 46)))
for k, (name, (dark, light)) in enumerate(WOODS.items()):
    file = image(scene, name, grain(random, 6 + k % 4), ramp(light, dark))
    coat(name, (file, .9, "" if k % 2 else ' "string filter" "trilinear"'), polish if k != 3 else .12)

# Tiles: four glazes on the walls, two kinds of floor, each with joints that are rougher.
joints = image(scene, "joints", bricks(4, 4, .012, clouds(random, 4, 4, 2)), ramp((5, 5, 5), (30, 30, 30), (120,) * 3))
for name, columns, rows, shift, joint, glazes in (
        ("tile-white", 4, 4, 0, (150, 146, 138), ((226, 224, 216), (240, 239, 234))),
        ("tile-green", 4, 4, 0, (140, 140, 132), ((46, 92, 78), (88, 142, 120), (64, 112, 96))),
        ("tile-blue", 4, 4, 0, (150, 150, 148), ((32, 58, 104), (70, 110, 160))),
        ("tile-brick", 4, 8, .5, (138, 132, 124), ((206, 200, 188), (228, 222, 210))),
        ("tile-floor", 2, 2, 0, (84, 80, 76), ((112, 104, 98), (150, 142, 132), (128, 120, 112))),
        ("tile-dark", 2, 2, 0, (70, 68, 66), ((34, 34, 36), (58, 58, 62)))):
    file = image(scene, name, bricks(columns, rows, .012, clouds(random, 4, 4), shift), glazed(joint, *glazes))
    coat(name, (file, .6, ""), joints if columns == rows else .05)

# Paint: walls, doors and furniture; brush strokes make it smoother and rougher.
strokes = image(scene, "strokes", brushed(random), ramp((20, 20, 20), (80, 80, 80)))
for k, (name, dark, light, metres) in enumerate((
        ("wall", (206, 196, 176), (224, 216, 200), 1.7), ("wall-warm", (196, 160, 112), (214, 182, 138), 1.7),
        ("ceiling", (226, 224, 218), (236, 234, 230), 2), ("paint-white", (224, 223, 218), (238, 238, 234), .5),
        ("paint-teal", (40, 112, 112), (58, 138, 134), .5), ("trim", (220, 218, 212), (234, 232, 228), .7),
        ("paint-red", (140, 34, 28), (170, 52, 40), .5))):
    file = image(scene, name, clouds(random, 5, 5), ramp(dark, light))
    coat(name, (file, metres, ' "string filter" "ewa"' if k == 0 else ""), strokes if k > 2 else .4)

# Leather and stone.
for name, pattern, colours, roughness in (
        ("leather", clouds(random, 16, 16, 2), ((60, 30, 18), (104, 58, 36)), .3),
        ("fabric-rust", clouds(random, 12, 12), ((92, 36, 22), (140, 64, 40)), .35),
        ("stone", clouds(random, 5, 4, 4), ((60, 60, 64), (112, 110, 108), (170, 168, 164)), .03),
        ("terracotta", clouds(random, 8, 8), ((150, 84, 54), (186, 112, 78)), .3)):
    coat(name, (image(scene, name, pattern, ramp(*colours)), .5, ""), roughness)

# Lacquered metal: its roughness is an image, for copper its colour too.
for name, low, high in (("steel", 14, 60), ("brass", 18, 70), ("iron", 60, 120)):
    file = image(scene, f"{name}-brushed", brushed(random), ramp((low,) * 3, (high,) * 3))
    image_texture(scene, f"{name}-roughness", "float", file, .35, ' "string encoding" "linear"')
    kind = {"steel": "Al", "brass": "CuZn", "iron": "Cu"}[name]
    scene.material(name, f'"string type" "coatedconductor" "spectrum conductor.eta" "metal-{kind}-eta" "spectrum '
                         f'conductor.k" "metal-{kind}-k" "texture conductor.roughness" "{name}-roughness" '
                         '"float interface.roughness" .02 "float thickness" .01')
patina = image(scene, "patina", clouds(random, 7, 7), ramp((150, 84, 60), (214, 132, 98), (110, 128, 104)))
image_texture(scene, "patina", "spectrum", patina, .4)
scene.material("copper", '"string type" "coatedconductor" "texture reflectance" "patina" "float conductor.roughness" '
                         '.15 "float interface.roughness" .05 "float thickness" .01')

# The shell: a floor of boards in front, of tiles along the kitchen, walls with tiles above the worktop.
WINDOW = (1.35, 2.95, 1.2, 2.3)
textured(scene, room(W, D, H, {"n": [WINDOW]}, T, floor="tile-floor",
                     paint={"s": "wall", "w": "wall-warm", "n": "wall", "e": "wall"}), "shell")
textured(scene, planks(0, 0, W, 2.6, width=.16, length=1.7, seed=5), "floor boards")
textured(scene, skirting(W, D, {"e": [(2.7, 3.7)]}, .1), "skirting")
for a, b, z0, z1, name in ((.005, 1.35, .9, 1.5, "tile-white"), (2.95, 4.3, .9, 1.5, "tile-blue"),
                           (1.35, 2.95, .9, 1.2, "tile-green"), (.005, 1.35, 1.5, 1.65, "tile-green"),
                           (2.95, 4.3, 1.5, 1.65, "tile-green")):
    textured(scene, Piece((name, box((a, D - .012, z0), (b, D + .002, z1)))), f"tiles from {number(a)} to {number(b)}")
textured(scene, Piece(("tile-brick", box((-.002, 2.7, .9), (.012, D - .012, 2.0)))), "tiles on the west wall")
textured(scene, window_frame(WINDOW[1] - WINDOW[0], WINDOW[3] - WINDOW[2], T, "paint-white", 2, 1)
         .at(WINDOW[0], D + T / 2, WINDOW[2]), "window")
textured(scene, Piece().include(door_frame(.9, 2.02, .06).turn(-90).at(W - .02, 3.65),
                                door_leaf(.874, 2.0, "paint-teal").turn(-90).at(W - .03, 3.637, .004)), "door")

# The kitchen along the north and west walls.
for k in range(6):
    x = .66 + .6 * k
    if k != 4:
        textured(scene, cupboard(.58, .56, .8, "pine", 2, 1, "brass", .08).at(x + .3, D - .3, .003), f"cupboard {k}")
textured(scene, Piece(("stone", beveled_box((.01, D - .62, .81), (4.3, D - .014, .85), .01)),
                      ("stone", beveled_box((.01, 2.7, .81), (.62, D - .625, .85), .01))), "worktop")
for k in range(2):
    textured(scene, cupboard(.58, .56, .8, "pine", 2, 0, "brass", .08).turn(90).at(.3, 3.0 + .6 * k, .003),
             f"cupboard at the west wall {k}")
oven = Piece(("steel", beveled_box((3.07, D - .6, .08), (3.63, D - .02, .8), .01)),
             ("tile-dark", box((3.12, D - .606, .2), (3.58, D - .599, .6))),
             ("steel", tube((3.14, D - .64, .68), (3.56, D - .64, .68), .01, 12)))
for x in (3.17, 3.53):
    oven.add("steel", tube((x, D - .64, .68), (x, D - .59, .68), .008, 8))
textured(scene, oven, "oven")
hood = Piece(("copper", lathe([(.3, 0), (.31, 0), (.31, .04), (.12, .3), (.11, .8), (.1, .8), (.1, .3), (.3, .03)], 24)))
textured(scene, hood.at(3.35, D - .34, 1.6), "hood")
for k, (radius, height, name) in enumerate(((.11, .13, "copper"), (.08, .1, "steel"))):
    pot = lathe([(0, 0), (radius, 0), (radius, height), (radius - .005, height), (radius - .005, .006), (0, .006)], 28)
    textured(scene, Piece((name, pot), (name, tube((radius, 0, height * .8), (radius + .17, 0, height * .85), .008)))
             .at(3.22 + .27 * k, D - .32 + .06 * k, .8505), f"pot {k}")
tap = Piece(("steel", cylinder(.02, 0, .05, 16)), ("steel", tube((0, 0, .05), (0, 0, .3), .012, 12)),
            ("steel", tube((0, 0, .3), (0, -.18, .3), .012, 12)), ("steel", tube((0, -.18, .3), (0, -.18, .22), .012, 12)))
textured(scene, tap.at(2.15, D - .1, .8505), "tap")
textured(scene, wall_shelf(1.1, .24, "oak", 4).at(.7, D - .013, 1.75), "shelf on the north wall")
textured(scene, wall_shelf(1.1, .24, "oak", 9).turn(90).at(.013, 3.5, 1.55), "shelf on the west wall")
for k in range(4):
    textured(scene, Piece().include(cup("tile-blue" if k % 2 else "paint-red")).at(3.8 + .12 * k, D - .25, .8505, 30 * k),
             f"cup {k}")

# The table and the bench.
textured(scene, table(1.5, .85, .75, "walnut").at(2.4, 1.9, .003, 8), "table")
for k, (x, y, turn) in enumerate(((1.95, 1.22, 186), (2.75, 1.3, 174), (2.2, 2.55, 4), (1.3, 1.9, 96))):
    textured(scene, chair("cherry" if k % 2 else "oak", "leather").at(x, y, .003, turn), f"chair {k}")
textured(scene, stool(.17, .62, "pine").at(3.2, 3.15, .003, 20), "stool")
textured(scene, sofa(1.5, .8, "fabric-rust", 2, ("leather",)).turn(90).at(.48, 1.35, .003), "bench")
textured(scene, Piece().include(fruit_bowl(.15, "terracotta").at(2.45, 1.95, .7535),
                                vase(.26, "tile-green").at(2.02, 1.75, .7535), bowl(.12, "tile-white").at(2.8, 2.1, .7535),
                                cup("paint-red").at(2.7, 1.72, .7535)), "on the table")
textured(scene, Piece(("brass", sphere(.09, 3)), ("iron", cylinder(.05, -.1, -.07, 24))).at(2.15, 2.05, .854),
         "brass ball on the table")
textured(scene, picture(.7, .5, "cherry", 8).turn(90).at(.0006, 1.35, 1.6), "picture")

# Light: the window, two panels in the ceiling, two pendants over the table.
x0, x1, z0, z1 = WINDOW
scene.light(quad((x0 - .2, D + T + .1, z0 - .2), (x1 + .2, D + T + .1, z0 - .2), (x1 + .2, D + T + .1, z1 + .2),
                 (x0 - .2, D + T + .1, z1 + .2)), 170, 6500, "daylight")
for k, (x, y) in enumerate(((1.3, 3.5), (3.9, 1.0))):
    textured(scene, Piece(("paint-white", box((x - .28, y - .28, H - .04), (x + .28, y + .28, H + .003)))), f"tray {k}")
    scene.light(panel(.5, .5, 1, 1, down=True).at(x, y, H - .0415), 22, 4000, f"ceiling panel {k + 1}")
for k, x in enumerate((2.05, 2.75)):
    lamp, at = globe_pendant(.95, .09, "copper", "paint-red")
    textured(scene, lamp.at(x, 1.9, H), f"pendant {k}")
    scene.light(bulb(.09, 1).at(x, 1.9, H + at[2]), 13, 2900, f"pendant {k + 1}")
scene.main(__file__)
