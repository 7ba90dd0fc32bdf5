"""A small car of glossy paint and metal on a studio floor, under an image dome with softboxes."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from instancing import place_ply
from scenekit import (Mesh, Piece, Scene, box, coated, cross, lathe, normalized, sphere, sub, tube)
from skykit import sky_image, sky_light, studio

scene = Scene("car-paint", "A small car of glossy paint and metal on a studio floor, under a dome with softboxes.", 480,
              320, spp=64, maxdepth=7, iso=100, whitebalance=6500)
scene.camera((-4.7, -4.5, 1.75), (-.05, .05, .55), 30)


def flake(r, g, b, rough):
    """Metal flakes under a clear, nearly smooth coat."""
    return (f'"string type" "coatedconductor" "rgb reflectance" [ {r} {g} {b} ] "float conductor.roughness" {rough} '
            '"float interface.roughness" .002 "float thickness" .01')


scene.material("paint", flake(.62, .06, .05, .16))
scene.material("second-paint", coated(.07, .1, .16, .003))
scene.material("dark-glass", coated(.012, .013, .015, .001))
scene.material("chrome", flake(.86, .86, .87, .03))
scene.material("rim", flake(.62, .63, .66, .12))
scene.material("rubber", coated(.025, .025, .026, .35))
scene.material("lamp-glass", coated(.75, .74, .7, .01))
scene.material("red-glass", coated(.45, .02, .02, .005))
scene.material("studio", coated(.36, .36, .37, .22))
sky_light(scene, sky_image(128, studio((
    (205, 62, 74, 34, 12, (7, 7, 7.2)), (100, 32, 26, 52, 0, (5.5, 5.2, 4.7)), (300, 26, 66, 9, 0, (9, 9.2, 9.6)),
    (20, 30, 18, 44, -8, (5, 5.3, 6)), (172, 14, 12, 22, 0, (4, 4, 4.4))),
    above=(.2, .2, .215), below=(.2, .2, .215)), fine=6), label="a dome with five softboxes")


def smooth(keys, t):
    """A curve through (t, value) keys, horizontal tangents only where it turns (cubic, monotone)."""
    slopes = []
    for k, (a, v) in enumerate(keys):
        left = (v - keys[k - 1][1]) / (a - keys[k - 1][0]) if k else 0
        right = (keys[k + 1][1] - v) / (keys[k + 1][0] - a) if k < len(keys) - 1 else 0
        if k in (0, len(keys) - 1):
            slopes.append(left + right)
        else:
            slopes.append(2 * left * right / (left + right) if left * right > 0 else 0)
    for k in range(len(keys) - 1):
        (a, v), (b, w) = keys[k], keys[k + 1]
        if t <= b or k == len(keys) - 2:
            u, h = (t - a) / (b - a), b - a
            return (v * (1 + 2 * u) * (1 - u) ** 2 + slopes[k] * h * u * (1 - u) ** 2 + w * u * u * (3 - 2 * u)
                    - slopes[k + 1] * h * u * u * (1 - u))


def loft(x0, x1, half, low, high, power, steps=60, sides=56):
    """A closed body along x: at each x a superellipse between low and high, `half` wide to each side; keys over [0, 1],
    denser at the ends, where it must shrink to nothing. Normals are smooth."""
    rows = []
    for i in range(steps + 1):
        t = .5 - .5 * math.cos(math.pi * (.004 + .992 * i / steps))
        w, z0, z1 = smooth(half, t), smooth(low, t), smooth(high, t)
        row = []
        for k in range(sides):
            a = 2 * math.pi * k / sides
            c, s = math.cos(a), math.sin(a)
            row.append((x0 + (x1 - x0) * t, w * math.copysign(abs(c) ** power, c),
                        (z0 + z1) / 2 + (z1 - z0) / 2 * math.copysign(abs(s) ** power, s)))
        rows.append(row)
    mesh = Mesh(normals=[])
    for i, row in enumerate(rows):
        for k, p in enumerate(row):
            along = sub(rows[min(i + 1, steps)][k], rows[max(i - 1, 0)][k])
            around = sub(row[(k + 1) % sides], row[k - 1])
            mesh.vertices.append(p)
            mesh.normals.append(normalized(cross(around, along) if x1 < x0 else cross(along, around)))
    for end, i in ((-1, 0), (1, steps)):
        middle = tuple(sum(p[k] for p in rows[i]) / sides for k in range(3))
        mesh.vertices.append(middle)
        mesh.normals.append((float(end), 0.0, 0.0))
        n = len(mesh.vertices) - 1
        for k in range(sides):
            a, b = i * sides + k, i * sides + (k + 1) % sides
            mesh.faces.append((n, b, a) if end < 0 else (n, a, b))
    for i in range(steps):
        for k in range(sides):
            a, b = i * sides + k, i * sides + (k + 1) % sides
            mesh.faces += [(a, b + sides, b), (a, a + sides, b + sides)]
    # The normals point out of the body: those of the first ring tell on which side they are.
    outward = sum(n[1] * v[1] for n, v in zip(mesh.normals, mesh.vertices))
    if outward < 0:
        mesh.normals = [tuple(-c for c in n) if abs(n[0]) < 1 else n for n in mesh.normals]
        flipped = mesh.flip()
        mesh = Mesh(mesh.vertices, flipped.faces, mesh.normals)
    return mesh


scene.add(box((-30, -30, -.2), (30, 30, 0)), "floor", "studio")

# ---- the car: 3.7 m long, its nose at -x
body = loft(-1.85, 1.85,
            [(0, .3), (.03, .62), (.1, .78), (.3, .84), (.7, .85), (.9, .79), (.97, .64), (1, .34)],
            [(0, .42), (.06, .27), (.15, .22), (.85, .22), (.95, .32), (1, .46)],
            [(0, .52), (.04, .64), (.15, .74), (.33, .84), (.6, .88), (.85, .85), (.95, .74), (1, .58)], .52)
place_ply(scene, "body", Piece(("paint", body)))
cabin = loft(-.78, 1.42,
             [(0, .3), (.05, .56), (.3, .68), (.6, .67), (.9, .56), (1, .34)],
             [(0, .72), (.5, .6), (1, .7)],
             [(0, .8), (.12, .95), (.3, 1.2), (.45, 1.33), (.62, 1.34), (.8, 1.2), (.93, 1.0), (1, .84)], .62)
place_ply(scene, "cabin", Piece(("dark-glass", cabin)))
roof = loft(-.18, 1.06,
            [(0, .3), (.08, .5), (.4, .61), (.7, .6), (.93, .5), (1, .3)],
            [(0, 1.12), (.4, 1.25), (.7, 1.22), (1, 1.02)],
            [(0, 1.19), (.15, 1.285), (.4, 1.368), (.62, 1.36), (.85, 1.25), (1, 1.1)], .6, 40, 48)
place_ply(scene, "roof", Piece(("paint", roof)))

tyre = [(.2, -.1), (.29, -.105), (.325, -.085), (.335, -.05), (.335, .05), (.325, .085), (.29, .105), (.2, .1),
        (.2, -.1)]
wheel = Piece(("rubber", lathe(tyre, 48, 50)),
              ("rim", lathe([(.2, -.06), (.205, .085), (.19, .09), (.18, .06), (.17, .03)], 40)),
              ("rim", lathe([(.05, -.02), (.05, .075), (.04, .085), (0, .09)], 28)))
for k in range(10):
    spoke = Mesh([(.04, -.022, .03), (.19, -.014, .03), (.19, .014, .03), (.04, .022, .03),
                  (.04, -.018, .072), (.19, -.01, .062), (.19, .01, .062), (.04, .018, .072)],
                 [(4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (2, 3, 7), (2, 7, 6)])
    wheel.add("rim", spoke.turn(36 * k))
wheel.add("rubber", lathe([(.2, -.03), (0, -.03)], 24).flip())
arch = Piece(("rubber", lathe([(.385, -.1), (.385, .03), (.36, .04), (.345, .03), (.345, -.1)], 48)))
for x in (-1.15, 1.13):
    for side in (-1, 1):
        place_side = wheel.turn(90 if side < 0 else -90, "x")
        scene.add(place_side.at(x, side * .78, .336), f"wheel {x} {side}")
        scene.add(arch.turn(90 if side < 0 else -90, "x").at(x, side * .8, .37), f"arch {x} {side}")
for side in (-1, 1):
    lamp = sphere(.11, 3).stretch(.8, 1, .8)
    scene.add(Piece(("lamp-glass", lamp.at(-1.655, side * .47, .575)),
                    ("red-glass", sphere(.09, 2).stretch(.5, 1.2, .8).at(1.76, side * .5, .68)),
                    ("second-paint", sphere(.09, 3).stretch(.6, 1, .7).at(-.4, side * .8, .95)),
                    ("second-paint", tube((-.36, side * .68, .8), (-.38, side * .76, .93), .02)),
                    ("chrome", box((-.02, -.012, -.01), (.16, .012, .01)).at(.42, side * .852, .72))), f"lamps {side}")
for z, x, w in ((.33, -1.79, .56), (.36, 1.78, .6)):
    scene.add(box((x - .04, -w, z - .035), (x + .04, w, z + .035)), f"bumper {z}", "chrome")

# ---- three balls beside it: the materials alone
for k, (x, y, r, name) in enumerate(((-1.9, -1.75, .26, "chrome"), (-1.2, -1.95, .22, "second-paint"),
                                     (-2.55, -1.45, .2, "paint"))):
    scene._use(name)
    scene.raw(f'AttributeBegin Translate {x} {y} {r} NamedMaterial "{name}" Shape "sphere" "float radius" {r} '
              "AttributeEnd")
scene.main(__file__)
