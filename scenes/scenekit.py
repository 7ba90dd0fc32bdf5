"""What the scene scripts share: meshes, pieces of several materials, walls with openings, lights, and the writer.

Units are metres, z is up, x and y span the floor (right-handed; the camera line flips for pbrt). Faces are wound so
that the cross product points outwards; lights emit to that side. furniture.py builds on this: tables, lamps, doors.
A script makes a Scene, adds pieces and lights, and ends with `scene.main(__file__)`, which writes <name>.pbrt beside
the script, or with --check compares what is there. Only the standard library is needed."""
import math
import pathlib
import struct
import sys

INLINE_VERTICES = 2500  # larger meshes go into PLY files


def number(value, digits=4):
    """The shortest decimal text, at most `digits` after the point, no needless zeros."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{value:.0f}"
    if text in ("-0", ""):
        return "0"
    return text.replace("-0.", "-.") if text.startswith("-0.") else text[1:] if text.startswith("0.") else text


def numbers(values, digits=4):
    return " ".join(number(v, digits) for v in values)


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalized(a):
    length = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    return (a[0] / length, a[1] / length, a[2] / length) if length else (0.0, 0.0, 1.0)


class Mesh:
    """Triangles; `normals` (one a vertex) only where the surface is meant to look smooth."""

    def __init__(self, vertices=(), faces=(), normals=None):
        self.vertices = list(vertices)
        self.faces = list(faces)
        self.normals = None if normals is None else list(normals)

    def copy_with(self, point, direction):
        normals = None if self.normals is None else [normalized(direction(n)) for n in self.normals]
        return Mesh([point(v) for v in self.vertices], self.faces, normals)

    def at(self, x=0.0, y=0.0, z=0.0):
        return self.copy_with(lambda v: (v[0] + x, v[1] + y, v[2] + z), lambda n: n)

    def turn(self, degrees, axis="z"):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]

        def apply(v):
            out = list(v)
            out[i], out[j] = c * v[i] - s * v[j], s * v[i] + c * v[j]
            return tuple(out)
        return self.copy_with(apply, apply)

    def stretch(self, x=1.0, y=1.0, z=1.0):
        """Positive factors only."""
        return self.copy_with(lambda v: (v[0] * x, v[1] * y, v[2] * z), lambda n: (n[0] / x, n[1] / y, n[2] / z))

    def flip(self):
        normals = None if self.normals is None else [(-n[0], -n[1], -n[2]) for n in self.normals]
        return Mesh(self.vertices, [(a, c, b) for a, b, c in self.faces], normals)

    def area(self):
        total = 0.0
        for a, b, c in self.faces:
            n = cross(sub(self.vertices[b], self.vertices[a]), sub(self.vertices[c], self.vertices[a]))
            total += 0.5 * math.sqrt(n[0] ** 2 + n[1] ** 2 + n[2] ** 2)
        return total


def join(*meshes):
    """One mesh; all parts must be smooth or all flat."""
    out = Mesh(normals=[] if meshes and meshes[0].normals is not None else None)
    for mesh in meshes:
        first = len(out.vertices)
        out.vertices += mesh.vertices
        out.faces += [(a + first, b + first, c + first) for a, b, c in mesh.faces]
        if (mesh.normals is None) != (out.normals is None):
            raise ValueError("smooth and flat meshes do not join")
        if mesh.normals is not None:
            out.normals += mesh.normals
    return out


class Piece:
    """Several meshes, each with the name of its material; moves and turns as one."""

    def __init__(self, *parts):
        self.parts = list(parts)

    def add(self, material, *meshes):
        self.parts += [(material, mesh) for mesh in meshes]
        return self

    def include(self, *pieces):
        for piece in pieces:
            self.parts += piece.parts
        return self

    def mapped(self, f):
        return Piece(*[(material, f(mesh)) for material, mesh in self.parts])

    def at(self, x=0.0, y=0.0, z=0.0, turn=0.0):
        """Turned about z first, then moved."""
        return self.mapped(lambda m: (m.turn(turn) if turn else m).at(x, y, z))

    def turn(self, degrees, axis="z"):
        return self.mapped(lambda m: m.turn(degrees, axis))

    def paint(self, **changes):
        """The same piece in other materials: paint(oak="walnut"); '-' in a name is written '_'."""
        names = {k.replace("_", "-"): v for k, v in changes.items()}
        return Piece(*[(names.get(material, material), mesh) for material, mesh in self.parts])


# ---- shapes ----------------------------------------------------------------------------------------------------------

def quad(a, b, c, d):
    """Counter-clockwise seen from the side its normal points to."""
    return Mesh([a, b, c, d], [(0, 1, 2), (0, 2, 3)])


def panel(width, depth, nx=1, ny=1, down=False):
    """A horizontal rectangle about the origin, facing up or down, of 2 nx ny triangles."""
    mesh = Mesh()
    for j in range(ny + 1):
        for i in range(nx + 1):
            mesh.vertices.append((width * (i / nx - 0.5), depth * (j / ny - 0.5), 0.0))
    for j in range(ny):
        for i in range(nx):
            a, b = j * (nx + 1) + i, (j + 1) * (nx + 1) + i
            mesh.faces += [(a, a + 1, b + 1), (a, b + 1, b)]
    return mesh.flip() if down else mesh


BOX_FACES = {"bottom": (0, 3, 2, 1), "top": (4, 5, 6, 7), "front": (0, 1, 5, 4), "right": (1, 2, 6, 5),
             "back": (2, 3, 7, 6), "left": (3, 0, 4, 7)}


def box(lo, hi, leave_out=()):
    """Axis-aligned; front is -y, right +x. `leave_out` names faces that nobody can see."""
    (x0, y0, z0), (x1, y1, z1) = lo, hi
    mesh = Mesh([(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
                 (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)])
    for name, (a, b, c, d) in BOX_FACES.items():
        if name not in leave_out:
            mesh.faces += [(a, b, c), (a, c, d)]
    return mesh


def beveled_box(lo, hi, bevel=0.01):
    """A box whose twelve edges are cut at 45 degrees (44 triangles)."""
    r = min([bevel] + [0.45 * (h - l) for l, h in zip(lo, hi)])
    mesh = Mesh()
    index = {}
    for corner in range(8):
        bits = [(corner >> k) & 1 for k in range(3)]
        for axis in range(3):  # the vertex of this corner that lies on the face of `axis`
            inset = [0.0 if k == axis else r for k in range(3)]
            index[tuple(bits), axis] = len(mesh.vertices)
            mesh.vertices.append(tuple(hi[k] - inset[k] if bits[k] else lo[k] + inset[k] for k in range(3)))

    def polygon(ids):
        centre = [0.5 * (l + h) for l, h in zip(lo, hi)]
        a, b, c = (mesh.vertices[i] for i in ids[:3])
        if sum(n * d for n, d in zip(cross(sub(b, a), sub(c, a)), sub(a, centre))) < 0:
            ids = ids[::-1]
        mesh.faces.extend((ids[0], ids[k], ids[k + 1]) for k in range(1, len(ids) - 1))

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            def corner_of(cu, cv):
                bits = [0, 0, 0]
                bits[axis], bits[u], bits[v] = side, cu, cv
                return tuple(bits)
            polygon([index[corner_of(cu, cv), axis] for cu, cv in ((0, 0), (1, 0), (1, 1), (0, 1))])
        for su in (0, 1):
            for sv in (0, 1):  # the edge along `axis` at (su, sv)
                ends = []
                for end in (0, 1):
                    bits = [0, 0, 0]
                    bits[axis], bits[u], bits[v] = end, su, sv
                    ends.append(tuple(bits))
                polygon([index[ends[0], u], index[ends[1], u], index[ends[1], v], index[ends[0], v]])
    for corner in range(8):
        polygon([index[tuple((corner >> k) & 1 for k in range(3)), axis] for axis in range(3)])
    return mesh


def lathe(profile, sides=24, crease=35.0):
    """Turns (radius, z) points about z. Going up the list, the outside is on the right (+radius) of an upward profile.
    Corners sharper than `crease` degrees stay sharp; radius 0 closes the body."""
    rows = []  # (radius, z, normal radius, normal z), doubled at creases
    slopes = []
    for (r0, z0), (r1, z1) in zip(profile, profile[1:]):
        length = math.hypot(r1 - r0, z1 - z0)
        slopes.append(((z1 - z0) / length, (r0 - r1) / length))
    joined = []
    for k, (r, z) in enumerate(profile):
        before, after = slopes[max(k - 1, 0)], slopes[min(k, len(slopes) - 1)]
        if 0 < k < len(slopes) and before[0] * after[0] + before[1] * after[1] < math.cos(math.radians(crease)):
            rows += [(r, z) + before, (r, z) + after]
            joined += [True, False]
        else:
            n = (before[0] + after[0], before[1] + after[1])
            length = math.hypot(*n) or 1.0
            rows.append((r, z, n[0] / length, n[1] / length))
            joined.append(True)
    mesh = Mesh(normals=[])
    for r, z, nr, nz in rows:
        for s in range(sides):
            a = 2 * math.pi * s / sides
            mesh.vertices.append((r * math.cos(a), r * math.sin(a), z))
            mesh.normals.append((nr * math.cos(a), nr * math.sin(a), nz))
    for k in range(len(rows) - 1):
        if not joined[k + 1]:
            continue
        for s in range(sides):
            a, b = k * sides + s, k * sides + (s + 1) % sides
            c, d = b + sides, a + sides
            if rows[k][0] > 0:
                mesh.faces.append((a, b, c))
            if rows[k + 1][0] > 0:
                mesh.faces.append((a, c, d))
    return mesh


def cylinder(radius, z0, z1, sides=16, top_radius=None):
    """Upright and closed."""
    top = radius if top_radius is None else top_radius
    return lathe([(0, z0), (radius, z0), (top, z1), (0, z1)], sides)


def tube(start, end, radius, sides=8):
    """A straight round bar between two points, open at its ends."""
    d = normalized(sub(end, start))
    u = normalized(cross(d, (0, 0, 1) if abs(d[2]) < 0.9 else (1, 0, 0)))
    v = cross(d, u)
    mesh = Mesh(normals=[])
    for p in (start, end):
        for s in range(sides):
            a = 2 * math.pi * s / sides
            n = tuple(math.cos(a) * u[k] + math.sin(a) * v[k] for k in range(3))
            mesh.vertices.append(tuple(p[k] + radius * n[k] for k in range(3)))
            mesh.normals.append(n)
    for s in range(sides):
        a, b = s, (s + 1) % sides
        mesh.faces += [(a, b, b + sides), (a, b + sides, a + sides)]
    return mesh


def sphere(radius, divisions=1, smooth=True):
    """About the origin: an icosahedron divided `divisions` times (20, 80, 320 ... triangles)."""
    g = (1 + math.sqrt(5)) / 2
    points = [normalized(p) for p in [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
                                      (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1)]
    for _ in range(divisions):
        middle, finer = {}, []

        def mid(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                middle[key] = len(points)
                points.append(normalized(tuple(points[a][k] + points[b][k] for k in range(3))))
            return middle[key]
        for a, b, c in faces:
            ab, bc, ca = mid(a, b), mid(b, c), mid(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return Mesh([tuple(radius * c for c in p) for p in points], faces, points if smooth else None)


def bulb(radius=0.03, divisions=1):
    """A light bulb's glowing part, about the origin, to be given to Scene.light."""
    return sphere(radius, divisions, smooth=False)


# ---- buildings -------------------------------------------------------------------------------------------------------

def wall(start, end, thickness, height, openings=(), base=0.0):
    """An upright slab. start and end are (x, y) on its centre line; an opening is (from, to, sill, top), lengths along
    the wall from `start`. Seams between parts of the wall carry no inner faces. Ends are closed."""
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    ux, uy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    t = thickness / 2
    us = sorted({0.0, length} | {u for o in openings for u in o[:2]})
    zs = sorted({base, height} | {z for o in openings for z in o[2:]})
    solid = [[not any(o[0] < (u0 + u1) / 2 < o[1] and o[2] < (z0 + z1) / 2 < o[3] for o in openings)
              for z0, z1 in zip(zs, zs[1:])] for u0, u1 in zip(us, us[1:])]
    index, mesh = {}, Mesh()

    def vertex(i, k, side):
        if (i, k, side) not in index:
            index[i, k, side] = len(mesh.vertices)
            mesh.vertices.append((start[0] + ux * us[i] - uy * t * side, start[1] + uy * us[i] + ux * t * side, zs[k]))
        return index[i, k, side]

    def face(a, b, c, d):
        a, b, c, d = vertex(*a), vertex(*b), vertex(*c), vertex(*d)
        mesh.faces.extend([(a, b, c), (a, c, d)])

    def filled(i, k):
        return 0 <= i < len(us) - 1 and 0 <= k < len(zs) - 1 and solid[i][k]
    for i in range(len(us) - 1):
        for k in range(len(zs) - 1):
            if not solid[i][k]:
                continue
            face((i, k, -1), (i + 1, k, -1), (i + 1, k + 1, -1), (i, k + 1, -1))
            face((i + 1, k, 1), (i, k, 1), (i, k + 1, 1), (i + 1, k + 1, 1))
            if not filled(i - 1, k):
                face((i, k, 1), (i, k, -1), (i, k + 1, -1), (i, k + 1, 1))
            if not filled(i + 1, k):
                face((i + 1, k, -1), (i + 1, k, 1), (i + 1, k + 1, 1), (i + 1, k + 1, -1))
            if not filled(i, k - 1):
                face((i, k, 1), (i + 1, k, 1), (i + 1, k, -1), (i, k, -1))
            if not filled(i, k + 1):
                face((i, k + 1, -1), (i + 1, k + 1, -1), (i + 1, k + 1, 1), (i, k + 1, 1))
    return mesh


def slab(x0, y0, x1, y1, z0, z1):
    return box((x0, y0, z0), (x1, y1, z1))


def room(width, depth, height, openings=None, thickness=0.15, walls="snwe", floor="floor", paint="wall",
         ceiling="ceiling"):
    """A shell around [0,width] x [0,depth] x [0,height]: floor slab, ceiling slab, walls outside of that space.
    openings: side letter (s: y=0, n: y=depth, w: x=0, e: x=width) to a list of (from, to, sill, top), along x or y.
    `walls` names the sides to build (a neighbour's wall may stand on the others). floor or ceiling None leaves that
    out. `paint` may be a dict from side to material."""
    openings = openings or {}
    t, overlap = thickness, 0.02  # walls reach a little into each other and into the slabs: no shared faces, no gaps
    piece = Piece()
    if floor:
        piece.add(floor, slab(-t, -t, width + t, depth + t, -0.2, 0))
    if ceiling:
        piece.add(ceiling, slab(-t, -t, width + t, depth + t, height, height + 0.2))
    lines = {"s": ((-t, -t / 2), (width + t, -t / 2), t), "n": ((-t, depth + t / 2), (width + t, depth + t / 2), t),
             "w": ((-t / 2, -overlap), (-t / 2, depth + overlap), overlap),
             "e": ((width + t / 2, -overlap), (width + t / 2, depth + overlap), overlap)}
    for side in walls:
        start, end, offset = lines[side]
        holes = [(a + offset, b + offset, -overlap if z0 <= 0 else z0, z1) for a, b, z0, z1 in openings.get(side, ())]
        name = paint[side] if isinstance(paint, dict) else paint
        piece.add(name, wall(start, end, t, height + overlap, holes, -overlap))
    return piece


def skirting(width, depth, gaps=None, height=0.08, thickness=0.015, material="trim", walls="snwe"):
    """Skirting boards on the inner faces of room(); gaps: side to a list of (from, to) left free for doors."""
    piece, t = Piece(), thickness
    for side in walls:
        along = width if side in "sn" else depth
        ends = (0.0, along) if side in "sn" else (t, along - t)
        cuts = [ends[0]] + [c for gap in sorted((gaps or {}).get(side, ())) for c in gap] + [ends[1]]
        for a, b in zip(cuts[::2], cuts[1::2]):
            if b - a > 0.01:
                lo, hi = {"s": ((a, -0.002), (b, t)), "n": ((a, depth - t), (b, depth + 0.002)),
                          "w": ((-0.002, a), (t, b)), "e": ((width - t, a), (width + 0.002, b))}[side]
                piece.add(material, box((*lo, -0.002), (*hi, height)))
    return piece


def planks(x0, y0, x1, y1, z=0.002, width=0.14, length=1.5, gap=0.003,
           materials=("plank-a", "plank-b", "plank-c"), seed=1):
    """A floor of boards along x, staggered, in several wood tones; lies on top of a slab at z = 0."""
    random, piece = Random(seed), Piece()
    y = y0
    while y < y1 - 1e-6:
        x = x0 - length * random.uniform(0.05, 0.95)
        yb = min(y + width, y1)
        while x < x1:
            a, b = max(x, x0), min(x + length, x1)
            if b - a > 2 * gap:
                material = materials[random.integer(len(materials))]
                piece.add(material, quad((a, y, z), (b - gap, y, z), (b - gap, yb - gap, z), (a, yb - gap, z)))
            x += length
        y += width
    return piece


class Random:
    """A small generator of our own, so that scenes do not depend on the Python version (64-bit linear congruential)."""

    def __init__(self, seed=1):
        self.state = (seed * 0x9E3779B97F4A7C15 + 1) & (2 ** 64 - 1)
        for _ in range(4):
            self.unit()

    def unit(self):
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) & (2 ** 64 - 1)
        return (self.state >> 33) / 2 ** 31

    def uniform(self, a, b):
        return a + (b - a) * self.unit()

    def integer(self, count):
        return min(int(self.unit() * count), count - 1)

    def pick(self, values):
        return values[self.integer(len(values))]


# ---- materials -------------------------------------------------------------------------------------------------------

def diffuse(r, g, b):
    return f'"string type" "diffuse" "rgb reflectance" [ {numbers((r, g, b), 3)} ]'


def coated(r, g, b, roughness=0.1):
    return (f'"string type" "coateddiffuse" "rgb reflectance" [ {numbers((r, g, b), 3)} ] '
            f'"float roughness" {number(roughness)}')


def metal(name, roughness):
    return (f'"string type" "conductor" "spectrum eta" "metal-{name}-eta" "spectrum k" "metal-{name}-k" '
            f'"float roughness" {number(roughness)}')


def tinted_metal(r, g, b, roughness):
    return (f'"string type" "conductor" "rgb reflectance" [ {numbers((r, g, b), 3)} ] '
            f'"float roughness" {number(roughness)}')


def cloth(reflect, through):
    """Lets light through diffusely: lamp shades, curtains."""
    return (f'"string type" "diffusetransmission" "rgb reflectance" [ {numbers(reflect, 3)} ] '
            f'"rgb transmittance" [ {numbers(through, 3)} ]')


MATERIALS = {
    "wall": diffuse(.74, .72, .67), "wall-warm": diffuse(.72, .62, .48), "wall-blue": diffuse(.36, .46, .55),
    "wall-green": diffuse(.42, .51, .4), "wall-red": diffuse(.52, .21, .17), "wall-grey": diffuse(.5, .5, .5),
    "ceiling": diffuse(.82, .81, .78), "floor": diffuse(.3, .27, .24), "trim": diffuse(.8, .79, .75),
    "plank-a": diffuse(.4, .26, .15), "plank-b": diffuse(.35, .22, .125), "plank-c": diffuse(.44, .3, .18),
    "tile": diffuse(.62, .6, .57), "carpet-red": diffuse(.36, .075, .06), "carpet-blue": diffuse(.09, .13, .24),
    "carpet-sand": diffuse(.52, .43, .32),
    "oak": diffuse(.47, .31, .17), "walnut": diffuse(.22, .125, .07), "pine": diffuse(.6, .43, .25),
    "white-lacquer": coated(.78, .77, .74, .2), "dark-lacquer": coated(.06, .055, .05, .1),
    "paint-white": diffuse(.8, .8, .78), "paint-black": diffuse(.04, .04, .042), "paint-teal": diffuse(.1, .32, .33),
    "brass": metal("CuZn", .12), "steel": metal("Al", .15), "iron": tinted_metal(.25, .25, .26, .25),
    "shade": cloth((.52, .48, .4), (.3, .26, .19)), "shade-dense": cloth((.45, .4, .32), (.03, .025, .018)),
    "curtain": cloth((.5, .47, .42), (.2, .18, .15)), "linen": diffuse(.76, .73, .67), "pillow": diffuse(.8, .79, .76),
    "fabric-grey": diffuse(.3, .3, .31), "fabric-blue": diffuse(.14, .22, .36), "fabric-rust": diffuse(.5, .2, .09),
    "fabric-green": diffuse(.18, .27, .16), "fabric-mustard": diffuse(.62, .42, .1), "leather": diffuse(.25, .12, .065),
    "paper": diffuse(.78, .76, .7), "leaf": diffuse(.1, .22, .06), "leaf-light": diffuse(.19, .34, .1),
    "soil": diffuse(.07, .05, .035), "terracotta": diffuse(.56, .26, .15), "ceramic": coated(.72, .72, .7, .1),
    "ceramic-blue": coated(.1, .2, .42, .1), "glass": '"string type" "dielectric" "float eta" 1.5',
    "window-glass": '"string type" "thindielectric" "float eta" 1.5',
    "mirror": '"string type" "conductor" "spectrum eta" "metal-Ag-eta" "spectrum k" "metal-Ag-k"',
    "book-a": diffuse(.45, .1, .08), "book-b": diffuse(.1, .19, .33), "book-c": diffuse(.16, .3, .18),
    "book-d": diffuse(.62, .52, .34), "book-e": diffuse(.1, .1, .11), "book-f": diffuse(.66, .36, .12),
    "shade-inside": diffuse(.4, .39, .36), "bulb-glass": diffuse(.6, .6, .6), "socket": diffuse(.2, .2, .2),
    "paint-sky": diffuse(.36, .54, .72), "paint-sea": diffuse(.1, .27, .38), "paint-sun": diffuse(.85, .62, .2),
    "paint-field": diffuse(.5, .55, .2), "paint-earth": diffuse(.45, .26, .14),
}


# ---- the scene -------------------------------------------------------------------------------------------------------

class Scene:
    """Collects and writes one .pbrt file. `about` is its first comment line."""

    def __init__(self, name, about, width=480, height=360, spp=64, maxdepth=6, integrator="path", iso=100,
                 whitebalance=0):
        """iso is the exposure (100 = 1); whitebalance the kelvin of the light that shall look white (0: as it is)."""
        self.name, self.about = name, about
        self.film = (f'Film "rgb" "integer xresolution" {width} "integer yresolution" {height} '
                     f'"string filename" "{name}.exr"')
        if iso != 100:
            self.film += f' "float iso" {number(iso)}'
        if whitebalance:
            self.film += f' "float whitebalance" {number(whitebalance)}'
        self.render = [f'Sampler "zsobol" "integer pixelsamples" {spp}',
                       f'Integrator "{integrator}" "integer maxdepth" {maxdepth}']
        self.view, self.materials, self.used, self.textures, self.body, self.files = [], dict(MATERIALS), [], [], [], {}
        self.lights = 0
        self.air = []
        self.world_apart = False

    def fog(self, parameters):
        """Fills the space around the camera with a medium: pbrt parameters."""
        self.air = [f'MakeNamedMedium "air" {parameters}', 'MediumInterface "" "air"']

    def camera(self, eye, look, fov, up=(0, 0, 1), lens=0.0, focus=0.0):
        """fov: degrees over the shorter side of the picture."""
        lens_text = f' "float lensradius" {number(lens)} "float focaldistance" {number(focus)}' if lens else ""
        self.view = ["Scale -1 1 1", f"LookAt {numbers(eye)}  {numbers(look)}  {numbers(up)}",
                     f'Camera "perspective" "float fov" {number(fov)}{lens_text}']

    def material(self, name, text):
        """Defines or replaces a material: text from diffuse(), coated(), metal() ... or any pbrt parameters."""
        self.materials[name] = text

    def texture(self, name, family, kind, parameters):
        self.textures.append(f'Texture "{name}" "{family}" "{kind}" {parameters}')

    def raw(self, text):
        """pbrt lines as they are (environment lights, spheres ...)."""
        self.body.append(text)

    def add(self, what, label="", material=None):
        """A Piece, or a Mesh with a material. Meshes of one material are written as one shape."""
        piece = Piece((material, what)) if isinstance(what, Mesh) else what
        if label:
            self.body.append(f"\n# {label}")
        groups = {}
        for name, mesh in piece.parts:
            groups.setdefault((name, mesh.normals is not None), []).append(mesh)
        for (name, _), meshes in groups.items():
            self._use(name)
            self.body.append(f'NamedMaterial "{name}"')
            self._shape(join(*meshes), f"{self.name}-{label or name}-{name}")

    def light(self, mesh, watts, kelvin=2700, label="", twosided=False, material="bulb-glass"):
        """One mesh light. watts: light given off (not drawn from the mains), spread evenly over its area."""
        self._use(material)
        self.lights += 1
        radiance = watts / (math.pi * mesh.area() * (2 if twosided else 1))
        self.body.append(f"\n# light {self.lights}: {label} ({number(watts, 1)} W, {kelvin} K)")
        self.body.append("AttributeBegin")
        sides = ' "bool twosided" true' if twosided else ""
        self.body.append(f'AreaLightSource "diffuse" "blackbody L" {number(kelvin)} '
                         f'"float scale" {number(radiance, 3)}{sides}')
        self.body.append(f'NamedMaterial "{material}"')
        self._shape(Mesh(mesh.vertices, mesh.faces), f"{self.name}-light{self.lights}")
        self.body.append("AttributeEnd")

    def _use(self, name):
        if name not in self.materials:
            raise KeyError(f"no material {name!r}")
        if name not in self.used:
            self.used.append(name)

    def _shape(self, mesh, file):
        if len(mesh.vertices) > INLINE_VERTICES:
            path = "".join(c if c.isalnum() or c in "-_" else "-" for c in file.lower()) + ".ply"
            if path in self.files:
                raise ValueError(f"two meshes would be written to {path}: give them labels")
            self.files[path] = ply(mesh)
            self.body.append(f'Shape "plymesh" "string filename" "{path}"')
            return
        self.body.append(f'Shape "trianglemesh" "point3 P" [ {"  ".join(numbers(v) for v in mesh.vertices)} ]')
        if mesh.normals is not None:
            self.body.append(f'  "normal N" [ {"  ".join(numbers(n, 3) for n in mesh.normals)} ]')
        self.body.append(f'  "integer indices" [ {"  ".join("%d %d %d" % f for f in mesh.faces)} ]')

    def head(self):
        return [f"# {self.about}", "# Written by make.py; metres, z up.", *self.air, *self.view, self.film,
                'PixelFilter "gaussian"', *self.render, "", "WorldBegin"]

    def world(self):
        named = [f'MakeNamedMaterial "{name}" {self.materials[name]}' for name in self.used]
        return self.textures + named + self.body

    def text(self):
        return "\n".join(self.head() + self.world()) + "\n"

    def outputs(self):
        """With `world_apart`, what follows WorldBegin is a file of its own, which other scenes can include."""
        if not self.world_apart:
            return {f"{self.name}.pbrt": self.text().encode(), **self.files}
        include = f'Include "{self.name}-world.inc"'
        return {f"{self.name}.pbrt": ("\n".join([*self.head(), include]) + "\n").encode(),
                f"{self.name}-world.inc": ("\n".join(self.world()) + "\n").encode(), **self.files}

    def main(self, script):
        """Writes the files beside the script; with --check compares instead and exits 1 if one differs."""
        folder = pathlib.Path(script).resolve().parent
        outputs = self.outputs()
        stray = {p.name for p in folder.glob(f"{self.name}-*.ply")} - outputs.keys()
        if "--check" in sys.argv[1:]:
            wrong = sorted(n for n, data in outputs.items()
                           if not (folder / n).is_file() or (folder / n).read_bytes() != data) + sorted(stray)
            for file in wrong:
                print(f"{folder.name}/{file}: not what make.py writes")
            sys.exit(1 if wrong else 0)
        for file in stray:
            (folder / file).unlink()
        for file, data in outputs.items():
            (folder / file).write_bytes(data)
        print(f"{self.name}: {self.lights} lights, {sum(map(len, outputs.values())) // 1024} KB")


def ply(mesh):
    names = ["x", "y", "z"] + (["nx", "ny", "nz"] if mesh.normals is not None else [])
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(mesh.vertices)}"]
    head += [f"property float {n}" for n in names]
    head += [f"element face {len(mesh.faces)}", "property list uchar int vertex_indices", "end_header", ""]
    out = bytearray("\n".join(head).encode())
    for k, v in enumerate(mesh.vertices):
        # Through text, so that the last bits do not depend on the machine's sine and cosine.
        values = [float(number(c)) for c in v]
        if mesh.normals is not None:
            values += [float(number(c, 3)) for c in mesh.normals[k]]
        out += struct.pack(f"<{len(values)}f", *values)
    for face in mesh.faces:
        out += struct.pack("<B3i", 3, *face)
    return bytes(out)
