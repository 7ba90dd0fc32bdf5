#!/usr/bin/env python3
"""Runs the benchmarks of two builds in turns: rays, light selection, reading, building, and seconds a sample.

    tests/bench/side_by_side.py OLD_BUILD NEW_BUILD [--rounds N] [--only TEXT] [--crop SHARE] [--json FILE]

Both are build folders (with pbrt, rays_bench, bench_scene_select and bench_big_scene; those that --only leaves out need
not be there) for the same machine. Every measurement is made in turns, old and new, `rounds` times. The smallest value of
each build, which the machine's noise disturbed least, and their ratio are printed. Times are CPU seconds of one thread.
Scenes are those of this checkout, and those of ../shared/scenes where these are present. Renderings end
with the geometric mean of how many times as many samples a CPU second of the new build makes.

`--only render --crop 0.5` renders the middle of every picture, half as wide and half as high, with 16 samples a pixel.
"""
import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile

TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
SHARED = {name: os.path.join(TOP, "../shared/scenes", path)
          for name, path in (("Lamp", "lamp/lamp.pbrt"), ("Veach-Ajar", "veach-ajar/scene-v4.pbrt"),
                             ("dining-room", "dining-room/dining-room.pbrt"),
                             ("classroom", "classroom/classroom.pbrt"), ("spaceship", "spaceship/spaceship.pbrt"))}
RENDERED = ["hotel", "white-room", "many-rooms", "glossy", "env-interior", "dollhouse", "coated-room", "outdoor",
            "fog-hotel"]
SELECTION = ["ajar", "white-room", "glossy", "many-rooms", "hotel"]
SAMPLERS = ["power", "bvh", "octree"]


def scene(name):
    return os.path.join(TOP, "scenes", name, name + ".pbrt")


def run(command):
    """Runs a command; returns its output and the CPU seconds that it took."""
    with tempfile.TemporaryFile("w+") as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        text = out.read()
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} failed:\n{text}")
    return text, usage.ru_utime + usage.ru_stime


def rendering(build, path, sampler, spp, crop, picture):
    first, end = .5 - crop / 2, .5 + crop / 2
    text, cpu = run([f"{build}/src/pbrt/cmd/pbrt/pbrt", "--nthreads", "1", "--stats", "--spp", str(spp), "--lightsampler",
                     sampler, "--cropwindow", f"{first},{end},{first},{end}", "--outfile", picture, path])
    # Old builds, in which start-up is not a stage of its own, print "reading, building (s)   0.002, 0.066".
    building = re.search(r"^ *(?:reading, )?building \(s\) +(?:[0-9.]+, )?([0-9.]+)", text, re.M).group(1)
    rendering_seconds = re.search(r"^ *rendering \(s\) +([0-9.]+)", text, re.M).group(1)
    return {"building (s)": float(building), "rendering (s a sample)": float(rendering_seconds) / spp,
            "all (CPU s a sample)": cpu / spp}


def selection(build, path):
    text, _ = run([f"{build}/tests/bench/bench_scene_select", path, *SAMPLERS])
    found = json.loads(text[text.index("{"):])
    result = {}
    for name, of in found["samplers"].items():
        # In old builds both questions weigh the lights, so their times are added up.
        both = of.get("sampleAndPmfNanoseconds", of["sampleNanoseconds"] + of["pmfNanoseconds"])
        result[f"{found['lights']} lights, {name}: choice and PMF (ns)"] = both
        result[f"{found['lights']} lights, {name}: choice (ns)"] = of["sampleNanoseconds"]
    return result


def rays(build):
    text, _ = run([f"{build}/tests/bench/rays_bench", "--benchmark_format=json", "--benchmark_min_time=0.2"])
    return {b["name"] + " (ns)": b["cpu_time"] for b in json.loads(text[text.index("{"):])["benchmarks"]}


def big_scene(build):
    text, _ = run([f"{build}/tests/bench/bench_big_scene", "1", "1"])
    found = json.loads(text[text.index("{"):])
    return {key: value for key, value in found.items() if isinstance(value, (int, float)) and "econds" in key}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default="", help="measurements whose name holds this text")
    parser.add_argument("--crop", type=float, default=1, metavar="SHARE",
                        help="of the width and height of every picture, its middle (1)")
    parser.add_argument("--json", help="write all values to this file")
    args = parser.parse_args()
    builds = {"old": os.path.abspath(args.old), "new": os.path.abspath(args.new)}
    with tempfile.TemporaryDirectory() as folder:
        picture = os.path.join(folder, "a.pfm")
        measurements = {"rays": rays, "big scene": big_scene}
        for name in SELECTION:
            measurements[f"selection, {name}"] = lambda build, p=scene(name): selection(build, p)
        rendered = {**SHARED, **{name: scene(name) for name in RENDERED}}
        for name, path in rendered.items():
            if not os.path.isfile(path):
                print(f"{path} is absent and left out.")
                continue
            for sampler in ("bvh", "octree"):
                measurements[f"render, {name}, {sampler}"] = (
                    lambda build, p=path, s=sampler: rendering(build, p, s, 16, args.crop, picture))
        values, left_out = {}, []
        print(f"{'':64}{'old':>11}{'new':>11}{'new / old':>11}")
        for name, measure in measurements.items():
            if args.only not in name:
                continue
            try:
                for _ in range(args.rounds):
                    for which, build in builds.items():
                        for key, value in measure(build).items():
                            values.setdefault(f"{name}: {key}", {}).setdefault(which, []).append(value)
            except RuntimeError as error:
                print(f"{name} is left out: {error}", file=sys.stderr)
                left_out.append(name)
                continue
            for key, of in values.items():
                if key.startswith(name + ":") and len(of) == 2:
                    old, new = min(of["old"]), min(of["new"])
                    print(f"{key:64}{old:11.4g}{new:11.4g}{new / old if old else float('nan'):11.3f}", flush=True)
    gains = [min(of["old"]) / min(of["new"]) for key, of in values.items()
             if key.endswith("all (CPU s a sample)") and len(of) == 2]
    if gains:
        print(f"Samples a CPU second, new / old, {len(gains)} renderings: geometric mean "
              f"{statistics.geometric_mean(gains):.3f}, smallest {min(gains):.3f}, largest {max(gains):.3f}.")
    if left_out:
        print("Left out because a build failed: " + "; ".join(left_out))
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump(values, file, indent=1)


if __name__ == "__main__":
    main()
