"""A garden path under trees, in sun and sky: thousands of leaves cut out of cards by alpha images, in instances; the
halton sampler."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from instancing import place
from scenekit import (Piece, Random, Scene, beveled_box, cross, cylinder, diffuse, normalized, numbers, sphere, sub,
                      tube)
from skykit import Sun, clear_sky, sky_image, sky_light
from texturekit import bricks, clouds, glazed, grain, image, image_texture, mesh_with_uv, ramp, textured

scene = Scene("outdoor", "A garden path under trees: leaves and grass are cards with alpha images, in instances.", 480,
              320, spp=64, maxdepth=6, iso=64, whitebalance=5600)
scene.render[0] = 'Sampler "halton" "integer pixelsamples" 64'
scene.camera((2.4, -6.8, 1.65), (-.3, 2, 1.5), 50)
random = Random(12)
sun = Sun(228, 44)
sky_light(scene, sky_image(128, clear_sky(sun), sun), label="the sky with the sun")


def leaf_shape(u, v, length, width, bend=0.0):
    """True inside a pointed leaf along v, from v = 0 to length, about u = 0."""
    t = v / length
    return 0 < t < 1 and abs(u - bend * t * t) < width * math.sin(math.pi * t ** .8) * (1 - .3 * t)


def sprig(u, v):
    """A twig with nine leaves in the unit square; v = 1 is its foot."""
    x, y = u - .5, 1 - v
    if abs(x) < .008 and y < .75:
        return 1.0
    for k in range(9):
        side, foot = (-1, 1)[k % 2], .08 + .085 * k
        a = side * math.radians(62 - 6 * k) if k < 8 else 0.0
        dx, dy = x, y - foot
        along, across = math.cos(a) * dy + math.sin(a) * dx, math.cos(a) * dx - math.sin(a) * dy
        if leaf_shape(across, along, .4 - .02 * k, .075, .02 * side):
            return 1.0
    return 0.0


def blades(u, v):
    """Grass in the unit square; v = 1 is the ground."""
    y = 1 - v
    for k in range(13):
        foot, height = .06 + .073 * k, .5 + .47 * ((k * 7) % 13) / 13
        lean = .16 * (((k * 5) % 11) / 11 - .5)
        if 0 <= y < height and abs(u - foot - lean * (y / height) ** 2) < .022 * (1 - y / height) + .003:
            return 1.0
    return 0.0


def leaf_material(name, alpha, colours, through, size=128):
    """A colour and its alpha image; light goes through leaves."""
    image_texture(scene, f"{name}-alpha", "float", alpha, 1, ' "string encoding" "linear"')
    image_texture(scene, f"{name}-colour", "spectrum", image(scene, name, clouds(random, 9, 9), ramp(*colours), size))
    scene.material(name, f'"string type" "diffusetransmission" "texture reflectance" "{name}-colour" '
                         f'"rgb transmittance" [ {numbers(through, 3)} ]')


sprig_alpha = image(scene, "sprig-alpha", sprig)
blade_alpha = image(scene, "blades-alpha", blades)
leaf_material("leaf-a", sprig_alpha, ((42, 84, 24), (92, 138, 46)), (.1, .17, .03))
leaf_material("leaf-b", sprig_alpha, ((70, 96, 26), (150, 168, 62)), (.15, .2, .04))
leaf_material("blade", blade_alpha, ((78, 110, 38), (142, 160, 72)), (.12, .18, .04), 64)
for name, pattern, colours, metres in (
        ("meadow", clouds(random, 12, 12, 4), ((66, 82, 34), (112, 118, 58), (140, 128, 82)), 3),
        ("bark", grain(random, 12), ((74, 58, 44), (118, 98, 78)), .6),
        ("board", grain(random, 7), ((150, 112, 74), (196, 158, 112)), .9),
        ("stone", clouds(random, 6, 6, 4), ((104, 100, 92), (168, 162, 150)), .8)):
    image_texture(scene, f"{name}-colour", "spectrum", image(scene, name, pattern, ramp(*colours)), metres,
                  ' "string filter" "trilinear"' if name == "meadow" else "")
    scene.material(name, f'"string type" "diffuse" "texture reflectance" "{name}-colour"')
image_texture(scene, "paving-colour", "spectrum", image(
    scene, "paving", bricks(3, 3, .02, clouds(random, 6, 6)), glazed((96, 90, 80), (150, 140, 128), (190, 180, 166))), 1.2)
scene.material("paving", '"string type" "coateddiffuse" "texture reflectance" "paving-colour" "float roughness" .4')
scene.material("pot", '"string type" "coateddiffuse" "rgb reflectance" [ .45 .2 .11 ] "float roughness" .15')
scene.material("wall-plaster", diffuse(.66, .6, .5))


def cards(name, places, width, height):
    """Upright rectangles with the whole picture of a material: places are (foot, up, normal)."""
    points, normals, uvs, faces = [], [], [], []
    for foot, up, normal in places:
        across = normalized(cross(up, normal))
        first = len(points)
        for s, t in ((-.5, 0), (.5, 0), (.5, 1), (-.5, 1)):
            points.append(tuple(foot[k] + across[k] * width * s + up[k] * height * t for k in range(3)))
            normals.append(normal)
            uvs.append((s + .5, t))
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    scene._use(name)
    scene.raw(f'NamedMaterial "{name}"\n{mesh_with_uv(points, None, uvs, faces)}\n  "texture alpha" "{name}-alpha"')


def unit(random):
    z, a = random.uniform(-1, 1), random.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return (r * math.cos(a), r * math.sin(a), z)


def tree(name, height, crown, leaves, material, seed):
    """An object: a trunk, boughs and cards with leaves in a crown of several balls."""
    random = Random(seed)
    scene.raw(f'\nObjectBegin "{name}"')
    piece = Piece(("bark", cylinder(height * .035, -.3, height * .6, 10, height * .02)))
    balls = []
    for k in range(7):
        a, r = 2.4 * k + random.uniform(-.3, .3), crown * (.62 if k else 0)
        end = (r * math.cos(a), r * math.sin(a), height * (random.uniform(.55, .75) if k else .82))
        piece.add("bark", tube((0, 0, height * random.uniform(.34, .5)), end, height * .011, 6))
        balls.append((end, crown * random.uniform(.42, .55)))
    textured(scene, piece)
    places = []
    for k in range(leaves):
        centre, radius = balls[k % len(balls)]
        out = unit(random)
        r = radius * random.unit() ** .4
        foot = tuple(centre[i] + out[i] * r for i in range(3))
        up = normalized(tuple(out[i] + .6 * unit(random)[i] for i in range(3)))
        side = unit(random)
        places.append((foot, up, normalized(cross(up, side))))
    cards(material, places, crown * .34, crown * .42)
    scene.raw("ObjectEnd")


def ground(x, y):
    return .12 * math.sin(.33 * x + .4) * math.cos(.29 * y) if abs(x) > .9 else 0.0


tree("tree-a", 4.8, 1.7, 420, "leaf-a", 3)
tree("tree-b", 3.6, 1.3, 340, "leaf-b", 5)
tree("bush", 1.1, .62, 160, "leaf-a", 8)
for k in range(2):
    scene.raw(f'\nObjectBegin "tuft-{k}"')
    cards("blade", [((.12 * math.cos(2.1 * i + k), .12 * math.sin(2.1 * i + k), -.02), (0, 0, 1),
                     (math.cos(i * 1.05), math.sin(i * 1.05), 0)) for i in range(4)], .42, .3 + .08 * k)
    scene.raw("ObjectEnd")
scene.raw('\nObjectBegin "boulder"')
textured(scene, Piece(("stone", sphere(.5, 3).stretch(1, .8, .6))))
scene.raw("ObjectEnd\n")

meadow_points = [(x * 1.5, y * 1.5) for y in range(-10, 41) for x in range(-24, 25)]
meadow = ([(x, y, ground(x, y) - .01) for x, y in meadow_points], None, meadow_points,
          [f for j in range(50) for i in range(48) for a in (j * 49 + i,)
           for f in ((a, a + 1, a + 50), (a, a + 50, a + 49))])
scene._use("meadow")
scene.raw(f'# ground\nNamedMaterial "meadow"\n{mesh_with_uv(*meadow)}')
textured(scene, Piece(*[("paving", beveled_box((-.75 + .52 * i, -8 + .6 * j, -.1), (-.27 + .52 * i, -7.44 + .6 * j, .02),
                                               .01)) for j in range(38) for i in range(3)]), "path")
textured(scene, Piece(("wall-plaster", beveled_box((-9, 15.2, -.2), (9, 15.5, 1.5), .02)),
                      ("board", beveled_box((-9.1, 15.1, 1.5), (9.1, 15.6, 1.57), .02))), "garden wall")
bench = Piece()
for k in range(4):
    bench.add("board", beveled_box((-.8, -.24 + .125 * k, .42), (.8, -.13 + .125 * k, .46), .006))
for k in range(2):
    bench.add("board", beveled_box((-.8, .3 + .03 * k, .58 + .16 * k), (.8, .33 + .03 * k, .7 + .16 * k), .006))
for x in (-.66, .66):
    bench.add("board", beveled_box((x - .03, -.24, 0), (x + .03, -.16, .42), .006))
    bench.add("board", beveled_box((x - .03, .28, 0), (x + .03, .36, .86), .006))
textured(scene, bench.at(-1.55, .8, .02, 76), "bench")
for k, (x, y) in enumerate(((1.15, -2.6), (1.2, 1.4), (-1.2, -3.4))):
    textured(scene, Piece(("pot", cylinder(.17, 0, .34, 24, .23))).at(x, y, .01), f"pot {k}")
    place(scene, "bush", x, y, .3, 70 * k, .62)

for name, x, y, turn, scale in (
        ("tree-a", -2.6, 3.6, 20, 1), ("tree-b", 2.5, 5.4, 80, 1.1), ("tree-a", 3.4, 10.5, 140, 1.15),
        ("tree-b", -2.4, 9.6, 200, 1.2), ("tree-a", -6.6, 7.5, 260, 1.2), ("tree-b", -5.2, 1.2, 9, 1.1),
        ("tree-a", 6.4, 6.2, 75, 1.3), ("tree-b", 5.2, 1.4, 15, 1.05), ("tree-a", -9.5, 13, 5, 1.3),
        ("tree-a", -4.5, 19, 99, 1.6), ("tree-b", 1.2, 18.5, 123, 1.7), ("tree-a", 7.5, 19, 160, 1.6),
        ("tree-b", 10.5, 13, 320, 1.4)):
    place(scene, name, x, y, ground(x, y), turn, scale)
for k in range(34):
    side, y = (-1, 1)[k % 2], -4.5 + .58 * k
    x = side * random.uniform(1.5, 7 if y > 2 else 3.4)
    place(scene, "bush", x, y, ground(x, y), random.uniform(0, 360), random.uniform(.6, 1.3))
for k in range(16):
    side, y = (-1, 1)[k % 2], random.uniform(-5, 12)
    x, scale = side * random.uniform(.9, 3), random.uniform(.15, .5)
    place(scene, "boulder", x, y, ground(x, y) + .1 * scale, random.uniform(0, 360), scale)
for k in range(900):
    side, y = (-1, 1)[k % 2], -6.5 + 21 * random.unit() ** 1.4
    x = side * (.95 + 6 * random.unit() ** 1.3)
    place(scene, f"tuft-{k % 4 // 2}", x, y, ground(x, y), random.uniform(0, 360), random.uniform(.6, 1.3))
scene.main(__file__)
