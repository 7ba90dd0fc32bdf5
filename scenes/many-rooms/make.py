#!/usr/bin/env python3
"""Writes many-rooms.pbrt: a maze of furnished rooms without roofs, seen from above, with N small mesh lights.

    make.py                            200 lights, many-rooms.pbrt beside this script (--check compares)
    make.py --lights N --out FILE      another number of lights; two rooms to five lights; of a large
                                       house the picture shows the middle, ten rooms wide
    make.py --triangles T --out FILE   lamps of T triangles in all (10 ... 1,000,000), T / 100 meshes from 10,000
                                       triangles on; every lamp places the same small PLY file
"""
import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from furniture import (armchair, bed, bookcase, chair, cupboard, globe_lamp, plant, round_table, rug, sofa, stool,
                       table)
from instancing import define, place
from scenekit import (Mesh, Piece, Random, Scene, beveled_box, box, coated, cylinder, diffuse, lathe, number, numbers,
                      ply, quad, sphere, tube, wall)

WALL, HEIGHT = .14, 2.3
LIGHTS = 200


def octahedron(radius):
    """The smallest bulb: 8 triangles."""
    p = [(radius, 0, 0), (-radius, 0, 0), (0, radius, 0), (0, -radius, 0), (0, 0, radius), (0, 0, -radius)]
    return Mesh(p, [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])


def bulb_mesh(radius, k):
    return octahedron(radius) if k == 0 else sphere(radius, k - 1, smooth=False)  # 8, 20 or 80 triangles


def bulb_of(triangles):
    """A bulb of radius 1 made of so many triangles: 2, 10, 20 or 100."""
    if triangles == 2:
        return quad((-.7, -.7, 0), (-.7, .7, 0), (.7, .7, 0), (.7, -.7, 0))  # a panel that shines downwards
    rings = {10: 1, 20: 2, 100: 5}[triangles]
    angles = [math.pi * (k / (rings + 1) - .5) for k in range(rings + 2)]
    profile = [(0 if k in (0, rings + 1) else math.cos(a), math.sin(a)) for k, a in enumerate(angles)]
    body = lathe(profile, triangles // (2 * rings))
    return Mesh(body.vertices, body.faces)


def split_triangles(triangles):
    """How many lamps of how many triangles: small scenes have several lamps, large ones a hundred triangles a lamp."""
    each = 2 if triangles < 100 else 10 if triangles < 1000 else 20 if triangles < 10000 else 100
    return max(1, round(triangles / each)), each


def hood(scene, at, radius):
    """Keeps the camera from seeing a bulb: bulbs as small as a pixel would give noise that no choice of lights can
    help."""
    if scene.lights == 1:
        define(scene, "hood", Piece(("paint-black", cylinder(1.7, 1.2, 1.25, 16).turn(28, "x").turn(-4))))
    place(scene, "hood", *at, 0, radius)


class SharedBulb:
    """One PLY file that all lamps place."""

    def __init__(self, triangles):
        self.mesh, self.triangles = bulb_of(triangles), triangles
        self.area = self.mesh.area()

    def light(self, scene, radius, at, watts, kelvin, label):
        scene._use("bulb-glass")
        scene.lights += 1
        file = f"{scene.name}-bulb-{self.triangles}.ply"
        hood(scene, at, radius)
        if file not in scene.files:
            scene.files[file] = ply(self.mesh)
        scene.raw(f'AttributeBegin Translate {numbers(at)} Scale {numbers((radius,) * 3)} # {label}\n'
                  f'AreaLightSource "diffuse" "blackbody L" {number(kelvin)} '
                  f'"float scale" {number(watts / (math.pi * self.area * radius * radius), 3)}\n'
                  f'NamedMaterial "bulb-glass" Shape "plymesh" "string filename" "{file}" AttributeEnd')


# ---- furniture; every entry: name -> (footprint width, depth, piece). Backs are at +y.

def bath_tub():
    piece = Piece(("ceramic", beveled_box((-.8, -.37, .02), (.8, .37, .16), .03)))
    for lo, hi in (((-.8, -.37, .1), (.8, -.3, .56)), ((-.8, .3, .1), (.8, .37, .56)),
                   ((-.8, -.31, .1), (-.7, .31, .56)), ((.7, -.31, .1), (.8, .31, .56))):
        piece.add("ceramic", beveled_box(lo, hi, .015))
    return piece.add("water", quad((-.705, -.305, .42), (.705, -.305, .42), (.705, .305, .42), (-.705, .305, .42)))


def basin():
    bowl = lathe([(0, .74), (.1, .74), (.24, .84), (.26, .88), (.245, .88), (.22, .84), (.08, .77), (0, .765)], 24)
    return Piece(("ceramic", cylinder(.07, 0, .745, 16)), ("ceramic", bowl.stretch(1.15, .85, 1)),
                 ("steel", tube((0, .2, .86), (0, .08, .98), .012)))


def toilet():
    bowl = lathe([(0, 0), (.13, 0), (.12, .2), (.19, .38), (.2, .42), (.15, .42), (.12, .3), (0, .26)], 20)
    return Piece(("ceramic", bowl.stretch(1, 1.2, 1).at(y=-.08)),
                 ("ceramic", beveled_box((-.2, .14, .36), (.2, .33, .8), .02)))


def counter(width, sink):
    piece = cupboard(width, .6, .88, "paint-cream", max(2, round(width / .5)), 1, "steel", .06)
    piece.add("worktop", beveled_box((-width / 2 - .01, -.32, .881), (width / 2 + .01, .3, .92), .005))
    if sink:
        piece.add("steel", box((-.3, -.2, .9205), (.3, .2, .924)), tube((0, .2, .92), (0, .2, 1.15), .012),
                  tube((0, .2, 1.15), (0, .04, 1.12), .012))
    else:
        piece.add("paint-black", box((-.28, -.24, .9205), (.28, .22, .926)))
        for x, y in ((-.14, -.12), (.14, -.12), (-.14, .11), (.14, .11)):
            piece.add("iron", cylinder(.08, .9265, .934, 14).at(x, y))
    return piece


def dining(seats, wood, fabric):
    long = .62 * seats / 2 + .3
    piece = table(long, .85, .74, wood)
    for k in range(seats // 2):
        x = (k - (seats / 2 - 1) / 2) * .62
        piece.include(chair(wood, fabric).at(x, -.62, 0, 178 + 5 * k), chair(wood, fabric).at(x, .62, 0, -4 * k))
    return piece


def desk():
    return table(1.25, .62, wood="walnut").include(chair("walnut", "leather").at(.05, -.42, 0, 168)).add(
        "paper", box((-.12, -.2, .741), (.1, .1, .746))).include(Piece(("book-b",
                                                                        box((.3, -.05, .741), (.48, .2, .775)))))


def coffee(fabric, pillow, seats):
    """A sofa with a rug and a low table before it."""
    return Piece().include(sofa(1.9 if seats == 3 else 1.5, .86, fabric, seats, pillow).at(0, .5),
                           rug(1.9, 1.3, "carpet-red" if seats == 3 else "carpet-blue").at(0, -.45),
                           round_table(.36, .4, "walnut", 20).at(0, -.42, .0135))


def music():
    """An upright piano and its stool."""
    piece = Piece(("dark-lacquer", beveled_box((-.74, .05, .02), (.74, .4, 1.2), .015)),
                  ("dark-lacquer", beveled_box((-.74, -.22, .55), (.74, .051, .68), .01)),
                  ("paper", box((-.64, -.19, .6805), (.64, -.03, .69))))
    for x in (-.7, .7):
        piece.add("dark-lacquer", box((x - .035, -.2, 0), (x + .035, -.13, .551)))
    for k in range(18):
        piece.add("paint-black", box((-.6 + .067 * k, -.11, .6905), (-.575 + .067 * k, -.03, .7)))
    return piece.include(stool(.19, .48, "walnut").at(0, -.5))


PIECES = {
    "bed-wide": (1.74, 2.14, lambda: bed(1.6, 2.0, "walnut", "fabric-blue").at(0, -.03)),
    "bed-rust": (1.74, 2.14, lambda: bed(1.6, 2.0, "oak", "fabric-rust").at(0, -.03)),
    "bed-small": (1.06, 2.14, lambda: bed(.9, 2.0, "pine", "fabric-green", 1).at(0, -.03)),
    "bed-sand": (1.06, 2.14, lambda: bed(.9, 2.0, "oak", "fabric-mustard", 1).at(0, -.03)),
    "sofa-blue": (1.95, 2.15, lambda: coffee("fabric-blue", ("fabric-mustard", "fabric-rust"), 3).at(0, .12)),
    "sofa-green": (1.95, 2.15, lambda: coffee("fabric-green", ("linen",), 2).at(0, .12)),
    "sofa-rust": (1.95, 2.15, lambda: coffee("fabric-rust", ("fabric-blue",), 2).at(0, .12)),
    "armchair": (.95, .9, lambda: armchair("fabric-mustard")),
    "armchair-grey": (.95, .9, lambda: armchair("fabric-grey", "fabric-rust")),
    "dining-6": (2.3, 2.2, lambda: dining(6, "oak", "fabric-grey")),
    "dining-4": (1.7, 2.2, lambda: dining(4, "walnut", "fabric-rust")),
    "desk": (1.3, 1.2, lambda: desk().at(0, .25)), "piano": (1.55, 1.2, lambda: music().at(0, .18)),
    "bookcase": (1.04, .34, lambda: bookcase(1.0, 1.8, .28, 4, "walnut", 3)),
    "bookcase-oak": (.84, .34, lambda: bookcase(.8, 1.5, .28, 4, "oak", 6)),
    "wardrobe": (1.45, .62, lambda: cupboard(1.4, .58, 1.9, "oak", 3, 0)),
    "chest": (1.05, .5, lambda: cupboard(1.0, .44, .8, "pine", 2, 3)),
    "sideboard": (1.55, .5, lambda: cupboard(1.5, .44, .75, "walnut", 3, 1)),
    "counter-sink": (1.85, .7, lambda: counter(1.8, True)), "counter-stove": (1.25, .7, lambda: counter(1.2, False)),
    "tub": (1.65, .8, bath_tub), "basin": (.64, .56, basin), "toilet": (.45, .78, toilet),
    "plant": (.6, .6, lambda: plant(1.0, 13, .16, 4)), "plant-tall": (.7, .7, lambda: plant(1.35, 16, .19, 7)),
    "rug-red": (2.05, 1.45, lambda: rug()), "rug-blue": (1.65, 1.15, lambda: rug(1.6, 1.1, "carpet-blue")),
    "stool": (.4, .4, lambda: stool()), "round": (.95, .95, lambda: round_table(.45))}

ROOMS = {  # name: (share, floors, pieces in order of importance; '|' gives a choice)
    "living": (5, ("boards", "boards-dark"),
               ["sofa-blue|sofa-green|sofa-rust", "armchair|armchair-grey", "bookcase", "sideboard",
                "armchair-grey|armchair",
                                              "plant|plant-tall", "bookcase-oak", "round", "stool"]),
    "bedroom": (5, ("boards", "boards-pale", "carpet-sand"),
                ["bed-wide|bed-rust|bed-small|bed-sand", "wardrobe", "chest|desk", "plant", "rug-blue|rug-red",
                                                              "armchair-grey", "bookcase-oak", "chest"]),
    "study": (2, ("boards-dark", "boards"),
              ["desk", "bookcase", "rug-red|rug-blue", "bookcase-oak", "bookcase", "armchair", "plant", "sideboard"]),
    "dining": (2, ("boards", "boards-pale"), ["dining-6|dining-4", "sideboard", "plant-tall", "bookcase-oak", "chest"]),
    "kitchen": (2, ("tiles-red", "tiles-blue"),
                ["counter-sink", "counter-stove", "dining-4|round", "sideboard", "stool", "stool", "plant", "chest"]),
    "bath": (2, ("tiles-blue", "tiles-black"), ["tub", "basin", "toilet", "wardrobe", "rug-blue", "plant", "stool"]),
    "music": (1, ("boards-dark",), ["piano", "armchair", "rug-blue", "bookcase", "plant-tall", "armchair-grey",
                                    "round"]),
    "hall": (2, ("boards-pale", "tiles-red"),
             ["rug-red", "sideboard", "plant-tall", "bookcase-oak", "wardrobe", "armchair", "plant"])}


class Maze:
    """Columns and rows of rooms; every room can be reached, most pairs of neighbours have no door."""

    def __init__(self, rooms, random):
        self.columns = max(2, round(math.sqrt(rooms * 4 / 3)))
        self.rows = max(2, -(-rooms // self.columns))
        self.xs, self.ys = [0.0], [0.0]
        for _ in range(self.columns):
            self.xs.append(self.xs[-1] + random.uniform(2.7, 4.5))
        for _ in range(self.rows):
            self.ys.append(self.ys[-1] + random.uniform(2.7, 4.2))
        edges = [((i, j), (i + 1, j)) for i in range(self.columns - 1) for j in range(self.rows)]
        edges += [((i, j), (i, j + 1)) for i in range(self.columns) for j in range(self.rows - 1)]
        for k in range(len(edges) - 1, 0, -1):
            m = random.integer(k + 1)
            edges[k], edges[m] = edges[m], edges[k]
        parent = {(i, j): (i, j) for i in range(self.columns) for j in range(self.rows)}

        def root(cell):
            while parent[cell] != cell:
                cell = parent[cell]
            return cell
        self.doors = {}  # (a, b): (from, to, top), along x or y
        for a, b in edges:
            joined = root(a) != root(b)
            if joined:
                parent[root(a)] = root(b)
            if not joined and random.unit() > .08:
                continue
            axis = self.ys if a[0] != b[0] else self.xs  # the shared wall runs along this axis
            k = a[1] if a[0] != b[0] else a[0]
            lo, hi = axis[k] + WALL, axis[k + 1] - WALL
            wide = random.unit() < .12
            w = .62 * (hi - lo) if wide else .92
            start = lo + (hi - lo - w) * (.5 if wide else random.uniform(.12, .88))
            self.doors[a, b] = (start, start + w, HEIGHT + 1 if wide else 2.02)

    def between(self, a, b):
        return self.doors.get((a, b)) or self.doors.get((b, a))


def walls(maze, random, scene):
    """Walls along x run through; those along y end inside them and are a little lower, so that no faces coincide."""
    inner = Piece()
    xs, ys = maze.xs, maze.ys
    for j, y in enumerate(ys):
        start, holes = xs[0] - WALL / 2, []
        for i in range(maze.columns):
            if 0 < j < maze.rows:
                door = maze.between((i, j - 1), (i, j))
                if door:
                    holes.append((door[0] - start, door[1] - start, -.01, min(door[2], HEIGHT)))
            elif random.unit() < .6:  # windows
                c = (xs[i] + xs[i + 1]) / 2 - start
                holes.append((c - .55, c + .55, .85, 1.95))
        inner.add("wall", wall((start, y), (xs[-1] + WALL / 2, y), WALL, HEIGHT, holes, -.01))
    for i, x in enumerate(xs):
        for j in range(maze.rows):
            start, holes = ys[j] + WALL / 2 - .02, []
            door = maze.between((i - 1, j), (i, j)) if 0 < i < maze.columns else None
            if door:
                holes.append((door[0] - start, door[1] - start, -.01, min(door[2], HEIGHT - .003)))
            elif i in (0, maze.columns) and random.unit() < .6:
                c = (ys[j] + ys[j + 1]) / 2 - start
                holes.append((c - .5, c + .5, .85, 1.95))
            inner.add("wall", wall((x, start), (x, ys[j + 1] - WALL / 2 + .02), WALL, HEIGHT - .003, holes, -.01))
    scene.add(inner, "walls")
    trims = Piece()
    for (a, b), (lo, hi, top) in maze.doors.items():  # linings of the doors
        if top > HEIGHT:
            continue
        t, across = WALL / 2 + .012, a[0] != b[0]
        c = xs[b[0]] if across else ys[b[1]]
        for p, q, z0, z1 in ((lo - .05, lo + .02, 0, top + .05), (hi - .02, hi + .05, 0, top + .05),
                             (lo + .021, hi - .021, top - .02, top + .05)):
            trims.add("trim", box((c - t, p, z0), (c + t, q, z1)) if across else box((p, c - t, z0), (q, c + t, z1)))
    scene.add(trims, "door linings")


class Room:
    """The free floor of one room: rectangles that are taken, and places for more."""

    def __init__(self, x0, y0, x1, y1, doors, random):
        self.area, self.random, self.taken = (x0, y0, x1, y1), random, list(doors)

    def free(self, r):
        x0, y0, x1, y1 = self.area
        return (r[0] >= x0 and r[1] >= y0 and r[2] <= x1 and r[3] <= y1
                and not any(r[0] < t[2] and t[0] < r[2] and r[1] < t[3] and t[1] < r[3] for t in self.taken))

    def along_wall(self, width, depth, corner=False, tries=40):
        """(x, y, turn) with the back at a wall; corners are preferred for what does not need a wall's middle."""
        x0, y0, x1, y1 = self.area
        for _ in range(tries):
            side = self.random.integer(4)
            w, d = (width, depth) if side in (0, 2) else (depth, width)
            u = self.random.integer(2) if corner or self.random.unit() < .4 else self.random.unit()
            gap = .02
            if side in (0, 2):
                x = x0 + gap + w / 2 + u * max(x1 - x0 - w - 2 * gap, 0)
                y = y1 - gap - d / 2 if side == 0 else y0 + gap + d / 2
            else:
                y = y0 + gap + d / 2 + u * max(y1 - y0 - d - 2 * gap, 0)
                x = x1 - gap - w / 2 if side == 1 else x0 + gap + w / 2
            r = (x - w / 2, y - d / 2, x + w / 2, y + d / 2)
            if self.free(r):
                self.taken.append(r)
                return x, y, (0, -90, 180, 90)[side]
        return None

    def in_the_middle(self, width, depth, tries=20):
        x0, y0, x1, y1 = self.area
        for _ in range(tries):
            turn = 90 * self.random.integer(2)
            w, d = (width, depth) if turn == 0 else (depth, width)
            x, y = ((a + b) / 2 + self.random.uniform(-.35, .35) * (b - a - s) * .8
                    for a, b, s in ((x0, x1, w), (y0, y1, d)))
            r = (x - w / 2, y - d / 2, x + w / 2, y + d / 2)
            if self.free(r):
                self.taken.append(r)
                return x, y, turn + self.random.uniform(-6, 6)
        return None


MIDDLE = {"dining-6", "dining-4", "round", "rug-red", "rug-blue", "stool"}
CORNER = {"plant", "plant-tall", "armchair", "armchair-grey"}
TALL = {"wardrobe", "bookcase", "plant-tall"}  # no wall lamp before these
TOPS = {"sideboard": .75, "chest": .8, "bookcase-oak": 1.5, "round": .72}  # lamps may stand on these


def furnish(room, kind, random, scene, used):
    """Places the pieces of a kind of room; returns the tops on which a lamp may stand."""
    tops = []
    for entry in ROOMS[kind][2]:
        name = random.pick(entry.split("|"))
        if name not in PIECES:
            raise KeyError(name)
        w, d, make = PIECES[name]
        spot = room.in_the_middle(w, d) if name in MIDDLE else room.along_wall(w, d, name in CORNER)
        if not spot:
            continue
        if name not in used:
            used.add(name)
            define(scene, name, make())
        x, y, turn = spot
        if name in TALL:
            room.tall.append(room.taken[-1])
        place(scene, name, x, y, .0045, turn + (random.uniform(-25, 25) if name in CORNER else 0))
        if name in TOPS:
            s = random.uniform(-.25, .25) * w if name != "round" else 0
            c, sn = math.cos(math.radians(turn)), math.sin(math.radians(turn))
            tops.append((x + c * s, y + sn * s, .0045 + TOPS[name]))
    return tops


def lamp(scene, random, room, tops, used, bulb):
    """One small mesh light: on a piece of furniture, as a floor lamp, or on a wall."""
    mesh_kind = random.integer(3)
    kelvin = random.pick((2300, 2500, 2700, 2700, 2700, 3000, 3000, 3600, 5000, 7000))
    watts = random.uniform(5, 12) * (1.3 if kelvin > 4000 else 1)
    spot = None
    if tops and random.unit() < .75:
        name, height, radius, spot = "table-lamp", .4, .06, tops.pop()
    elif random.unit() < .75:
        height = (1.5, 1.2, 1.65)[random.integer(3)]
        name, radius = f"floor-lamp-{height}", .075
        found = room.along_wall(.3, .3, True, 60)
        spot = found and (found[0], found[1], .0045)
    if spot:
        if name not in used:
            used.add(name)
            define(scene, name, globe_lamp(height, radius, "paint-black")[0])
        place(scene, name, *spot)
        at = (spot[0], spot[1], spot[2] + height - radius)
    else:  # a globe on an arm from the wall, between the doors
        name, radius = "wall-lamp", .06
        x0, y0, x1, y1 = room.area
        for _ in range(200):
            side, u, z = random.integer(4), random.uniform(.1, .9), random.uniform(1.55, 1.85)
            x, y, turn = ((x0 + u * (x1 - x0), y1, 0), (x1, y0 + u * (y1 - y0), -90), (x0 + u * (x1 - x0), y0, 180),
                          (x0, y0 + u * (y1 - y0), 90))[side]
            at = (x - .17 * (side == 1) + .17 * (side == 3), y - .17 * (side == 0) + .17 * (side == 2), z)
            away = all(max(abs(at[0] - lx), abs(at[1] - ly)) > .3 for lx, ly in room.lamps)
            clear = not any(d[0] - .15 < at[0] < d[2] + .15 and d[1] - .15 < at[1] < d[3] + .15
                            for d in room.doors + room.tall)
            if away and clear:
                break
        if name not in used:
            used.add(name)
            define(scene, name, Piece(("paint-black", tube((0, .002, 0), (0, -.115, 0), .008)),
                                      ("paint-black", lathe([(.04, 0), (.04, .01), (0, .012)], 16).turn(90, "x"))))
        place(scene, name, x, y, z, turn)
    room.lamps.append(at[:2])
    if bulb:
        bulb.light(scene, radius, at, watts, kelvin, name)
    else:
        scene.light(bulb_mesh(radius, mesh_kind).at(*at), watts, kelvin, name)
        hood(scene, at, radius)


def fit_camera(scene, maze, fov, aspect):
    """From the south, steeply from above, as near as the whole house allows; of a large one, as its middle does."""
    def middle(lines, most):
        cut = max(len(lines) - 1 - most, 0)
        return lines[cut // 2], lines[len(lines) - 1 - (cut - cut // 2)]
    (x0, x1), (y0, y1) = middle(maze.xs, 10), middle(maze.ys, 8)
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    tilt = math.radians(62)
    back = (math.sin(math.radians(-4)) * math.cos(tilt), -math.cos(math.radians(-4)) * math.cos(tilt), math.sin(tilt))
    right = (-back[1] / math.cos(tilt), back[0] / math.cos(tilt), 0)
    up = (back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2],
          back[0] * right[1] - back[1] * right[0])
    half = math.tan(math.radians(fov / 2)) * .97
    corners = [(cx, cy, cz) for cx in (x0, x1) for cy in (y0, y1) for cz in (0, HEIGHT)]

    def project(target, distance):
        out = []
        for c in corners:
            d = [c[k] - target[k] for k in range(3)]
            depth = distance - sum(d[k] * back[k] for k in range(3))
            out.append((sum(d[k] * right[k] for k in range(3)) / depth, sum(d[k] * up[k] for k in range(3)) / depth))
        return out
    target, distance = [x, y, 0.0], 1.0
    for _ in range(40):  # centre, then distance
        lo, hi = 0.0, 1e4
        for _ in range(50):
            distance = (lo + hi) / 2
            p = project(target, distance) if distance > 1.2 * (y1 - y0) else None
            spread = p and (max(a for a, _ in p) - min(a for a, _ in p) <= 2 * half * aspect
                            and max(b for _, b in p) - min(b for _, b in p) <= 2 * half)
            lo, hi = (lo, distance) if spread else (distance, hi)
        p = project(target, distance)
        mx, my = (max(a for a, _ in p) + min(a for a, _ in p)) / 2, (max(b for _, b in p) + min(b for _, b in p)) / 2
        for k in range(2):
            target[k] += distance * (mx * right[k] + my * up[k] / max(up[0] ** 2 + up[1] ** 2, .1))
    scene.camera(tuple(target[k] + distance * back[k] for k in range(3)), tuple(target), fov)


def make(lights, bulb=None):
    """`bulb`: what all lamps place; none: a mesh of its own for every lamp."""
    random = Random(2023)
    scene = Scene("many-rooms", f"A maze of furnished rooms without roofs, {lights} small lamps of "
                  f"{bulb.triangles if bulb else '8, 20 or 80'} triangles: walls hide nearly every lamp from nearly every"
                  " point.",
                  maxdepth=5, iso=320, whitebalance=3700)
    for name, text in {"water": coated(.3, .45, .5, .01), "paint-cream": diffuse(.72, .66, .52),
                       "worktop": coated(.12, .12, .13, .1),
                       "ground": diffuse(.12, .12, .11)}.items():
        scene.material(name, text)
    for name, a, b, u, v in (("boards", (.42, .27, .155), (.36, .225, .13), .55, 5.5),
                             ("boards-dark", (.25, .15, .09), (.21, .125, .075), .6, 6),
                             ("boards-pale", (.56, .42, .27), (.5, .37, .235), .5, 4.5),
                             ("tiles-red", (.5, .26, .17), (.6, .5, .38), 3, 3),
                             ("tiles-blue", (.62, .64, .62), (.3, .42, .5), 4, 4),
                             ("tiles-black", (.66, .65, .62), (.07, .07, .075), 3.5, 3.5)):
        scene.texture(name, "spectrum", "checkerboard", '"string mapping" "planar" "vector3 v1" [ %g 0 0 ] '
                      '"vector3 v2" [ 0 %g 0 ] '
                      '"rgb tex1" [ %g %g %g ] "rgb tex2" [ %g %g %g ]' % ((u, v) + a + b))
        scene.material(name, f'"string type" "diffuse" "texture reflectance" "{name}"')

    maze = Maze(max(4, round(lights * .4)), random)
    xs, ys = maze.xs, maze.ys
    fit_camera(scene, maze, 26, 4 / 3)
    scene.add(box((-1.4, -1.4, -.3), (xs[-1] + 1.4, ys[-1] + 1.4, 0)), "ground", "ground")
    walls(maze, random, scene)

    bag = [kind for kind, (share, _, _) in ROOMS.items() for _ in range(share)]
    count = maze.columns * maze.rows
    wanted = [lights // count if lights < count else 1 for _ in range(count)]
    while sum(wanted) < lights:
        k = random.integer(count)
        if wanted[k] < 5 + lights // count:
            wanted[k] += 1
    floors, used = {}, set()
    for j in range(maze.rows):
        for i in range(maze.columns):
            area = (xs[i] + WALL / 2 + .015, ys[j] + WALL / 2 + .015, xs[i + 1] - WALL / 2 - .015,
                    ys[j + 1] - WALL / 2 - .015)
            doors = []
            for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                door = maze.between((i, j), (i + di, j + dj))
                if door:
                    reach = .6
                    if di:
                        c = xs[i + (di > 0)]
                        doors.append((c - reach, door[0] - .05, c + reach, door[1] + .05))
                    else:
                        c = ys[j + (dj > 0)]
                        doors.append((door[0] - .05, c - reach, door[1] + .05, c + reach))
            kind = random.pick(bag)
            floors.setdefault(random.pick(ROOMS[kind][1]), []).append((xs[i], ys[j], xs[i + 1], ys[j + 1]))
            room = Room(*area, doors, random)
            room.doors, room.lamps, room.tall = doors, [], []
            scene.raw(f"\n# {kind} in column {i + 1}, row {j + 1}")
            tops = furnish(room, kind, random, scene, used)
            for _ in range(wanted[j * maze.columns + i]):
                lamp(scene, random, room, tops, used, bulb)
    for material, rectangles in floors.items():
        scene.add(Piece(*[(material, quad((x0, y0, .004), (x1, y0, .004), (x1, y1, .004), (x0, y1, .004)))
                          for x0, y0, x1, y1 in rectangles]), f"floors: {material}")
    return scene


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--lights", type=int, default=LIGHTS, help="how many mesh lights (default 200)")
    arguments.add_argument("--triangles", type=int, help="how many triangles all lamps have together")
    arguments.add_argument("--out", type=pathlib.Path, help="where to write; needed with --lights and --triangles")
    arguments.add_argument("--check", action="store_true", help="compare with the committed file")
    options = arguments.parse_args()
    if options.triangles is not None and not 2 <= options.triangles <= 1000000:
        arguments.error("--triangles: 2 to 1,000,000")
    if options.lights < 1:
        arguments.error("--lights: at least 1")
    if options.out:
        lamps, each = split_triangles(options.triangles) if options.triangles else (options.lights, 0)
        made = make(lamps, SharedBulb(each) if each else None)
        if made.files:
            for file, data in made.files.items():
                (options.out.parent / file).write_bytes(data)
        options.out.write_text(made.text())
        print(f"{options.out}: {made.lights} lights" + (f", {made.lights * each} triangles" if each else ""))
    elif options.lights != LIGHTS or options.triangles:
        arguments.error("--lights and --triangles need --out")
    else:
        scene = make(LIGHTS)
        scene.world_apart = True
        scene.main(__file__)
