#!/usr/bin/env python3
"""Renders the scenes with the flags of list.txt with two builds and reports whether the pixels are equal, bit for bit.

For changes of structure that must not change pictures:

    tests/render/same_pixels/same_pixels.py OLD_BUILD NEW_BUILD [--only TEXT] [--jobs N]

OLD_BUILD and NEW_BUILD are build folders of two versions for the same processor (bits may differ from one processor to
another, so none are stored). Configure both with -DCMAKE_CXX_FLAGS=-ffp-contract=off: otherwise the compiler chooses anew,
wherever code has moved, which products and sums it rounds once. Every line is rendered with one thread by the old build and with three by the new one.
Films keep single precision. Lines that begin with "exr: " are written as EXR, all others as PFM.
Scenes are those of this checkout. Exit status 1 if any picture differs or was not rendered by both; what differs is
printed with the number of pixels and the largest difference relative to the mean.
"""
import argparse
import array
import concurrent.futures
import os
import re
import shlex
import struct
import subprocess
import sys
import tempfile

TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))


def program(build, name):
    path = os.path.join(os.path.abspath(build), "src/pbrt/cmd", name, name)
    if not os.path.isfile(path):
        sys.exit(f"{path} is missing: build the target {name} first.")
    return path


def cases(only):
    with open(os.path.join(os.path.dirname(__file__), "list.txt"), encoding="utf-8") as lines:
        for line in lines:
            line = line.split("#")[0].strip()
            if line and only in line:
                yield line


def exr_pixels(path):
    """The stored chunks of an EXR file with one part, without the header, which holds the time of rendering."""
    with open(path, "rb") as file:
        data = file.read()
    at = 8
    while data[at] != 0:  # attribute: name, type, size, value
        at = data.index(b"\0", data.index(b"\0", at) + 1) + 1
        at += 4 + struct.unpack_from("<i", data, at)[0]
    first_chunk = struct.unpack_from("<q", data, at + 1)[0]
    return data[first_chunk:]


def with_all_bits(scene):
    """The scene's text, with a film that stores single precision."""
    with open(scene, encoding="utf-8") as file:
        text = file.read()
    if "savefp16" in text:
        return text
    text, films = re.subn(r'^(\s*Film\s+"\w+")', r'\1 "bool savefp16" false', text, count=1, flags=re.MULTILINE)
    return text if films else 'Film "rgb" "bool savefp16" false\n' + text


def render(build, line, threads, path):
    """The bytes of the picture without those that may differ; a str with the reason if there is no picture."""
    scene, *flags = shlex.split(line)
    scene = os.path.join(TOP, scene)
    done = subprocess.run([program(build, "pbrt"), "-", "--quiet", "--outfile", path, "--nthreads", str(threads), *flags],
                          input=with_all_bits(scene), cwd=os.path.dirname(scene), capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        return f"exit status {done.returncode}: {done.stderr.strip().splitlines()[0] if done.stderr.strip() else ''}"
    if path.endswith(".exr"):
        pixels = exr_pixels(path)
    else:
        with open(path, "rb") as file:
            pixels = file.read()
    os.remove(path)
    return pixels


def compare(arguments, line, number, folder):
    extension = "pfm"
    if line.startswith("exr: "):
        line, extension = line[len("exr: "):], "exr"
    old = render(arguments.old, line, 1, f"{folder}/{number}-old.{extension}")
    new = render(arguments.new, line, 3, f"{folder}/{number}-new.{extension}")
    if isinstance(old, str) or isinstance(new, str):
        return False, "; ".join(f"{name}: {p}" for name, p in (("old", old), ("new", new)) if isinstance(p, str))
    if old == new:
        return True, ""
    if extension == "exr" or len(old) != len(new):
        return False, "other bytes"
    # A PFM file is three lines of text and then floats.
    a, b = (array.array("f", p.split(b"\n", 3)[3]) for p in (old, new))
    mean = sum(abs(v) for v in a) / len(a)
    differences = [abs(x - y) for x, y in zip(a, b) if x != y]
    return False, (f"{len(differences)} of {len(a)} values differ, at most by "
                   f"{max(differences) / max(mean, 1e-30):.3g} of the mean")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--only", default="", help="render only lines that contain this text")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    same = different = 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        lines = list(cases(arguments.only))
        results = pool.map(lambda item: compare(arguments, item[1], item[0], folder), enumerate(lines))
        for line, (good, why) in zip(lines, results):
            print(f"{'same     ' if good else 'DIFFERENT'} {line}{': ' + why if why else ''}", flush=True)
            same, different = same + good, different + (not good)
    print(f"{same} the same, {different} different")
    return 0 if different == 0 and same > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
