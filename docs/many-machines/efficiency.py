#!/usr/bin/env python3
"""How well many machines of `threads` threads use their time on one picture: prints the table of docs/many-machines.md.

    docs/many-machines/efficiency.py [--threads 64] [--spp 4096]

It adds up what each step costs, from constants measured on one machine (the commands are beside them) and from two numbers that
are assumed, not measured, for a network between machines.
"""
import argparse
import math

# Measured. many-rooms (200 mesh lights) with octree, `pbrt --stats --nthreads 1 --lightsampler octree --spp 16`, while other
# programs ran (phases in seconds as they passed, samples by CPU time, so that the phases are rather too long):
READ_AND_BUILD = 0.39  # seconds, every process
PREPASS_PATHS = 0.1  # seconds, every process traces all paths (half of the prepass is reckoned to be paths)
PREPASS_RAYS = 0.1  # seconds, shared
LEARNING = 0.61  # seconds, every process builds all trees
SAMPLES_PER_SECOND = 350e3  # of one thread
FOUND_BYTES = 13e6  # at most, 400,000 shadow rays of 33 bytes, at each of four learnings
FILM_BYTES_PER_PIXEL = 64  # rgb film
# `mpirun -n 2 build/release/tests/bench/ranks_bench`, `mpirun -n 2 pbrt --pixel 5,5 --spp 1` less the same without mpirun:
START = 1.1  # seconds, mpirun and MPI_Init
ANSWER = 96e-6  # CPU seconds of the first process for each answer, polling while it waits included: an upper bound
MERGE = 0.17e9  # bytes a second of a reduction between two processes (64 MB in 0.39 s), other programs running
# Assumed for a network of 25 Gbit/s:
LATENCY = 50e-6  # seconds from one process to another that waits, polling included
BANDWIDTH = 2.5e9  # bytes a second


def times(machines, threads, pixels, spp):
    """Seconds of each step."""
    levels = math.ceil(math.log2(machines)) if machines > 1 else 0
    all_threads = machines * threads
    work = pixels * spp / SAMPLES_PER_SECOND
    steps = {
        "start": (START if machines > 1 else 0) + READ_AND_BUILD,
        # Trees are built on a few threads; what every process repeats does not shrink.
        "lights": PREPASS_PATHS / threads + PREPASS_RAYS / all_threads + LEARNING / min(threads, 4),
        "samples": work / all_threads,
    }
    if machines == 1:
        return steps
    # Parts of a wave: 64 for each thread, but no more than pixels. The last one to finish is waited for.
    parts = min(pixels, max(pixels / 256, 64 * all_threads))
    steps["waiting"] = steps["samples"] * all_threads / parts
    waves = math.ceil(math.log2(spp)) + 2
    # A machine asks for at most four parts a thread at once, and for a quarter of its share towards the end.
    share = parts / machines
    asks = max(0.0, share / (4 * threads) - 4) + math.log(max(2, min(share, 16 * threads))) / math.log(4 / 3)
    answering = waves * machines * asks * ANSWER
    # Answers cost time only as far as they take longer than the samples.
    steps["answers"] = max(0.0, answering - steps["samples"])
    steps["messages"] = waves * 4 * levels * LATENCY
    steps["learned"] = 4 * (FOUND_BYTES + levels * FOUND_BYTES) / BANDWIDTH
    film = pixels * FILM_BYTES_PER_PIXEL
    steps["film"] = levels * film * (1 / BANDWIDTH + 1 / MERGE)
    return steps


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=64)
    parser.add_argument("--spp", type=int, nargs="*", default=[4096, 262144])
    options = parser.parse_args()
    pixels = 1920 * 1080
    names = ["start", "lights", "samples", "waiting", "answers", "messages", "learned", "film"]
    for spp in options.spp:
        alone = sum(times(1, options.threads, pixels, spp).values())
        print("1920 x 1080 pixels, %d samples, machines of %d threads; one machine takes %.0f s" %
              (spp, options.threads, alone))
        print("| machines | " + " | ".join(names) + " | seconds | efficiency | most lost to |")
        print("|---" * (len(names) + 4) + "|")
        for machines in (8, 64, 512, 4096):
            steps = times(machines, options.threads, pixels, spp)
            whole = sum(steps.values())
            lost = max((n for n in names if n != "samples"), key=lambda n: steps[n])
            print("| %s | %s | %.1f | %.2f | %s |" % ("{:,}".format(machines), " | ".join("%.2f" % steps[n] for n in names),
                                                     whole, alone / (machines * whole), lost))
        print()


if __name__ == "__main__":
    main()
