#!/usr/bin/env python3
"""Kills a render (SIGKILL) again and again at random moments, resumes it from its checkpoint each time, and compares the
picture with that of an undisturbed render, bit by bit.

After every kill the checkpoint must be a file that can be read and lack no more seconds of rendering than the interval and
some slack; the samples in it must not become fewer. Exit status 0 only if all of that holds for every kill.

    tests/stress/kill_renders.py --pbrt build/release/src/pbrt/cmd/pbrt/pbrt --kills 200
"""
import argparse
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

SCENE = """LookAt 0 3 -5  0 0 0  0 1 0
Camera "perspective" "float fov" 50
Film "rgb" "integer xresolution" 40 "integer yresolution" 30 "bool savefp16" false
Sampler "zsobol" "integer pixelsamples" {samples}
Integrator "path" "integer maxdepth" 3
WorldBegin
Material "diffuse"
Shape "bilinearmesh" "point3 P" [ -6 0 -6  6 0 -6  -6 0 6  6 0 6 ]
Shape "bilinearmesh" "point3 P" [ 0 0 -6  0 0 6  0 2 -6  0 2 6 ]
"""
RESUMED = re.compile(r"Resuming from .*, after (\d+) samples? per pixel")


def scene_text(samples):
    lamps = "".join(f'LightSource "point" "point3 from" [ {i % 10 - 4.6} 1 {i // 10 - 3.5} ] "rgb I" [ 1 {i % 3} 1 ]\n'
                    for i in range(80))
    return SCENE.format(samples=samples) + lamps


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pbrt", required=True)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    parser.add_argument("--interval", type=float, default=0.02, help="seconds between checkpoints")
    parser.add_argument("--slack", type=float, default=3, help="further seconds that may be lost on a busy machine")
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--lightsampler", default="octree", help="one that learns while it renders is the hardest case")
    options = parser.parse_args()
    pbrt = str(pathlib.Path(options.pbrt).resolve())
    moments = random.Random(options.seed)
    problems, kills, renders, kept, temporaries, most_lost = [], 0, 0, [], 0, 0

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.pbrt").write_text(scene_text(options.samples))
        common = [pbrt, "--nthreads", "2", "--lightsampler", options.lightsampler, "scene.pbrt", "--outfile"]
        begin = time.monotonic()
        subprocess.run(common + ["whole.pfm"], cwd=folder, check=True, capture_output=True)
        seconds = time.monotonic() - begin
        whole = (folder / "whole.pfm").read_bytes()
        checkpoint = folder / "render.chk"
        command = common + ["out.pfm", "--checkpoint", checkpoint.name, "--checkpoint-interval", str(options.interval), "--resume"]
        samples = 0
        while kills < options.kills:
            process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            lines = []  # with the times when they came
            reader = threading.Thread(target=lambda p=process: [lines.append((time.time(), line)) for line in p.stderr])
            reader.start()
            # A few kills a render: also while it starts, reads its checkpoint, prepares and writes.
            try:
                process.wait(moments.uniform(0, max(0.3, seconds / 3)))
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
                kills += 1
            killed_at = time.time()
            process.wait()
            reader.join()
            messages = "".join(line for _, line in lines)
            if process.returncode not in (0, -signal.SIGKILL):
                problems.append(f"kill {kills}: status {process.returncode}: {messages}")
            found = RESUMED.search(messages)
            if found:
                if int(found[1]) < samples:
                    problems.append(f"kill {kills}: the checkpoint has {found[1]} samples after one with {samples}")
                samples = int(found[1])
                kept.append(samples)
                # Seconds of rendering that were not saved when the process was killed.
                went_on = next(when for when, line in lines if RESUMED.search(line))
                lost = killed_at - max(checkpoint.stat().st_mtime, went_on)
                most_lost = max(most_lost, lost)
                if process.returncode != 0 and lost > options.interval + options.slack:
                    problems.append(f"kill {kills}: {lost:.2f} s of rendering were lost")
            if process.returncode == 0:
                renders += 1
                if (folder / "out.pfm").read_bytes() != whole:
                    problems.append(f"kill {kills}: the finished picture differs from that of a whole render")
                checkpoint.unlink()
                samples = 0
            temporaries = max(temporaries, len(list(folder.glob(".pbrt-*.tmp"))))
        last = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        renders += 1
        if last.returncode != 0 or (folder / "out.pfm").read_bytes() != whole:
            problems.append(f"the last render: status {last.returncode}, {last.stderr}")
    if options.kills >= 5 and not kept:
        problems.append("nothing was tested: no render went on from a checkpoint")
    for problem in problems:
        print(problem)
    print(f"{kills} kills in {renders} renders of {seconds:.1f} s; {len(kept)} times gone on, from {len(set(kept))} different "
          f"numbers of samples; at most {most_lost:.2f} s of rendering lost; {temporaries} unfinished temporary files; {len(problems)} problems")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
