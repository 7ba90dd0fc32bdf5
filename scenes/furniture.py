"""Furniture and fittings out of scenekit's shapes. Every piece stands on z = 0 about the origin and faces -y, unless it
says otherwise; place it with .at(x, y, z, turn). Lamps return (piece, bulb position); the caller adds the light."""
import math

from scenekit import (Mesh, Piece, Random, beveled_box, box, cylinder, lathe, normalized, quad, sphere, tube)

BOOK_COLOURS = ("book-a", "book-b", "book-c", "book-d", "book-e", "book-f")


def slanted_leg(x, y, z0, z1, spread=0.03, radius=0.018):
    """From the floor (further out) up to (x, y, z1)."""
    sx, sy = (1 if x > 0 else -1) * spread, (1 if y > 0 else -1) * spread
    return tube((x + sx, y + sy, z0), (x, y, z1), radius, 8)


def cushion(width, depth, height, sharpness=0.45, rows=8, columns=16):
    """A stuffed block about the origin (superellipsoid, smooth); sharpness 1 is an ellipsoid, 0 a box."""
    e, mesh = sharpness, Mesh(normals=[])
    half = (width / 2, depth / 2, height / 2)

    def power(c, p):
        return math.copysign(abs(c) ** p, c) if abs(c) > 1e-9 else 0.0
    for i in range(rows + 1):
        theta = -math.pi / 2 + math.pi * i / rows
        for j in range(columns):
            phi = 2 * math.pi * (j + 0.5) / columns
            base = (math.cos(theta), math.cos(phi), math.sin(phi), math.sin(theta))
            p = (power(base[0], e) * power(base[1], e), power(base[0], e) * power(base[2], e), power(base[3], e))
            q = 2 - e
            n = (power(base[0], q) * power(base[1], q), power(base[0], q) * power(base[2], q), power(base[3], q))
            mesh.vertices.append(tuple(h * c for h, c in zip(half, p)))
            mesh.normals.append(normalized(tuple(c / h for h, c in zip(half, n))))
    for i in range(rows):
        for j in range(columns):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            c, d = b + columns, a + columns
            if i:
                mesh.faces.append((a, b, c))
            if i < rows - 1:
                mesh.faces.append((a, c, d))
    return mesh


# ---- tables and seats ------------------------------------------------------------------------------------------------

def table(width=1.4, depth=0.8, height=0.74, wood="oak", leg=0.06):
    x, y, h = width / 2, depth / 2, height
    piece = Piece((wood, beveled_box((-x, -y, h - 0.035), (x, y, h), 0.006)))
    for sx in (-1, 1):
        for sy in (-1, 1):
            cx, cy = sx * (x - 0.04 - leg / 2), sy * (y - 0.04 - leg / 2)
            piece.add(wood, box((cx - leg / 2, cy - leg / 2, 0), (cx + leg / 2, cy + leg / 2, h - 0.034), ("top",)))
    for sy in (-1, 1):
        c = sy * (y - 0.07)
        piece.add(wood, box((-x + 0.09, c - 0.01, h - 0.12), (x - 0.09, c + 0.01, h - 0.034), ("top",)))
    for sx in (-1, 1):
        c = sx * (x - 0.07)
        piece.add(wood, box((c - 0.01, -y + 0.09, h - 0.12), (c + 0.01, y - 0.09, h - 0.034), ("top",)))
    return piece


def round_table(radius=0.45, height=0.72, wood="walnut", sides=40):
    r, h = radius, height
    top = lathe([(0, h - 0.03), (r - 0.012, h - 0.03), (r, h - 0.02), (r, h - 0.008), (r - 0.008, h), (0, h)], sides)
    foot = lathe([(0, 0), (r * 0.55, 0), (r * 0.55, 0.02), (r * 0.2, 0.05), (0.035, 0.12), (0.03, h - 0.1),
                  (0.06, h - 0.029)], 24)
    return Piece((wood, top), (wood, foot))


def chair(wood="oak", seat="fabric-grey", width=0.44, depth=0.44, height=0.46, back=0.88):
    x, y = width / 2, depth / 2
    piece = Piece((wood, beveled_box((-x, -y, height - 0.05), (x, y, height - 0.02), 0.008)))
    piece.add(seat, beveled_box((-x + 0.01, -y + 0.01, height - 0.02), (x - 0.01, y - 0.03, height + 0.015), 0.014))
    for sx in (-1, 1):
        piece.add(wood, slanted_leg(sx * (x - 0.03), -y + 0.03, 0, height - 0.04))
        piece.add(wood, slanted_leg(sx * (x - 0.03), y - 0.03, 0, height - 0.04))
        piece.add(wood, tube((sx * (x - 0.03), y - 0.03, height - 0.03), (sx * (x - 0.04), y + 0.06, back), 0.016))
    for z in (0.62, 0.74):
        piece.add(wood, bar_back(x, y, z, z + 0.055))
    piece.add(wood, bar_back(x + 0.005, y, back - 0.07, back + 0.01))
    return piece


def bar_back(x, y, z0, z1):
    """A chair's cross bar, leaning with its back."""
    lean = 0.02 + 0.09 * (z0 - 0.43) / 0.45
    return beveled_box((-x + 0.02, y - 0.04 + lean, z0), (x - 0.02, y - 0.018 + lean, z1), 0.006)


def stool(radius=0.17, height=0.45, wood="pine"):
    piece = Piece((wood, lathe([(0, height - 0.03), (radius, height - 0.03), (radius, height), (0, height)], 24)))
    for k in range(4):
        a = math.radians(45 + 90 * k)
        c, s = math.cos(a), math.sin(a)
        piece.add(wood, tube((c * radius, s * radius, 0), (c * radius * .7, s * radius * .7, height - .029), 0.015))
    return piece


def sofa(width=2.0, depth=0.88, fabric="fabric-blue", seats=3, pillows=("fabric-mustard",), legs="walnut"):
    x, y, arm = width / 2, depth / 2, 0.16
    piece = Piece((fabric, beveled_box((-x, -y + 0.04, 0.12), (x, y, 0.3), 0.02)))
    piece.add(fabric, beveled_box((-x + arm + 0.003, y - 0.2, 0.303), (x - arm - 0.003, y, 0.8), 0.05))
    for s in (-1, 1):
        a, b = sorted((s * x, s * (x - arm)))
        piece.add(fabric, beveled_box((a, -y, 0.303), (b, y, 0.6), 0.04))
        for sy in (-1, 1):
            piece.add(legs, slanted_leg(s * (x - 0.1), sy * (y - 0.1), 0, 0.13, 0.02, 0.02))
    w = (width - 2 * arm) / seats
    for k in range(seats):
        cx = -x + arm + w * (k + 0.5)
        piece.add(fabric, cushion(w - 0.012, depth - 0.19, 0.17, 0.3).at(cx, -0.1, 0.383))
        piece.add(fabric, cushion(w - 0.02, 0.17, 0.42, 0.4).turn(-12, "x").at(cx, y - 0.29, 0.66))
    for k, colour in enumerate(pillows):
        side = -1 if k % 2 == 0 else 1
        block = cushion(0.42, 0.13, 0.42, 0.6).turn(-22, "x").turn(side * 14)
        piece.add(colour, block.at(side * (x - arm - 0.26), y - 0.43, 0.66))
    return piece


def armchair(fabric="fabric-rust", pillow=None):
    return sofa(0.86, 0.84, fabric, 1, (pillow,) if pillow else ())


def bench(width=1.2, depth=0.38, height=0.45, wood="oak", seat="leather"):
    piece = table(width, depth, height - 0.05, wood, 0.045)
    return piece.add(seat, beveled_box((-width / 2 + .01, -depth / 2 + .01, height - .049),
                                       (width / 2 - .01, depth / 2 - .01, height + .01), 0.02))


def bed(width=1.6, length=2.0, wood="walnut", blanket="fabric-blue", pillows=2):
    """Headboard at +y."""
    x, y = width / 2, length / 2
    piece = Piece((wood, beveled_box((-x - 0.04, -y - 0.04, 0.1), (x + 0.04, y, 0.3), 0.012)))
    piece.add(wood, beveled_box((-x - 0.06, y + 0.001, 0), (x + 0.06, y + 0.06, 1.05), 0.015))
    for sx in (-1, 1):
        piece.add(wood, box((sx * x - 0.03, -y, 0), (sx * x + 0.03, -y + 0.06, 0.11), ("top",)))
    piece.add("linen", cushion(width - 0.01, length - 0.02, 0.22, 0.12, 8, 24).at(0, 0, 0.41))
    piece.add(blanket, cushion(width + 0.05, length * 0.66, 0.27, 0.14, 8, 24).at(0, -y + length * 0.325 - 0.01, 0.415))
    piece.add("linen", beveled_box((-x - 0.028, -y + length * .58, 0.46), (x + 0.028, -y + length * .7, 0.558), 0.02))
    w = width / pillows
    for k in range(pillows):
        piece.add("pillow", cushion(w - 0.12, 0.4, 0.15, 0.65).turn(24, "x").at(-x + w * (k + 0.5), y - 0.24, 0.61))
    return piece


# ---- storage ---------------------------------------------------------------------------------------------------------

def books(length, seed=1, depth=0.17, tallest=0.26, fill=0.92):
    """A row standing along x from 0 to length, spines towards -y, on z = 0; the last one may lean."""
    random, piece, x = Random(seed), Piece(), 0.004
    while x < length * fill - 0.06:
        w, h, d = random.uniform(0.018, 0.045), tallest * random.uniform(0.72, 1), depth * random.uniform(0.85, 1)
        colour = random.pick(BOOK_COLOURS)
        piece.add(colour, box((x, -d, 0), (x + w, 0, h), ("bottom",)))
        if random.unit() < 0.5:  # a lighter band on the spine
            z = h * random.uniform(0.55, 0.8)
            piece.add("paper", quad((x + .003, -d - 5e-4, z), (x + w - .003, -d - 5e-4, z),
                                    (x + w - .003, -d - 5e-4, z + .025), (x + .003, -d - 5e-4, z + .025)))
        x += w + 0.0015
    if length - x > 0.12:
        lean = box((0, -depth * 0.9, 0), (0.03, 0, tallest * 0.8), ("bottom",)).turn(-13, "y")
        piece.add(random.pick(BOOK_COLOURS), lean.at(x + 0.004, 0, 0.0075))
    return piece


def book_stack(count=4, seed=1, width=0.17, length=0.24):
    """Lying books, one on the other, each a cover around a block of paper."""
    random, piece, z = Random(seed), Piece(), 0.0
    for _ in range(count):
        h, w, l = random.uniform(0.02, 0.04), width * random.uniform(.8, 1), length * random.uniform(.8, 1)
        colour, turn = random.pick(BOOK_COLOURS), random.uniform(-12, 12)
        book = Piece((colour, box((-w / 2, -l / 2, 0), (w / 2, l / 2, 0.003))),
                     (colour, box((-w / 2, -l / 2, h - 0.003), (w / 2, l / 2, h))),
                     (colour, box((-w / 2, -l / 2, 0.0031), (-w / 2 + 0.003, l / 2, h - 0.0031))),
                     ("paper", box((-w / 2 + .0031, -l / 2 + .005, .0031), (w / 2 - .005, l / 2 - .005, h - .0031))))
        piece.include(book.at(0, 0, z, turn))
        z += h + 0.0005
    return piece


def bookcase(width=0.9, height=1.9, depth=0.28, shelves=5, wood="oak", seed=1, fill=0.92, back=True):
    """Back at +y, books facing -y."""
    x, y, t = width / 2, depth / 2, 0.022
    piece = Piece()
    for s in (-1, 1):
        piece.add(wood, box((min(s * x, s * (x - t)), -y, 0), (max(s * x, s * (x - t)), y, height)))
    if back:
        piece.add(wood, box((-x + t, y - 0.008, 0.06), (x - t, y - 0.001, height - t)))
    step = (height - 0.06 - t) / shelves
    inner = width - 2 * t
    for k in range(shelves + 1):
        z = 0.06 + k * step
        piece.add(wood, box((-x + t, -y + (0.0 if k in (0, shelves) else 0.01), z), (x - t, y - 0.0085, z + t)))
        if k < shelves:
            row = books(inner - 0.01, seed * 31 + k, depth * 0.68, min(0.27, step - t - 0.03), fill)
            piece.include(row.at(-x + t + 0.004, y - 0.02, z + t + 0.0005))
    return piece.add(wood, box((-x + t, -y + 0.02, 0), (x - t, -y + 0.035, 0.06)))


def wall_shelf(width=0.9, depth=0.22, wood="oak", seed=None):
    """A board with brackets, its back on y = 0, top of the board at z = 0; with books if `seed` is given."""
    piece = Piece((wood, beveled_box((-width / 2, -depth, -0.025), (width / 2, 0, 0), 0.004)))
    for s in (-1, 1):
        c = s * width * 0.36
        piece.add("iron", box((c - 0.008, -depth * 0.8, -0.04), (c + 0.008, 0, -0.0255)))
        piece.add("iron", box((c - 0.008, -0.015, -0.16), (c + 0.008, 0, -0.0405)))
    if seed is not None:
        piece.include(books(width * 0.7, seed, depth * 0.8).at(-width / 2 + 0.06, -0.015, 0.0005))
    return piece


def cupboard(width=1.2, depth=0.45, height=0.8, wood="oak", doors=2, drawers=1, knobs="brass", legs=0.1):
    """A sideboard, wardrobe or chest: doors side by side under rows of drawers."""
    x, y = width / 2, depth / 2
    piece = Piece((wood, beveled_box((-x, -y + 0.02, legs), (x, y, height - 0.025), 0.004)))
    piece.add(wood, beveled_box((-x - 0.015, -y - 0.01, height - 0.0245), (x + 0.015, y, height), 0.006))
    for sx in (-1, 1):
        for sy in (-1, 1):
            piece.add(wood, slanted_leg(sx * (x - 0.06), sy * (y - 0.07), 0, legs + 0.005, 0.015, 0.02))
    z = height - 0.04
    drawer = 0.16
    for _ in range(drawers):
        for k in range(max(doors, 1)):
            piece.include(front(-x + k * width / max(doors, 1), z - drawer, width / max(doors, 1), drawer, -y + .02,
                                wood,
                                knobs, (0.5, 0.5)))
        z -= drawer
    for k in range(doors):
        side = 0.92 if k % 2 == 0 and doors > 1 else 0.08
        piece.include(front(-x + k * width / doors, legs + 0.01, width / doors, z - legs - 0.01, -y + .02, wood, knobs,
                            (side, 0.55)))
    return piece


def front(x, z, width, height, y, wood, knobs, knob):
    """A door or drawer front with a recessed field (frame of four strips) and a knob."""
    g, f, t = 0.006, 0.045 if min(width, height) > 0.2 else 0.02, 0.018
    x0, x1, z0, z1 = x + g, x + width - g, z + g, z + height - g
    piece = Piece((wood, box((x0, y - 0.008, z0), (x1, y + 0.002, z1))))
    for lo, hi in (((x0, z0), (x1, z0 + f)), ((x0, z1 - f), (x1, z1)),
                   ((x0, z0 + f), (x0 + f, z1 - f)), ((x1 - f, z0 + f), (x1, z1 - f))):
        piece.add(wood, box((lo[0], y - t, lo[1]), (hi[0], y - 0.007, hi[1])))
    kx, kz = x0 + (x1 - x0) * knob[0], z0 + (z1 - z0) * knob[1]
    if knob[0] != 0.5:
        kx = min(max(kx, x0 + f / 2), x1 - f / 2) if knob[0] < 0.1 or knob[0] > 0.9 else kx
    handle = lathe([(0.006, 0), (0.006, 0.012), (0.014, 0.018), (0.014, 0.024), (0, 0.028)], 12).turn(90, "x")
    return piece.add(knobs, handle.at(kx, y - (t if knob[0] != 0.5 else 0.008), kz))


# ---- doors, windows, things on walls ---------------------------------------------------------------------------------

def door_leaf(width=0.88, height=2.0, material="paint-white", thickness=0.04, handles="steel"):
    """Hinge line at the origin, the leaf along +x in the plane y = 0; turn it to open. Fields on both sides."""
    t, f = thickness / 2, 0.11
    piece = Piece((material, box((0.002, -t + 0.01, 0.008), (width - 0.004, t - 0.01, height - 0.004))))
    zs = ((0.008, 0.2), (0.85, 1.0), (height - 0.134, height - 0.004))
    for side in (-1, 1):
        a, b = (-t, -t + 0.0101) if side < 0 else (t - 0.0101, t)
        for z0, z1 in zs:
            piece.add(material, box((0.002, a, z0), (width - 0.004, b, z1)))
        for (_, z0), (z1, _) in zip(zs, zs[1:]):
            for x0, x1 in ((0.002, f), (width - 0.004 - f, width - 0.004)):
                piece.add(material, box((x0, a, z0), (x1, b, z1)))
        y = side * t
        hx = width - 0.065
        a, b = sorted((y, y + side * 0.006))
        piece.add(handles, box((hx - 0.02, a, 0.93), (hx + 0.02, b, 1.12)))
        piece.add(handles, tube((hx, y, 1.05), (hx, y + side * 0.05, 1.05), 0.009))
        piece.add(handles, tube((hx + 0.009, y + side * 0.05, 1.05), (hx - 0.12, y + side * 0.05, 1.05), 0.009))
        piece.add(handles, sphere(0.009).at(hx - 0.12, y + side * 0.05, 1.05))
    return piece


def door_frame(width=0.9, height=2.02, thickness=0.15, material="trim", board=0.07):
    """Lining and architraves for an opening from x = 0 to width in a wall whose centre plane is y = 0."""
    t, l = thickness / 2, 0.012
    piece = Piece()
    piece.add(material, box((0, -t - .001, 0), (l, t + .001, height)),
              box((width - l, -t - .001, 0), (width, t + .001, height)),
              box((l, -t - .001, height - l), (width - l, t + .001, height)))
    for side in (-1, 1):
        a, b = sorted((side * (t - 0.003), side * (t + 0.015)))
        piece.add(material, box((-board, a, 0), (0.004, b, height + board)))
        piece.add(material, box((width - 0.004, a, 0), (width + board, b, height + board)))
        piece.add(material, box((0.004, a, height - 0.004), (width - 0.004, b, height + board)))
    return piece


def window_frame(width=1.2, height=1.3, thickness=0.15, material="paint-white", columns=2, rows=2, sill=True,
                 bar=0.045):
    """For an opening from x = 0 to width, z = 0 to height in a wall whose centre plane is y = 0; the room is at -y."""
    piece, b = Piece(), bar
    for x in (0, width - b):
        piece.add(material, box((x, -0.03, 0), (x + b, 0.03, height)))
    for z in (0, height - b):
        piece.add(material, box((b, -0.03, z), (width - b, 0.03, z + b)))
    for k in range(1, columns):
        c = width * k / columns
        piece.add(material, box((c - b * .4, -0.025, b), (c + b * .4, 0.025, height - b)))
    for k in range(1, rows):
        c = height * k / rows
        piece.add(material, box((b, -0.02, c - b * .3), (width - b, 0.02, c + b * .3)))
    if sill:
        piece.add(material, beveled_box((-0.06, -thickness / 2 - 0.1, -0.03), (width + 0.06, -0.031, 0.004), 0.005))
    return piece


def curtain(width=0.6, height=2.2, folds=5, deep=0.05, material="curtain", seed=1):
    """A pleated sheet along x, hanging from z = height to 0, about y = 0."""
    random, mesh, n = Random(seed), Mesh(normals=[]), folds * 8
    phase = random.uniform(0, 6)
    for z, spread in ((0.0, 1.0), (height * 0.5, 0.85), (height, 0.7)):
        for k in range(n + 1):
            u = k / n
            a = 2 * math.pi * folds * u + 0.7 * math.sin(5 * u + phase)
            mesh.vertices.append((width * (u - 0.5), deep * spread * math.sin(a), z))
            slope = deep * spread * math.cos(a) * (2 * math.pi * folds + 3.5 * math.cos(5 * u + phase)) / width
            mesh.normals.append(normalized((slope, -1, 0)))
    for row in range(2):
        for k in range(n):
            a, b = row * (n + 1) + k, (row + 1) * (n + 1) + k
            mesh.faces += [(a, a + 1, b + 1), (a, b + 1, b)]
    return Piece((material, mesh))


def curtain_rod(width, material="brass"):
    rod = Piece((material, tube((-width / 2, 0, 0), (width / 2, 0, 0), 0.012)))
    for s in (-1, 1):
        rod.add(material, sphere(0.025).at(s * width / 2, 0, 0))
    return rod


def upright(x, z, y):
    """The rectangle -x..x, -z..z at depth y, facing -y."""
    return quad((-x, y, -z), (x, y, -z), (x, y, z), (-x, y, z))


def frame_of(material, x, z, b, y0=-0.025):
    """Four strips of breadth b around -x..x, -z..z."""
    return Piece(*[(material, box((x0, y0, z0), (x1, -0.001, z1))) for x0, z0, x1, z1 in
                   ((-x, -z, x, -z + b), (-x, z - b, x, z), (-x, -z + b, -x + b, z - b), (x - b, -z + b, x, z - b))])


def picture(width=0.6, height=0.45, frame="walnut", seed=1, border=0.03):
    """Hangs with its back on y = 0, centred; a landscape of a few flat fields behind a paper mount."""
    x, z, b = width / 2, height / 2, border
    random = Random(seed)
    piece = frame_of(frame, x, z, b).add("paper", upright(x - b, z - b, -0.012))
    m = b + 0.12 * min(width, height)
    x0, x1, z0, z1 = -x + m, x - m, -z + m, z - m
    sky = random.pick(("paint-sky", "paint-sun", "paint-sea"))
    piece.add(sky, quad((x0, -.0125, z0), (x1, -.0125, z0), (x1, -.0125, z1), (x0, -.0125, z1)))
    level, y = z0 + (z1 - z0) * random.uniform(.5, .65), -.013
    for colour in ("paint-sea", "paint-field", "paint-earth"):
        if colour == sky:
            continue
        waves = Mesh()
        p, q = random.uniform(0, 6), random.uniform(2, 5)
        for k in range(13):
            u = k / 12
            top = level + (z1 - z0) * 0.07 * math.sin(q * u + p)
            waves.vertices += [(x0 + (x1 - x0) * u, y, z0), (x0 + (x1 - x0) * u, y, max(top, z0 + 0.004))]
        for k in range(12):
            a = 2 * k
            waves.faces += [(a, a + 2, a + 3), (a, a + 3, a + 1)]
        piece.add(colour, waves)
        level -= (z1 - z0) * random.uniform(.15, .25)
        y -= .0005
    if sky == "paint-sky":
        cx, cz, r = x0 + (x1 - x0) * random.uniform(.2, .8), z0 + (z1 - z0) * .8, (z1 - z0) * .09
        disc = lathe([(r, 0), (0, 0)], 16).turn(90, "x").at(cx, -.0128, cz)
        piece.add("paint-sun", disc)
    return piece


def mirror(width=0.5, height=0.8, frame="brass"):
    """Like picture()."""
    x, z, b = width / 2, height / 2, 0.03
    return frame_of(frame, x, z, b).add("mirror", upright(x - b, z - b, -0.01))


def radiator(width=0.9, height=0.55):
    """Back near y = 0, on short feet."""
    piece, n = Piece(), int(width / 0.05)
    for k in range(n):
        x = -width / 2 + width * (k + 0.5) / n
        piece.add("paint-white", beveled_box((x - 0.019, -0.13, 0.12), (x + 0.019, -0.04, 0.12 + height), 0.012))
    for z in (0.17, 0.07 + height):
        piece.add("paint-white", tube((-width / 2 - 0.03, -0.085, z), (width / 2 + 0.03, -0.085, z), 0.014))
    for s in (-1, 1):
        piece.add("paint-white", tube((s * width * 0.45, -0.085, 0), (s * width * 0.45, -0.085, 0.17), 0.012))
    return piece


def clock(radius=0.14):
    """Like picture(); shows ten past ten."""
    face = lathe([(radius, 0), (radius, 0.03), (radius * 0.93, 0.03), (radius * 0.92, 0.02), (0, 0.02)], 32)
    piece = Piece(("paint-black", face.turn(90, "x")))
    dial = lathe([(radius * 0.9, 0.021), (0, 0.021)], 32).turn(90, "x")
    piece.add("paper", dial)
    for angle, length, w in ((60, 0.68, 0.006), (-58, 0.45, 0.009)):
        hand = quad((-w, -0.0225, 0), (w, -0.0225, 0), (w / 2, -0.0225, radius * length),
                    (-w / 2, -0.0225, radius * length))
        piece.add("paint-black", hand.turn(angle, "y"))
    return piece


# ---- small things ----------------------------------------------------------------------------------------------------

def rug(width=2.0, depth=1.4, field="carpet-red", border="carpet-sand", height=0.012):
    x, y, h = width / 2, depth / 2, height
    piece = Piece((border, beveled_box((-x, -y, 0.0025), (x, y, h), 0.004)))
    for m, material, z in ((0.08, field, h + 6e-4), (0.2, border, h + 1.2e-3), (0.23, field, h + 1.8e-3)):
        piece.add(material, quad((-x + m, -y + m, z), (x - m, -y + m, z), (x - m, y - m, z), (-x + m, y - m, z)))
    return piece


def turned(scale, profile, sides=24):
    """lathe() of a profile given in units of `scale`."""
    return lathe([(r * scale, z * scale) for r, z in profile], sides)


VASE = [(0, 0), (.2, 0), (.22, .02), (.3, .22), (.33, .4), (.29, .58), (.17, .76), (.13, .86), (.15, .94), (.2, 1),
        (.185, 1), (.13, .93), (.11, .85), (.15, .75), (0, .7)]
BOWL = [(0, 0), (.35, 0), (.38, .06), (.75, .22), (.93, .42), (1, .62), (.95, .62), (.87, .44), (.7, .28), (.35, .14),
        (0, .12)]
CUP = [(0, 0), (.026, 0), (.03, .01), (.04, .05), (.041, .085), (.037, .085), (.036, .05), (.025, .012), (0, .01)]
POT = [(0, 0), (.72, 0), (.95, 1.5), (1.05, 1.5), (1.05, 1.75), (.93, 1.75), (.88, 1.55), (0, 1.55)]
BOTTLE = [(0, 0), (.12, 0), (.125, .02), (.125, .55), (.1, .65), (.05, .75), (.045, 1), (0, 1)]


def vase(height=0.3, material="ceramic-blue", sides=28):
    return Piece((material, turned(height, VASE, sides)))


def bowl(radius=0.14, material="ceramic"):
    return Piece((material, turned(radius, BOWL, 28)))


def fruit_bowl(radius=0.15, material="ceramic"):
    piece, r = bowl(radius, material), radius
    for k, colour in enumerate(("book-f", "leaf-light", "book-a", "fabric-mustard")):
        a = 1.57 * k
        piece.add(colour, sphere(0.038, 2).at(r * .38 * math.cos(a), r * .38 * math.sin(a), r * .2 + 0.036))
    return piece.add("book-f", sphere(0.038, 2).at(0.004, 0, r * .2 + 0.082))


def cup(material="ceramic"):
    return Piece((material, turned(1, CUP, 20)))


def plant(height=0.9, leaves=14, pot=0.15, seed=1, width=0.07, pot_material="terracotta"):
    """Long arching leaves out of a pot."""
    random, r = Random(seed), pot
    piece = Piece((pot_material, turned(r, POT)))
    piece.add("soil", lathe([(.885 * r, 1.58 * r), (0, 1.6 * r)], 16))
    for k in range(leaves):
        angle = 360 * (k * 0.382 + random.uniform(-.04, .04))
        long, rise, w = height * random.uniform(.75, 1.1), random.uniform(.55, .95), width * random.uniform(.75, 1.1)
        mesh, steps = Mesh(normals=[]), 7
        for i in range(steps + 1):
            u = i / steps
            x = 0.02 + long * (1 - rise * .6) * (u ** 1.5) * .8
            z = 1.5 * r + long * rise * (1.25 * u - .5 * u * u * u)
            half = w * (0.25 + 1.1 * u) * (1 - u) ** .6 if u < 1 else 0.0
            dx, dz = long * (1 - rise * .6) * 1.2 * math.sqrt(u), long * rise * (1.25 - 1.5 * u * u)
            for s in (-1, 1):
                mesh.vertices.append((x, s * half, z + half * 0.35))
                mesh.normals.append(normalized((-dz, -s * 0.35 * math.hypot(dx, dz), dx)))
        for i in range(steps):
            a = 2 * i
            mesh.faces += [(a, a + 2, a + 3), (a, a + 3, a + 1)]
        piece.add(random.pick(("leaf", "leaf", "leaf-light")), mesh.turn(angle))
    return piece


def bottle(height=0.3, material="leaf"):
    return Piece((material, turned(height, BOTTLE, 20)))


def candlestick(height=0.24):
    h = height
    stick = lathe([(0, 0), (.055, 0), (.055, .008), (.02, .02), (.01, .05), (.016, .08), (.009, .1), (.009, h - .03),
                   (.022, h - .012), (.022, h), (0, h)], 20)
    return Piece(("brass", stick), ("paper", cylinder(.01, h + .0005, h + .16, 12)))


# ---- lamps -----------------------------------------------------------------------------------------------------------

def shade_cone(bottom, top, height, sides=32):
    """An open cone of cloth (one sheet) with z from 0 to height, and its two rims."""
    return lathe([(bottom, 0), (top, height)], sides)


def ring(radius, z, thickness=0.004, material="brass"):
    t = thickness
    return Piece((material, lathe([(radius, z - t), (radius + t, z), (radius - t, z + t), (radius, z - t)], 24, 180)))


def table_lamp(height=0.5, shade="shade", base="ceramic-blue", top=0.11, bottom=0.17, shade_height=0.22):
    h, s = height, height - shade_height
    body = lathe([(0, 0), (.075, 0), (.075, .012), (.05, .02), (.075, s * .35), (.06, s * .6), (.025, s * .8),
                  (.018, s * .86),
                  (0, s * .86)], 28)
    piece = Piece((base, body), ("brass", cylinder(.008, s * .855, s + .05, 10)),
                  ("brass", cylinder(.017, s + .045, s + .075, 12)))
    piece.add(shade, shade_cone(bottom, top, shade_height).at(0, 0, s))
    piece.include(ring(bottom, s - .001), ring(top, h + .001))
    for k in range(3):
        a = 2.0944 * k
        c, d = math.cos(a), math.sin(a)
        rim = top + (bottom - top) * .25
        piece.add("brass", tube((c * .012, d * .012, s + .06), (c * rim, d * rim, h - shade_height * .25), .002, 5))
    return piece, (0.0, 0.0, s + 0.112)


def floor_lamp(height=1.6, shade="shade", stand="brass", top=0.17, bottom=0.25, shade_height=0.28):
    s = height - shade_height
    foot = lathe([(0, 0), (.15, 0), (.15, .012), (.13, .02), (.03, .035), (.012, .06), (.011, s + .05), (0, s + .05)],
                 32)
    piece = Piece((stand, foot), (stand, cylinder(.018, s + .045, s + .08, 12)))
    piece.add(shade, shade_cone(bottom, top, shade_height).at(0, 0, s)).include(ring(bottom, s - .001))
    piece.include(ring(top, height + .001))
    for k in range(3):
        a = 2.0944 * k + 0.4
        c, d = math.cos(a), math.sin(a)
        piece.add(stand, tube((c * .014, d * .014, s + .06), (c * (top + .012), d * (top + .012), height - .045), .002,
                              5))
    return piece, (0.0, 0.0, s + 0.118)


def pendant(drop=0.8, shade="paint-teal", radius=0.2, height=0.16, cord="paint-black", inside="shade-inside"):
    """Hangs from z = 0 down to -drop: a bell of painted metal with the bulb just above its rim."""
    r, z, z1 = radius, -drop, height - drop
    bell = [(r, z), (r * .97, z + height * .3), (r * .8, z + height * .62), (r * .45, z + height * .88), (.03, z1)]
    lining = [(a - .003, b - (.003 if k else 0)) for k, (a, b) in enumerate(bell)]
    piece = Piece((shade, lathe(bell, 36, 60)), (inside, lathe(lining, 36, 60).flip()))
    piece.add(shade, lathe([(.029, z1 - .001), (.03, z1 + .05), (.012, z1 + .06), (0, z1 + .06)], 20))
    piece.add(cord, tube((0, 0, z1 + .058), (0, 0, -.02), .004, 6), lathe([(0, -.03), (.045, -.025), (.05, .002)], 20))
    piece.add("socket", cylinder(.016, z + .058, z1 - .004, 12))
    return piece, (0.0, 0.0, z + 0.022)


def globe_pendant(drop=0.9, radius=0.1, metal="brass", cord="paint-black", brim=.62):
    """An opal globe on a cord; the globe itself is the light (bulb(radius, 2) at the position returned). The cap's brim
    has `brim` times the globe's radius: above .54 it leaves a gap that glows, .52 grips the globe."""
    z = radius - drop
    cap = lathe([(radius * brim, z + radius * .84), (radius * (brim - .02), z + radius * .96), (.03, z + radius * 1.12),
                 (.02, z + radius * 1.5), (0, z + radius * 1.5)], 28)
    piece = Piece((metal, cap), (cord, tube((0, 0, z + radius * 1.49), (0, 0, -.02), .004, 6)))
    return piece.add(cord, lathe([(0, -.03), (.045, -.025), (.05, .002)], 20)), (0.0, 0.0, z)


def sconce(shade="shade", metal="brass"):
    """On a wall at y = 0 (room at -y), origin at the wall plate's middle; half a cone of cloth before the bulb."""
    piece = Piece((metal, beveled_box((-.045, -.012, -.07), (.045, 0, .07), .006)))
    piece.add(metal, tube((0, -.01, -.03), (0, -.09, -.03), .007), cylinder(.015, -.035, .0, 12).at(0, -.09, 0))
    piece.add(shade, lathe([(.075, -.02), (.055, .15)], 24).at(0, -.09, 0))
    piece.include(ring(.075, -.02).at(0, -.09), ring(.055, .15).at(0, -.09))
    return piece, (0.0, -0.09, 0.035)


def globe_lamp(height=0.42, radius=0.06, stand="brass"):
    """A stem on a foot under an opal globe, which the caller adds: a light of `radius` at the returned position."""
    z = height - radius
    foot = lathe([(0, 0), (.075, 0), (.075, .01), (.06, .016), (.012, .024), (.009, .04), (.009, z - radius - .02),
                  (.03, z - radius - .012), (.036, z - radius * .86), (.032, z - radius * .86), (0, z - radius - .008)], 28)
    return Piece((stand, foot)), (0.0, 0.0, z)
