"""Files that the scenes of the gallery read: meshes, images, a BRDF, a lens. Written from formulas."""
import math
import struct


def write_ply(file, vertices, faces):
    names = "x y z nx ny nz u v".split()
    head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property float {n}" for n in names),
            f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    rows = [" ".join(f"{x:.6g}" for x in v) for v in vertices]
    rows += [" ".join(map(str, (len(f), *f))) for f in faces]
    file.write_text("\n".join(head + rows) + "\n")


def ball(columns=32, rows=16):
    """Unit sphere: quads, triangles at the poles."""
    vertices, faces = [], []
    for j in range(rows + 1):
        theta = math.pi * j / rows
        for i in range(columns + 1):
            phi = 2 * math.pi * i / columns
            n = (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))
            vertices.append((*n, *n, i / columns, 1 - j / rows))
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 1, a + columns + 2
            faces.append((a, c, d) if j == 0 else (a, c, b) if j == rows - 1 else (a, c, d, b))
    return vertices, faces


def knot(columns=160, rows=20):
    """A trefoil as a tube."""
    def center(t):
        r = 0.55 + 0.2 * math.cos(3 * t)
        return (r * math.cos(2 * t), r * math.sin(2 * t), 0.28 * math.sin(3 * t))

    def cross(a, b):
        return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])

    def unit(a):
        length = math.sqrt(sum(x * x for x in a))
        return tuple(x / length for x in a)
    vertices, faces = [], []
    for i in range(columns + 1):
        t = 2 * math.pi * i / columns
        p, q = center(t), center(t + 1e-3)
        along = unit([b - a for a, b in zip(p, q)])
        side = unit(cross(along, (0, 0, 1)))
        up = cross(side, along)
        for j in range(rows + 1):
            s = 2 * math.pi * j / rows
            n = tuple(math.cos(s) * a + math.sin(s) * b for a, b in zip(side, up))
            vertices.append((*(a + 0.16 * b for a, b in zip(p, n)), *n, i / columns, j / rows))
    for i in range(columns):
        for j in range(rows):
            a = i * (rows + 1) + j
            faces.append((a, a + rows + 1, a + rows + 2, a + 1))
    return vertices, faces


def image(size, f):
    """f(x, y) with x to the right and y upwards in [0, 1] gives r, g, b in [0, 1], already encoded."""
    import numpy
    width, height = size
    pixels = [[f((x + .5) / width, 1 - (y + .5) / height) for x in range(width)] for y in range(height)]
    return numpy.clip(numpy.array(pixels) * 255 + .5, 0, 255).astype("uint8")


def card(x, y):
    """A coloured target: rings over quarters, with one corner marked."""
    r = math.hypot(x - .5, y - .5)
    if r < .44:
        return ((.9, .9, .85), (.75, .2, .15))[int(r * 14) % 2]
    if x > .85 and y > .85:
        return (.1, .1, .1)
    return ((.2, .45, .7), (.85, .7, .25), (.3, .6, .35), (.55, .35, .6))[(x > .5) + 2 * (y > .5)]


def slide(x, y):
    """A window with coloured panes."""
    i, j = int(4 * x), int(3 * y)
    if min(abs(4 * x - round(4 * x)), abs(3 * y - round(3 * y))) < .06:
        return (0, 0, 0)
    return ((1, .3, .2), (.2, .5, 1), (1, .85, .3), (.3, .9, .5), (.9, .4, .9))[(3 * i + 2 * j) % 5]


def pillows(x, y):
    """Normals of round bumps on a square grid."""
    dx, dy = (8 * x) % 1 - .5, (8 * y) % 1 - .5
    r = math.hypot(dx, dy)
    slope = 1.6 * math.sin(2 * math.pi * r) if r < .5 else 0
    n = (slope * dx / max(r, 1e-6), slope * dy / max(r, 1e-6), 1)
    length = math.sqrt(sum(c * c for c in n))
    return tuple(c / length / 2 + .5 for c in n)


def lobes(x, y):
    """Intensity over the equal-area square: a star of beams."""
    a, r = math.atan2(y - .5, x - .5), math.hypot(x - .5, y - .5)
    value = .05 + .95 * max(0, math.cos(6 * a)) ** 4 * (r > .12)
    return (value,) * 3


def write_tensors(file, fields):
    """A tensor file as the database of measured BRDFs has it, of 32-bit floats."""
    head = 18 + sum(2 + len(name) + 2 + 1 + 8 + 8 * a.ndim for name, a in fields)
    out, body = b"tensor_file\0\1\0" + struct.pack("<I", len(fields)), b""
    for name, a in fields:
        out += struct.pack(f"<H{len(name)}sHBQ{a.ndim}Q", len(name), name.encode(), a.ndim, 10, head + len(body),
                           *a.shape)
        body += a.astype("<f4").tobytes()
    file.write_bytes(out + body)


def film_brdf():
    """A rough metal under a film of 0.5 micrometres whose two reflections interfere, as if it had been measured. Half
    vectors stand on an even grid of the square (`vndf` is 1), and `ndf` and `sigma` are such that `spectra` is the BRDF
    times the cosine."""
    import numpy as np
    theta, wavelengths = np.linspace(0, 1.55, 16), np.linspace(360, 830, 48)
    x, y = np.linspace(0, 1, 48)[None, None, :], np.linspace(0, 1, 24)[None, :, None]
    t, half, phi = theta[:, None, None], x ** 2 * math.pi / 2, (2 * y - 1) * math.pi
    h = np.stack(np.broadcast_arrays(np.sin(half) * np.cos(phi), np.sin(half) * np.sin(phi), np.cos(half)))
    wo = np.stack(np.broadcast_arrays(np.sin(t), 0 * t, np.cos(t)))
    cos_half = np.maximum((wo * h).sum(0), 0)
    cos_in = np.maximum(2 * cos_half * h[2] - wo[2], 0)
    alpha, index, thickness = .3, 1.4, 500
    facets = alpha ** 2 / (math.pi * (h[2] ** 2 * (alpha ** 2 - 1) + 1) ** 2)
    way = 2 * thickness * np.sqrt(index ** 2 - 1 + cos_half ** 2)
    film = .03 + .9 * np.sin(math.pi * way[:, None] / wavelengths[None, :, None, None]) ** 2
    value = film * (facets * cos_in / (4 * np.maximum(np.maximum(cos_in, wo[2]), 1e-3)))[:, None]
    # Density of the sampled points: value by area of the square.
    luminance = value.mean(1) * cos_half * x * np.sin(half) + 1e-5
    return [("phi_i", np.zeros(1)), ("theta_i", theta), ("wavelengths", wavelengths), ("ndf", np.ones((2, 2))),
            ("sigma", np.full((2, 2), .25)), ("vndf", np.ones((1, len(theta), 2, 2))), ("luminance", luminance[None]),
            ("spectra", value[None])]


LENS = """# A biconvex lens of 35 mm behind a stop: curvature radius, thickness, index, aperture diameter (mm)
0 3 0 14
36 6 1.517 20
-36 35 1 20
"""


def write_all(folder):
    from PIL import Image
    write_ply(folder / "ball.ply", *ball())
    write_ply(folder / "knot.ply", *knot())
    for name, size, f in (("card", (128, 128), card), ("slide", (160, 120), slide), ("pillows", (256, 256), pillows),
                          ("lobes", (128, 128), lobes)):
        Image.fromarray(image(size, f), "RGB").save(folder / f"{name}.png")
    write_tensors(folder / "film.bsdf", film_brdf())
    (folder / "lens.dat").write_text(LENS)
