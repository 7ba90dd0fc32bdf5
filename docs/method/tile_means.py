"""Compares the means of images of different seeds by two methods: tiles of the image, Welch's t-test."""
import functools
import hashlib
import json
import subprocess

import numpy

TILES = (4, 3)


def tile_means(pfm):
    """Mean brightness of the tiles of an image."""
    with open(pfm, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        pixels = numpy.frombuffer(file.read(), order).reshape(height, width, 3).mean(axis=2, dtype=float)
    across, down = TILES
    return numpy.array([t.mean() for row in numpy.array_split(pixels, down) for t in numpy.array_split(row, across, axis=1)])


@functools.cache
def version(program):
    return subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout


def rendered(program, flags, scene, folder):
    """Tile means of the image that pbrt renders; kept in `folder`, so that an interrupted comparison resumes."""
    flags = ["--quiet", "--quick", *map(str, flags)]
    kept = folder / "tiles.json"
    known = json.loads(kept.read_text()) if kept.exists() else {}
    key = " ".join([version(program).strip(), *flags, scene.name, hashlib.md5(scene.read_bytes()).hexdigest()])
    if key not in known:
        picture = folder / "agreement.pfm"
        subprocess.run([program, *flags, "--outfile", picture, scene], check=True, capture_output=True)
        known[key] = tile_means(picture).tolist()
        kept.write_text(json.dumps(known))
    return known[key]


def two_sided(t, freedom):
    """The probability of a larger |t| in Student's distribution, where t = sqrt(freedom) tan(angle)."""
    angles = numpy.linspace(numpy.arctan(abs(t) / freedom ** .5), numpy.pi / 2, 4001)
    whole = numpy.linspace(0, numpy.pi / 2, 4001)
    return numpy.trapz(numpy.cos(angles) ** (freedom - 1), angles) / numpy.trapz(numpy.cos(whole) ** (freedom - 1), whole)


def welch(a, b):
    """t, and the degrees of freedom, of the means of two samples."""
    va, vb = a.var(ddof=1) / len(a), b.var(ddof=1) / len(b)
    if va + vb == 0:
        return 0, 1
    return (a.mean() - b.mean()) / (va + vb) ** .5, (va + vb) ** 2 / (va ** 2 / (len(a) - 1) + vb ** 2 / (len(b) - 1))


def critical_t(freedom, limit):
    """The |t| that chance exceeds with this probability."""
    return next(t for t in numpy.arange(1, 1000, .05) if two_sided(t, freedom) < limit)


HEAD = ["scene", "method", "result", "least_p", "detectable_tile_percent", "whole_image_percent"]


def compare(ours, others, limit, critical):
    """Tile means of images (rows), of equal number: whether one differs, the least p of all tiles, the difference of a
    tile's mean that half of the tiles would have shown, relative to the tile, and that of the whole image."""
    lit = (others.mean(axis=0) > 0) | (ours.mean(axis=0) > 0)
    a, b = ours[:, lit], others[:, lit]
    least = min(two_sided(*welch(a[:, i], b[:, i])) for i in range(a.shape[1]))
    error = numpy.hypot(a.std(axis=0, ddof=1), b.std(axis=0, ddof=1)) / len(a) ** .5
    detectable = critical * error / b.mean(axis=0)
    return ["differs" if least < limit else "no difference detected", f"{least:.2g}",
            f"{100 * numpy.median(detectable):.2g}", f"{100 * (a.mean() / b.mean() - 1):+.2f}"]
