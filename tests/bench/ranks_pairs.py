#!/usr/bin/env python3
"""Two processes of one thread (mpirun) against one process of two threads, in turns on one machine.

    tests/bench/ranks_pairs.py --pbrt build/release/src/pbrt/cmd/pbrt/pbrt --pairs 7 scenes/many-rooms/many-rooms.pbrt
        --lightsampler octree --spp 64

Prints for each pair the seconds of rendering, of the whole program since its own start, and of CPU (mpirun's included), and
the medians of their ratios: one process over two, so more than 1 means that two processes are faster. The pictures must be equal.
"""
import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time


def run(command, folder, name):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    out = subprocess.run(command + ["--stats", "--quiet", "--outfile", os.path.join(folder, name)], check=True,
                         capture_output=True, text=True, env=dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1",
                                                                  OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")).stdout
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    values = {"wall": wall,
              "cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}
    for line in out.splitlines():
        words = line.strip()
        for key in ("preparing lights", "rendering", "building", "reading", "total"):
            if words.startswith(key + " (s)"):
                values[key] = float(words.split()[-1])
        if words.startswith("processes, threads"):
            values["MB sent"] = float(words.split(";")[1].split()[0])
    return values


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pbrt", required=True)
    parser.add_argument("--imgtool", help="beside pbrt if not given")
    parser.add_argument("--pairs", type=int, default=5)
    options, scene = parser.parse_known_args()
    imgtool = options.imgtool or options.pbrt[:-len("pbrt/pbrt")] + "imgtool/imgtool"
    mpirun = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", "2"]
    one = [options.pbrt, "--nthreads", "2"] + scene
    two = mpirun + [options.pbrt, "--nthreads", "1"] + scene
    pairs = []
    with tempfile.TemporaryDirectory() as folder:
        for i in range(options.pairs):
            order = [("one", one), ("two", two)]
            if i % 2:
                order.reverse()
            pair = {name: run(command, folder, name + ".exr") for name, command in order}
            pairs.append(pair)
            print(" | ".join("%s: rendering %.2f, prepass %.2f, total %.2f, wall %.2f, cpu %.2f" % (
                name, v["rendering"], v["preparing lights"], v["total"], v["wall"], v["cpu"])
                             for name, v in sorted(pair.items())), flush=True)
            if subprocess.run([imgtool, "diff", "--reference", os.path.join(folder, "one.exr"),
                               os.path.join(folder, "two.exr")], capture_output=True).returncode != 0:
                sys.exit("the pictures differ")
    print("%d pairs, one process of two threads over two processes of one thread, median (smallest to largest):" % len(pairs))
    for key in ("rendering", "preparing lights", "total", "wall", "cpu"):
        ratios = sorted(p["one"][key] / max(p["two"][key], 1e-9) for p in pairs)
        print("  %-17s %.3f (%.3f to %.3f)" % (key, statistics.median(ratios), ratios[0], ratios[-1]))
    print("  MB sent           %.3f" % pairs[-1]["two"]["MB sent"])


if __name__ == "__main__":
    main()
