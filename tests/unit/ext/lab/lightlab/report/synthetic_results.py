"""A made-up output folder of lightlab: results.json (schema 2) and small pictures of known colours. python3
synthetic_results.py OUT writes one to look at."""
import json
import math
import pathlib
import struct
import sys
import zlib

WIDTH, HEIGHT = 96, 72
EXPOSURE = 0.5  # the factor by which the pictures are multiplied
# label: (relL2 of one sample, seconds per sample, verdict, solid colour of result.png, preparation seconds)
SAMPLERS = {
    "uniform": (4.0, 0.10, "clean", (200, 30, 30), 0.0),
    "power": (2.1, 0.26, "clean", (30, 160, 30), 0.0),
    "bvh": (1.2, 0.31, "clean", (30, 30, 200), 0.01),
    "neepp": (0.09, 0.30, "biased", (160, 30, 160), 0.6),  # the lowest error of all, and biased
    "octree": (0.30, 0.29, "clean", (220, 120, 20), 0.8),
    "octree:leaves=512": (0.41, 0.28, "clean", (240, 200, 60), 0.7),
    "oracle": (0.2, 6.0, "unknown", (20, 170, 170), 0.0),
}


def write_png(path, pixel, width=WIDTH, height=HEIGHT):
    """Writes an 8-bit RGB picture; pixel(x, y) gives the colour."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = b"".join(b"\0" + bytes(v for x in range(width) for v in pixel(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                     + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def linear(byte):
    v = byte / 255
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def rgbe(colour):
    """The four bytes of a pixel of a Radiance file; colour: linear values."""
    most = max(colour)
    if most <= 0:
        return bytes(4)
    exponent = math.frexp(most)[1]
    return bytes([*(int(v * 2.0 ** (8 - exponent)) for v in colour), exponent + 128])


def write_hdr(path, pixel, width=WIDTH, height=HEIGHT):
    """Writes a Radiance file as lightlab does; pixel(x, y) gives the colour at the default exposure as sRGB bytes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    known = {}
    rows = bytearray()
    for y in range(height):
        for x in range(width):
            colour = pixel(x, y)
            if colour not in known:
                known[colour] = rgbe([linear(v) / EXPOSURE for v in colour])
            rows += known[colour]
    path.write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + rows)


def wobble(*key):
    """A fixed pseudo-random factor near 1."""
    return 1 + 0.3 * (zlib.crc32(repr(key).encode()) / 2**32 - 0.5)


def metrics_of(error):
    return {"relL2": error, "MSE": error * 0.02, "MRSE": error * 1.1, "MAE": error ** 0.5 * 0.1,
            "SMAPE": min(error ** 0.5, 2.0), "FLIP": min(error ** 0.4 * 0.2, 1.0), "relL2Trimmed": error * 0.8,
            "relL2Abs": error * 0.9, "relL2AbsTrimmed": error * 0.7}


def sampler_entry(label, seeds, rounds):
    base, cost, verdict, _, preparation = SAMPLERS[label]
    kind, _, options = label.partition(":")
    folder = label.replace(":", "-").replace("=", "-")
    runs = []
    for seed in range(seeds):
        last = max(1, rounds - (4 if kind == "oracle" else 0))
        points = []
        for i in range(last):
            n = 2 ** i
            points.append({"samples": n, "seconds": preparation + n * cost * wobble("t", label, seed, i) ** 0.2,
                           "cpuSeconds": 2 * (preparation + n * cost),
                           "metrics": metrics_of(base / n * wobble(label, seed, i))})
        runs.append({"seed": seed, "image": f"{folder}/seed{seed}.exr", "prepareSeconds": preparation,
                     "shadowRays": 1000000, "shadowRaysBlocked": 310000, "rounds": points})
    final = [r["rounds"][-1] for r in runs]
    mean = sum(f["metrics"]["relL2"] for f in final) / seeds
    seconds = sum(f["seconds"] for f in final) / seeds
    spread = {k: {"mean": v, "stdDev": 0.05 * v, "standardError": 0.05 * v / seeds ** 0.5}
              for k, v in metrics_of(mean).items()}
    octree = kind == "octree"
    return {
        "label": label, "lightSampler": kind,
        "parameters": {"leaves": int(options.split("=")[1].split(",")[0]) if options else 4096} if octree else {},
        "meshLights": octree, "isOracle": kind == "oracle",
        "reference": 0,
        "report": {"parameters": "{\"leaves\":4096}", "records": 270000,
                   "cells": {"full": 5100, "empty": 235}} if octree else {},
        "views": views_of(folder, kind), "structure": "depth  leaves\n    2      12\n    3    5323\n" if octree else "",
        "picture": f"{folder}/result.png", "pictureRange": f"{folder}/result.hdr",
        "errorPicture": f"{folder}/error.png", "runs": runs,
        "summary": {
            "samples": final[0]["samples"], "seconds": seconds, "cpuSeconds": 2 * seconds, "metrics": spread,
            "firefliesDecide": kind == "power", "efficiency": 1 / (mean * seconds),
            "speedUp": 3.2 if octree else None, "speedUpAgainst": "bvh" if octree else "",
            "ratioToOracle": None if kind == "oracle" else base / 0.2,
            "overhead": {"prepassSeconds": preparation * 0.9, "buildSeconds": preparation * 0.1,
                         "renderSeconds": seconds - preparation},
            "leaves": 5335 if octree else None, "bytes": 49504 if octree else None, "shadowRays": 1.0e6 * seeds,
            "blockedShare": 0.31,
            "bias": {"verdict": verdict, "tiles": 300, "tests": 900, "worstZ": 9.7 if verdict == "biased" else 3.2,
                     "pValue": 1e-12 if verdict == "biased" else 0.4,
                     "meanDifference": -0.08 if verdict == "biased" else 0.001},
        }}


def layer(file, name, most=None, mean=0.5):
    """A layer of a inspection view; most: its largest value, or None for colours without order."""
    return {"name": name, "file": file, "meaning": f"what {name} is", "isFlat": False, "min": 0,
            "max": most or 7, "mean": mean,
            "colours": "one per number, without order" if most is None else {"darkest": 0, "brightest": most}}


def flat(name, value=None, **more):
    """A layer without a picture; value: its only value, or None if it has no finite one."""
    known = {} if value is None else {"min": value, "max": value, "mean": value}
    return {"name": name, "file": None, "meaning": f"what {name} is", "isFlat": True,
            "colours": {"darkest": 0, "brightest": 1}, **known, **more}


def views_of(folder, kind):
    names = [("sampler.leaf", None, 3)] if kind == "octree" else []
    # Seven layers of one kind: the page shows the four with the largest means.
    names += [(f"sampler.found_{i}", 1, i / 10) for i in range(7)] if kind == "octree" else []
    names += [("entropy", 3.25, 1), ("brightest_probability", 1, 0.5)]
    if kind == "neepp":  # the layers of a sampler with one leaf
        return {"everyNthPixel": 1, "samplesPerLight": 8,
                "layers": [flat("sampler.leaf", 0), flat("sampler.leaf_records", 1234), flat("entropy", 1.5),
                           flat("log10_excess")]}
    return {"everyNthPixel": 2 if kind == "octree" else 1, "samplesPerLight": 8,
            "layers": [layer(f"{folder}/views/{n}.png", n, most, mean) for n, most, mean in names]}


def conclusion_of(winner):
    """The conclusion as lightlab writes it; without a winner the octree has the lowest mean error."""
    headline = f"{winner} has the lowest error at equal samples." if winner else "Undecided. Mean relL2: octree 0.01."
    reasons = [] if winner else ["Its lead over bvh is within the noise of the runs (level 5 %)."]
    doubts, remarks = ["The references <differ> by relL2 25."], ["Biased, and therefore not competing: neepp."]
    return {"winner": winner, "lowestError": winner or "octree", "level": 0.05, "headline": headline,
            "reasons": reasons, "doubts": doubts, "remarks": remarks,
            "sentences": [headline, *reasons, *(f"Doubt: {d}" for d in doubts), *(f"Note: {r}" for r in remarks)]}


def make(folder, labels=None, seeds=3, rounds=7, winner="octree"):
    """Writes the folder and returns the results."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    labels = list(SAMPLERS) if labels is None else labels
    results = {
        "schema": 2, "scene": "scenes/hotel/hotel.pbrt", "sceneName": "hotel", "sceneHash": "0123456789abcdef",
        "commit": "abc1234", "commandLine": "lightlab scenes/hotel/hotel.pbrt --spp 64 --seeds 3",
        "date": "2026-11-21T03:00:00Z", "errorScale": 1.25, "exposure": EXPOSURE,
        "machine": {"cpu": "Example CPU <2 GHz> & more", "threads": 2, "memoryGB": 24.0, "os": "Debian 12"},
        "mode": "samples", "budget": 64, "seeds": seeds, "resolution": [WIDTH, HEIGHT], "maxDepth": 5, "direct": False,
        "references": [{"file": "reference-0.exr", "picture": "reference-0.png", "pictureRange": "reference-0.hdr",
                        "sampler": "bvh", "samples": 1024,
                        "seconds": 80.1, "noise": 0.0003}],
        "crops": [{"name": "a", "x0": 10, "y0": 20, "x1": 34, "y1": 44},
                  {"name": "b", "x0": 60, "y0": 30, "x1": 84, "y1": 54}],
        "views": {"everyNthPixel": 1, "samplesPerLight": 8, "layers": [
            layer("views/brightest.png", "brightest"),
            {**layer("views/visibility.12.png", "visibility.12", 1), "light": 'LightSource "point" at hotel.pbrt:88'}]},
        "samplers": [sampler_entry(label, seeds, rounds) for label in labels],
        "conclusion": conclusion_of(winner)}
    for write, suffix in ((write_png, "png"), (write_hdr, "hdr")):
        write(folder / f"reference-0.{suffix}", lambda x, y: (x * 2, y * 3, 128))
    for entry in results["samplers"]:
        r, g, b = SAMPLERS[entry["label"]][3]
        for write, file in ((write_png, entry["picture"]), (write_hdr, entry["pictureRange"])):
            write(folder / file, lambda x, y: (r, g, (b + 40 * ((x // 8 + y // 8) % 2)) % 256))
        write_png(folder / entry["errorPicture"], lambda x, y: (r // 4, g // 4, 255 if (x + y) % 16 < 8 else b // 4))
    views = [results["views"], *(entry["views"] for entry in results["samplers"])]
    for k, v in enumerate(v for view in views for v in view["layers"] if v["file"]):
        write_png(folder / v["file"], lambda x, y: (5 * k % 256, 100 + x % 50, 90 + y % 50))
    (folder / "results.json").write_text(json.dumps(results, indent=1))
    return results


if __name__ == "__main__":
    make(sys.argv[1])
