"""Image textures for scenes made with scenekit: patterns that repeat, written as small PNG files with a palette, and
meshes with texture coordinates.

A pattern is a function from a place in the unit square (v runs down the picture) to a number from 0 to 1, and a ramp
is a list of colours that the numbers stand for. image() makes the file, textured() adds pieces whose (u, v) are metres
along the surface."""
import math
import struct
import zlib

from scenekit import cross, normalized, number, numbers, sub


# ---- patterns --------------------------------------------------------------------------------------------------------

class Noise:
    """Smooth noise of mean 1/2 over the unit square that repeats in both directions."""

    def __init__(self, random, columns, rows):
        self.columns, self.rows = columns, rows
        self.values = [[random.unit() for _ in range(columns)] for _ in range(rows)]

    def __call__(self, u, v):
        x, y = u % 1 * self.columns, v % 1 * self.rows
        i, j = int(x) % self.columns, int(y) % self.rows
        s, t = x - int(x), y - int(y)
        s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
        a, b = self.values[j], self.values[(j + 1) % self.rows]
        k = (i + 1) % self.columns
        top, bottom = a[i] + (a[k] - a[i]) * s, b[i] + (b[k] - b[i]) * s
        return top + (bottom - top) * t


def clouds(random, columns, rows, octaves=3):
    """A sum of noises, each twice as fine and half as strong as the one before."""
    layers = [(Noise(random, columns << k, rows << k), .5 ** k) for k in range(octaves)]
    total = sum(weight for _, weight in layers)
    return lambda u, v: sum(noise(u, v) * weight for noise, weight in layers) / total


def grain(random, rings=9):
    """Wood sawn along u: rings that bend, and fine pores."""
    bend, pores = clouds(random, 2, 3), Noise(random, 12, 96)

    def pattern(u, v):
        t = rings * v + 3.2 * bend(u, v)
        return .75 * (.5 + .5 * math.sin(2 * math.pi * t)) ** 1.6 + .25 * pores(u, v)
    return pattern


def bricks(columns, rows, joint, inside, shift=0.0):
    """Tiles with `inside` (a pattern over the picture) as their glaze and 1 in the joints; every second row is moved by
    `shift` of a tile. Glazes stay below 0.94."""
    def pattern(u, v):
        row = int(v * rows)
        x, y = (u * columns + shift * (row % 2)) % 1, v * rows - row
        edge = min(min(x, 1 - x) / columns, min(y, 1 - y) / rows)
        return 1.0 if edge < joint / 2 else .94 * inside(u, v)
    return pattern


def brushed(random):
    """Scratches along u."""
    fine, coarse = Noise(random, 4, 128), Noise(random, 3, 16)
    return lambda u, v: .7 * fine(u, v) + .3 * coarse(u, v)


# ---- pictures --------------------------------------------------------------------------------------------------------

def ramp(*colours):
    """256 colours (sRGB, 0 to 255) between the given ones, which are equally far apart."""
    out = []
    for k in range(256):
        t = k / 255 * (len(colours) - 1)
        i = min(int(t), len(colours) - 2)
        out.append(tuple(round(a + (b - a) * (t - i)) for a, b in zip(colours[i], colours[i + 1])))
    return out


def glazed(joint, *glazes):
    """A ramp for bricks(): glazes below 0.95, then the joints."""
    colours = ramp(*glazes)
    return [joint if k > 242 else colours[min(255, round(k * 255 / 242))] for k in range(256)]


def png(width, height, rows, palette=None):
    """One byte a pixel: an index into the palette, or a grey value. Stored without compression, so that the bytes do
    not depend on the version of a library."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + bytes(row) for row in rows)
    blocks = [raw[k:k + 65535] for k in range(0, len(raw), 65535)]
    data = b"\x78\x01" + b"".join(struct.pack("<BHH", k == len(blocks) - 1, len(b), len(b) ^ 0xffff) + b
                                  for k, b in enumerate(blocks)) + struct.pack(">I", zlib.adler32(raw))
    out = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3 if palette else 0, 0, 0, 0))
    if palette:
        out += chunk(b"PLTE", bytes(c for colour in palette for c in colour))
    return out + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def image(scene, name, pattern, palette=None, size=128):
    """Makes the picture <scene>-<name>.png of a pattern; without a palette it is grey. Returns the file's name."""
    file = f"{scene.name}-{name}.png"
    rows = [[min(255, max(0, round(255 * pattern((x + .5) / size, (y + .5) / size)))) for x in range(size)]
            for y in range(size)]
    scene.files[file] = png(size, size, rows, palette)
    return file


def image_texture(scene, name, family, file, metres=1.0, more=""):
    """A texture of a picture that repeats every `metres` of the (u, v) that textured() gives to meshes."""
    scene.texture(name, family, "imagemap", f'"string filename" "{file}" "float uscale" {number(1 / metres)} '
                                            f'"float vscale" {number(1 / metres)}{more}')


# ---- meshes ----------------------------------------------------------------------------------------------------------

def unwrapped(mesh):
    """The mesh as vertices, normals (None if flat), texture coordinates and faces. (u, v) are metres on the coordinate
    plane that a face is nearest to, u along the longer side of the mesh's bounds there: wood follows the piece."""
    points, normals, uvs, faces, index = [], [] if mesh.normals is not None else None, [], [], {}
    extent = [max(p[k] for p in mesh.vertices) - min(p[k] for p in mesh.vertices) for k in range(3)]
    for face in mesh.faces:
        a, b, c = (mesh.vertices[i] for i in face)
        n = normalized(cross(sub(b, a), sub(c, a)))
        axis = max(range(3), key=lambda k: abs(n[k]))
        u, v = (k for k in range(3) if k != axis)
        if extent[v] > extent[u]:
            u, v = v, u
        corners = []
        for i in face:
            if (i, axis) not in index:
                index[i, axis] = len(points)
                p = mesh.vertices[i]
                points.append(p)
                uvs.append((p[u], p[v]))
                if normals is not None:
                    normals.append(mesh.normals[i])
            corners.append(index[i, axis])
        faces.append(tuple(corners))
    return points, normals, uvs, faces


def textured(scene, piece, label=""):
    """As Scene.add, with texture coordinates."""
    if label:
        scene.raw(f"\n# {label}")
    groups = {}
    for name, mesh in piece.parts:
        groups.setdefault((name, mesh.normals is not None), []).append(mesh)
    for (name, _), meshes in groups.items():
        scene._use(name)
        points, normals, uvs, faces = [], None, [], []
        for mesh in meshes:
            first = len(points)
            p, n, uv, f = unwrapped(mesh)
            points, uvs = points + p, uvs + uv
            normals = normals if n is None else (normals or []) + n
            faces += [tuple(i + first for i in face) for face in f]
        scene.raw(f'NamedMaterial "{name}"')
        scene.raw(mesh_with_uv(points, normals, uvs, faces))


def mesh_with_uv(points, normals, uvs, faces):
    """The text of a triangle mesh."""
    text = f'Shape "trianglemesh" "point3 P" [ {"  ".join(numbers(p) for p in points)} ]\n'
    if normals is not None:
        text += f'  "normal N" [ {"  ".join(numbers(n, 3) for n in normals)} ]\n'
    return (text + f'  "point2 uv" [ {"  ".join(numbers(t, 3) for t in uvs)} ]\n'
            f'  "integer indices" [ {"  ".join("%d %d %d" % f for f in faces)} ]')
