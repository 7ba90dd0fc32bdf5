"""Stones, a picnic table and trees on open ground under sun and sky: nearly every point sees most of the light."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import bottle, bowl, cup, fruit_bowl
from instancing import define, place
from scenekit import Mesh, Piece, Random, Scene, beveled_box, cylinder, diffuse, normalized, sphere, tube
from skykit import Sun, clear_sky, sky_image, sky_light

scene = Scene("open-field", "Stones, a picnic table and trees on open ground under sun and sky: little is hidden.", 480,
              320, spp=64, maxdepth=6, iso=68, whitebalance=5600)
scene.camera((4.6, -6.2, 1.75), (.3, 1.2, 1.0), 44)
scene.material("grass", diffuse(.24, .3, .11))
scene.material("grass-dry", diffuse(.36, .34, .15))
scene.material("stone-a", diffuse(.5, .47, .43))
scene.material("stone-b", diffuse(.32, .31, .3))
scene.material("bark", diffuse(.2, .14, .09))
scene.material("crown-a", diffuse(.13, .24, .06))
scene.material("crown-b", diffuse(.2, .32, .09))
scene.material("board", diffuse(.5, .36, .21))
sun = Sun(212, 36)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")
random = Random(77)


def ground(x, y):
    return .16 * math.sin(.31 * x + .4) * math.cos(.27 * y) + .05 * math.sin(.9 * x - .7 * y)


def meadow(reach=160.0, rings=22, sides=40):
    """A disc of gentle waves, finer in the middle."""
    mesh = Mesh([(0, 0, ground(0, 0))])
    for i in range(1, rings + 1):
        r = reach * (i / rings) ** 3 + .35 * i
        for k in range(sides):
            a = 2 * math.pi * k / sides
            x, y = r * math.cos(a), r * math.sin(a)
            mesh.vertices.append((x, y, ground(x, y) * min(1, 40 / r)))
    for k in range(sides):
        n = (k + 1) % sides
        mesh.faces.append((0, 1 + k, 1 + n))
        for i in range(rings - 1):
            a, b = 1 + i * sides, 1 + (i + 1) * sides
            mesh.faces += [(a + k, b + k, b + n), (a + k, b + n, a + n)]
    return mesh


def lumpy(mesh, size, seed):
    """Each vertex of a round mesh pushed in or out by a few waves."""
    random = Random(seed)
    waves = [([random.uniform(-1, 1) * f for _ in range(3)], random.uniform(0, 6), 1 / f) for f in (2, 3, 4, 6, 8)]

    def pushed(p):
        n = normalized(p)
        s = 1 + size * sum(w * math.sin(f[0] * n[0] + f[1] * n[1] + f[2] * n[2] + phase) for f, phase, w in waves)
        return tuple(c * s for c in p)
    return Mesh([pushed(p) for p in mesh.vertices], mesh.faces)


def tree(height, crown, seed):
    """A trunk, four boughs, and a crown of lumps."""
    random = Random(seed)
    piece = Piece(("bark", cylinder(height * .035, -.3, height * .62, 9, height * .018)))
    for k in range(4):
        a = 1.57 * k + random.uniform(-.4, .4)
        end = (crown * .6 * math.cos(a), crown * .6 * math.sin(a), height * random.uniform(.6, .72))
        piece.add("bark", tube((0, 0, height * random.uniform(.34, .44)), end, height * .011, 6))
    for k in range(11):
        a, r = 2.4 * k, crown * .62 * math.sqrt(k / 11)
        z = height * (.82 - .2 * (r / crown) ** 2 + random.uniform(-.09, .09))
        lump = lumpy(sphere(crown * random.uniform(.34, .5), 2, smooth=False), .3, seed * 20 + k)
        piece.add(random.pick(("crown-a", "crown-a", "crown-b")), lump.at(r * math.cos(a), r * math.sin(a), z))
    return piece


def tuft(blades=13, seed=1):
    random, mesh = Random(seed), Mesh()
    for _ in range(blades):
        a, lean, h = random.uniform(0, 6.28), random.uniform(.02, .1), random.uniform(.08, .2)
        x, y = random.uniform(-.05, .05), random.uniform(-.05, .05)
        c, s, n = math.cos(a), math.sin(a), len(mesh.vertices)
        mesh.vertices += [(x - .005 * s, y + .005 * c, -.03), (x + .005 * s, y - .005 * c, -.03),
                          (x + lean * c, y + lean * s, h)]
        mesh.faces.append((n, n + 1, n + 2))
    return mesh


def picnic_table():
    """Table and benches of one frame; its length along x."""
    piece = Piece()
    for k in range(5):
        piece.add("board", beveled_box((-.95, -.37 + .15 * k, .71), (.95, -.23 + .15 * k, .75), .006))
    for side in (-1, 1):
        for k in range(2):
            c = side * (.68 + .15 * k)
            piece.add("board", beveled_box((-.95, c - .07, .41), (.95, c + .07, .45), .006))
    for x in (-.68, .68):
        piece.add("board", beveled_box((x - .025, -.85, .33), (x + .025, .85, .409), .006))
        piece.add("board", beveled_box((x - .025, -.36, .63), (x + .025, .36, .709), .006))
        for side in (-1, 1):
            leg = beveled_box((-.02, -.045, -.1), (.02, .045, .86), .004).turn(side * 28, "x")
            piece.add("board", leg.at(x + .046, side * .62, -.02))
    return piece


scene.add(meadow(), "ground", "grass")
for name, height, crown, seed in (("tree-a", 5.4, 1.9, 3), ("tree-b", 4.2, 1.5, 5)):
    define(scene, name, tree(height, crown, seed))
for k, seed in enumerate((1, 2, 3)):
    define(scene, f"stone-{k}", Piece(("stone-b" if k == 1 else "stone-a",
                                       lumpy(sphere(.5, 3, smooth=False), .32, seed).stretch(1, .85, .62))))
define(scene, "tuft-0", Piece(("grass", tuft(13, 1))))
define(scene, "tuft-1", Piece(("grass-dry", tuft(11, 2))))

scene.raw("")
for name, x, y, turn, scale in (
        ("tree-a", -3.4, 5.2, 20, 1), ("tree-b", 4.3, 7.5, 80, 1.1), ("tree-a", -9, 16, 140, 1.2),
        ("tree-b", 1.5, 19, 200, 1.3), ("tree-a", 11, 21, 260, 1.2), ("tree-b", -16, 12, 9, 1.2),
        ("tree-a", -2, 33, 75, 1.4), ("tree-b", 20, 36, 15, 1.6), ("tree-a", -22, 34, 5, 1.5)):
    place(scene, name, x, y, ground(x, y) * min(1, 40 / math.hypot(x, y)), turn, scale)
for k in range(26):
    a, r = random.uniform(0, 6.28), 1.9 + 7 * random.unit() ** 1.5
    x, y, scale = r * math.cos(a), r * math.sin(a) + 1, random.uniform(.18, .6)
    if (x - 4.6) ** 2 + (y + 6.2) ** 2 > 6:
        place(scene, f"stone-{k % 3}", x, y, ground(x, y) + .12 * scale, random.uniform(0, 360), scale)
place(scene, "stone-0", -1.9, -.6, ground(-1.9, -.6) + .2, 40, 1.5)
place(scene, "stone-1", 1.9, 3.1, ground(1.9, 3.1) + .2, 120, 1.9)
for k in range(330):
    a, r = random.uniform(0, 6.28), 13 * random.unit() ** .6
    x, y = r * math.cos(a), r * math.sin(a) - 1
    place(scene, f"tuft-{k % 2}", x, y, ground(x, y), random.uniform(0, 360), random.uniform(.7, 1.7))

z = ground(.2, .6) + .02
scene.add(picnic_table().at(.2, .6, z, 24), "picnic table")
on_table = Piece().include(fruit_bowl(.16).at(-.25, .05, .7505), bowl(.11, "ceramic").at(.5, -.14, .7505),
                           bottle(.3, "leaf").at(.18, .12, .7505), cup("ceramic-blue").at(.02, -.2, .7505),
                           cup("ceramic").at(.62, .18, .7505))
scene.add(on_table.at(.2, .6, z, 24), "on the table")
scene.main(__file__)
