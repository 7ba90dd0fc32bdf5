#!/usr/bin/env python3
"""Starts pbrt many times on a scene whose textures are PNG files with colour profiles, and counts how the starts end.

OpenImageIO 2.4.7 crashes or hangs when two threads read the headers of such files at once. Tags of the profile that it
does not know cause this; real profiles have a few, these have many. Exit status 0 only if every start ends well.

    tests/stress/png_starts.py --pbrt build/release/src/pbrt/cmd/pbrt/pbrt --starts 2000
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import struct
import subprocess
import tempfile
import zlib

PROFILE_TEXT = b"text\0\0\0\0stress\0\0"


def profile(tags):
    """An ICC profile of a monitor by "IEC ", model "sRGB", whose tags are all the same text."""
    text_at = 132 + 12 * len(tags)
    size = text_at + len(PROFILE_TEXT)
    head = struct.pack(">I4xI12s6H4s4s4x4s4s8xI3I", size, 0x02100000, b"mntrRGB XYZ ", 1998, 2, 9, 6, 49, 0, b"acsp", b"MSFT",
                       b"IEC ", b"sRGB", 0, 0xF6D6, 0x10000, 0xD32D)
    table = b"".join(tag + struct.pack(">II", text_at, len(PROFILE_TEXT)) for tag in tags)
    return head.ljust(128, b"\0") + struct.pack(">I", len(tags)) + table + PROFILE_TEXT


def png(width, height, icc):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes((7 * x + 13 * y) % 256 for x in range(3 * width)) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"iCCP", b"profile\0\0" + zlib.compress(icc)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_scene(folder, images, tags):
    """Every profile has tags of its own, and every image a size of its own."""
    scene = ['Film "rgb" "integer xresolution" 4 "integer yresolution" 4 "string filename" "stress.exr"',
             'Sampler "independent" "integer pixelsamples" 1', 'Camera "perspective"', 'WorldBegin',
             'LightSource "infinite"']
    for i in range(images):
        names = [b"%c%c%02d" % (97 + i // 26, 97 + i % 26, tag) for tag in range(tags)]
        (folder / f"{i}.png").write_bytes(png(4 + i, 4 + i % 7, profile(names)))
        scene += [f'Texture "t{i}" "spectrum" "imagemap" "string filename" "{i}.png"',
                  f'Material "diffuse" "texture reflectance" "t{i}"', f'Translate 0 0 {i + 3}', 'Shape "sphere"']
    (folder / "stress.pbrt").write_text("\n".join(scene) + "\n")


def start(arguments, folder, number):
    command = [arguments.pbrt, "--quiet", "--nthreads", str(arguments.threads), "--outfile", f"out{number}.exr"]
    command += ["--texture-cache-mb", "8"] * (number % 4 == 3) + ["stress.pbrt"]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=arguments.timeout)
    except subprocess.TimeoutExpired:
        return "hung"
    image = folder / f"out{number}.exr"
    if done.returncode == 0 and image.exists():
        image.unlink()
        return "ended well"
    last = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
    return f"exit status {done.returncode}" + (f": {last[0][:100]}" if last else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pbrt", required=True, type=os.path.abspath)
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--threads", type=int, default=4)
    parser.add_argument("--jobs", type=int, default=1, help="number of starts at the same time")
    parser.add_argument("--images", type=int, default=48)
    parser.add_argument("--tags", type=int, default=96, help="tags of every profile, at most 96")
    parser.add_argument("--timeout", type=float, default=60, help="seconds until a start counts as hung")
    arguments = parser.parse_args()
    outcomes = collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_scene(folder, arguments.images, arguments.tags)
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            runs = [pool.submit(start, arguments, folder, number) for number in range(arguments.starts)]
            for done, run in enumerate(concurrent.futures.as_completed(runs), 1):
                outcomes[run.result()] += 1
                if done % 100 == 0:
                    print(done, dict(outcomes), flush=True)
    for outcome, count in outcomes.most_common():
        print(f"{count:6} {outcome}")
    return 0 if outcomes["ended well"] == arguments.starts else 1


if __name__ == "__main__":
    raise SystemExit(main())
