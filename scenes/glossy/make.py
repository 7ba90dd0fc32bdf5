#!/usr/bin/env python3
"""Writes glossy.pbrt: a bar with metal ware under strings of small coloured lamps."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from instancing import place_ply, rgb_light
from scenekit import (Piece, Random, Scene, beveled_box, box, coated, cylinder, diffuse, lathe, metal, room, sphere,
                      tinted_metal, tube)

WIDTH, DEPTH, HEIGHT = 3.6, 3.2, 2.5  # the bar; the counter stands at the far wall, y = DEPTH
TOP = 0.92                            # of the counter

scene = Scene("glossy", "Metal and glazed ware on a bar under 46 small coloured lamps: at a rough mirror the BSDF, not"
              " the distance, decides which lamp matters.", maxdepth=5)
scene.camera((1.66, 1.0, 1.4), (1.82, 2.8, 1.24), 32.5)

for name, text in {
        "copper": metal("Cu", .035), "copper-rough": metal("Cu", .1), "brass-fine": metal("CuZn", .02),
        "brass-rough": metal("CuZn", .09), "aluminium": metal("Al", .05), "silver": metal("Ag", .02),
        "gold": metal("Au", .05), "gun-metal": tinted_metal(.34, .35, .38, .06),
        "rose-metal": tinted_metal(.75, .5, .46, .04),
        "panel": tinted_metal(.56, .56, .55, .045), "panel-dark": tinted_metal(.42, .43, .45, .07),
        "glaze-blue": coated(.05, .13, .3, .02), "glaze-green": coated(.06, .2, .13, .03),
        "glaze-red": coated(.32, .05, .04, .02), "glaze-white": coated(.7, .68, .62, .03),
        "bar-top": coated(.13, .065, .035, .015), "bar-front": coated(.16, .08, .045, .12),
        "car-paint": '"string type" "coatedconductor" "spectrum conductor.eta" "metal-Cu-eta" '
                     '"spectrum conductor.k" "metal-Cu-k" '
                     '"float conductor.roughness" .12 "float interface.roughness" .01',
        "wall-dark": diffuse(.2, .13, .1), "wire": diffuse(.05, .05, .05),
        "shade": diffuse(.5, .46, .4)}.items():
    scene.material(name, text)


def hollow(outer, thickness, sides=32):
    """A vessel: up the outer profile, over the rim and down the inner one."""
    inner = [(max(r - thickness, 0.0), z) for r, z in reversed(outer) if z > outer[0][1] + thickness]
    floor = outer[0][1] + thickness
    return lathe([(0, outer[0][1])] + outer + inner + [(max(inner[-1][0] - .004, .001), floor), (0, floor)], sides)


def curve(points, steps=3):
    """A smooth profile through the points (Catmull-Rom)."""
    out = []
    for k in range(len(points) - 1):
        p = [points[max(k - 1, 0)], points[k], points[k + 1], points[min(k + 2, len(points) - 1)]]
        for s in range(steps):
            t = s / steps
            out.append(tuple(0.5 * (2 * p[1][i] + (p[2][i] - p[0][i]) * t
                                    + (2 * p[0][i] - 5 * p[1][i] + 4 * p[2][i] - p[3][i]) * t * t
                                    + (3 * p[1][i] - p[0][i] - 3 * p[2][i] + p[3][i]) * t ** 3) for i in (0, 1)))
    return out + [points[-1]]


def shaker(material):
    body = lathe([(0, 0), (.04, 0), (.043, .004)] + curve([(.043, .005), (.047, .07), (.046, .14), (.042, .16)])
                 + curve([(.040, .161), (.036, .19), (.022, .21)])
                 + [(.021, .211), (.02, .24), (.015, .247), (0, .248)], 32)
    return Piece((material, body))


def mug(material, radius=.042, height=.085):
    cup = hollow([(radius * .94, 0), (radius, .006), (radius, height)], .0025)
    handle, n = [], 7
    for k in range(n + 1):
        a = math.pi * (k / n - .5)
        handle.append((radius - .001 + .028 * math.cos(a), 0, height * .5 + height * .33 * math.sin(a)))
    return Piece((material, cup), *[(material, tube(a, b, .0035)) for a, b in zip(handle, handle[1:])])


def bowl(material, radius=.13, height=.075):
    return Piece((material, hollow([(radius * .35, 0), (radius * .36, .008)]
                                   + curve([(radius * .38, .009), (radius * .75, height * .35), (radius, height)], 5),
                                   .003)))


def carafe(material):
    points = [(.055, .004), (.075, .06), (.06, .13), (.028, .19), (.024, .23), (.034, .262)]
    return Piece((material, hollow([(.05, 0)] + curve(points), .003)))


def bottle(material):
    body = lathe([(0, 0), (.036, 0)] + curve([(.038, .003), (.038, .15), (.034, .185), (.014, .225), (.0135, .275)],
                                             3) + [(0, .275)], 28)
    return Piece((material, body), ("brass-fine", cylinder(.016, .27, .305, 16)))


def goblet(material):
    return Piece((material, hollow(curve([(.036, 0), (.03, .006), (.007, .02), (.007, .075), (.03, .1), (.042, .14),
                                          (.038, .185)], 4), .002)))


def vase(material):
    points = [(.04, 0), (.075, .07), (.085, .14), (.05, .23), (.03, .27), (.042, .31)]
    return Piece((material, hollow(curve(points, 4), .004)))


def ball(material):
    return Piece((material, sphere(1, 3).at(z=1)))


# ---- the room and the bar
scene.add(room(WIDTH, DEPTH, HEIGHT, floor="walnut", paint="wall-dark", ceiling="wall-dark"), "room")
bar = Piece(("bar-top", beveled_box((-.05, DEPTH - .68, TOP - .05), (WIDTH + .05, DEPTH + .02, TOP), .008)),
            ("bar-front", box((-.02, DEPTH - .6, -.02), (WIDTH + .02, DEPTH + .01, TOP - .052), ("bottom",))))
for k in range(9):  # frames on the front
    x = .02 + k * .4
    bar.add("bar-front", beveled_box((x + .03, DEPTH - .615, .12), (x + .37, DEPTH - .59, TOP - .12), .012))
bar.add("brass-fine", tube((0, DEPTH - .78, .2), (WIDTH, DEPTH - .78, .2), .02, 24))
scene.add(bar, "bar")

splash, random = Piece(), Random(11)
for i in range(10):  # metal sheets behind the bar, alternating, slightly out of plane as hand-set sheets are
    for j in range(2):
        x0, z0 = .03 + i * .355, TOP + .03 + j * .27
        tilt = (random.uniform(-.002, .002), random.uniform(-.002, .002))
        y = DEPTH - .016
        splash.add("panel" if (i + j) % 2 else "panel-dark",
                   box((x0, y - .003, z0), (x0 + .35, DEPTH + .004, z0 + .265)).copy_with(
                       lambda v: (v[0], v[1] + (tilt[0] * (v[0] - x0) / .35 if v[1] < DEPTH else 0), v[2]),
                       lambda n: n))
scene.add(splash, "sheets")

SHELVES = (1.5, 1.84, 2.18)
shelves = Piece()
for z in SHELVES:
    shelves.add("bar-front", beveled_box((.3, DEPTH - .23, z), (WIDTH - .3, DEPTH + .01, z + .028), .004))
    if z == SHELVES[0]:  # hides the lamps under it
        shelves.add("bar-front", box((.3, DEPTH - .236, z - .055), (WIDTH - .3, DEPTH - .2305, z + .02)))
    for x in (.6, 1.4, 2.2, 3.0):
        shelves.add("brass-fine", box((x - .008, DEPTH - .2, z - .025), (x + .008, DEPTH + .005, z + .002)),
                    box((x - .008, DEPTH - .012, z - .12), (x + .008, DEPTH + .005, z - .02)))
scene.add(shelves, "shelves")

# ---- what stands on it
Y = DEPTH - .4
def put(shape, material, x, y, z, turn=0.0, scale=1.0):
    """One vessel."""
    place_ply(scene, shape.__name__, shape(material), x, y, z + .0005, turn, scale)


for shape, material, x, y, turn, *scale in [
        (shaker, "silver", 1.31, Y + .04, 0), (mug, "copper", 1.15, Y - .13, -35),
        (mug, "copper-rough", 1.03, Y - .02, 20),
        (mug, "copper", 1.2, Y + .06, 160), (bowl, "brass-rough", 1.56, Y - .1, 0),
        (carafe, "aluminium", 1.47, Y + .16, 0),
        (vase, "car-paint", 2.06, Y + .12, 0), (goblet, "gold", 1.8, Y - .15, 0), (goblet, "gold", 1.91, Y - .06, 0),
        (goblet, "rose-metal", 1.78, Y + .05, 0), (bowl, "glaze-white", 2.12, Y - .14, 0, .77),
        (carafe, "glaze-blue", 2.29, Y + .1, 0, .9), (mug, "gun-metal", 2.37, Y - .14, -60, 1.1),
        (vase, "glaze-green", .87, Y + .1, 0, .8), (bowl, "copper-rough", .8, Y - .12, 0, .93)]:
    put(shape, material, x, y, TOP, turn, *scale)
put(shaker, "rose-metal", 2.55, Y + .04, TOP + .004)
for material, r, x, dy, dz in [("glaze-red", .036, 1.59, -.075, .018), ("gold", .033, 1.615, -.13, .018),
                               ("glaze-green", .03, 1.52, -.06, .018), ("brass-fine", .024, 1.55, -.125, .012)]:
    put(ball, material, x, Y + dy, TOP + dz, 0.0, r)
scene.add(lathe([(0, 0), (.17, 0), (.19, .012), (.187, .014), (.168, .004), (0, .004)], 64).stretch(1.15, .72, 1).at(
    2.6, Y - .03, TOP + .0005), "tray", "silver")

materials = ["glaze-blue", "gun-metal", "glaze-green", "brass-rough", "glaze-red", "aluminium", "glaze-white",
             "copper", "rose-metal"]
random = Random(4)
for k in range(17):
    x = .42 + k * .165
    for level, z in enumerate(SHELVES):
        m = materials[(k * 4 + level * 2) % len(materials)]
        shape, size = ((bottle, (.85, .92, .98)[random.integer(3)]), (carafe, .8), (goblet, 1), (vase, .72),
                       (shaker, 1), (mug, 1))[
            (k + level * (1 + k // 5)) % 6 if level else (0, 0, 4, 0, 2)[k % 5]]
        put(shape, m, x + random.uniform(-.02, .02), DEPTH - .12 + random.uniform(-.015, .015), z + .028,
            random.uniform(0, 360), size)

# ---- lamps
COLOURS = {"warm": (1, .55, .2), "red": (1, .012, .006), "amber": (1, .3, .008), "green": (.012, .75, .04),
           "blue": (.008, .05, 1), "violet": (.4, .012, .9)}
ORDER = ["warm", "red", "warm", "blue", "amber", "warm", "green", "violet"]


# Shades keep the camera from seeing the bulbs: the edges of bright bulbs as small as a pixel give noise that no choice
# of lights can help.
def shade(radius, at):
    """A half bowl around a bulb, open towards the bar and down."""
    profile = [(radius * r, radius * z) for r, z in ((0, -1.5), (.55, -1.45), (1.25, -1), (1.6, -.3), (1.7, .5))]
    return lathe(profile + [(.97 * r, z + .04 * radius) for r, z in reversed(profile)], 20).turn(-125, "x").at(*at)


def lamp(position, watts, colour, radius, label):
    """A small round bulb of 80 triangles."""
    rgb_light(scene, sphere(radius, 1, smooth=False).at(*position), watts, COLOURS[colour], f"{label}, {colour}")


fittings = Piece()
for row, (y, z, sag, count) in enumerate([(DEPTH - .55, 1.78, .16, 16), (DEPTH - .95, 1.98, .2, 14)]):
    points = []
    for k in range(count + 1):
        t = k / count
        points.append((.12 + (WIDTH - .24) * t, y + .06 * math.sin(5 * t + row), z - sag * 4 * t * (1 - t)))
    fittings.add("wire", *[tube(a, b, .0025, 4) for a, b in zip(points, points[1:])])
    for k, ((xa, ya, za), (xb, yb, zb)) in enumerate(zip(points, points[1:])):
        p = ((xa + xb) / 2, (ya + yb) / 2, (za + zb) / 2)
        colour = ORDER[(k * 3 + row * 2) % len(ORDER)]
        fittings.add("shade", shade(.025, (p[0], p[1], p[2] - .055)))
        fittings.add("wire", cylinder(.009, p[2] - .03, p[2] + .002, 8).at(p[0], p[1]))
        lamp((p[0], p[1], p[2] - .055), 4.2 if colour == "warm" else 3.9, colour, .025, f"string {row + 1}")
for k in range(16):  # under the lowest shelf, behind its edge
    x = .42 + k * .184
    colour = ("amber", "warm", "blue", "warm", "red", "warm", "violet", "green")[k % 8]
    fittings.add("wire", cylinder(.011, SHELVES[0] - .012, SHELVES[0] + .002, 12).at(x, DEPTH - .19))
    lamp((x, DEPTH - .19, SHELVES[0] - .023), .7, colour, .009, "under the shelf")
scene.add(fittings, "wires and sockets")

if __name__ == "__main__":
    scene.main(__file__)
