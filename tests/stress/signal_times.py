#!/usr/bin/env python3
"""Starts pbrt many times, sends SIGINT, SIGTERM or SIGHUP at a moment of the run, and prints for every phase how long the
notice and the end of the process took after the signal.

The phases are measured in a first, undisturbed run. Every phase gets the same number of moments, however short it is. Two
scenes take turns: scenes/many-rooms, whose light sampler goes on learning while it renders, and one with a big image. Exit
status 0 only if every process ended with 128 + the signal's number (or by the signal itself before it caught signals) and
left no temporary file.

    tests/stress/signal_times.py --pbrt build/release/src/pbrt/cmd/pbrt/pbrt --starts 100
"""
import argparse
import collections
import os
import pathlib
import signal
import statistics
import subprocess
import tempfile
import threading
import time

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
MANY_ROOMS = pathlib.Path(__file__).resolve().parents[2] / "scenes/many-rooms/many-rooms.pbrt"
BIG_IMAGE = """LookAt 0 1 -5  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" {0} "integer yresolution" {1}
Sampler "independent" "integer pixelsamples" 1
WorldBegin
LightSource "infinite" "rgb L" [ 1 2 3 ]
Shape "sphere"
"""
PHASES = ["starting", "reading", "building", "preparing lights", "rendering", "writing", "ending"]


class Run:
    """A process, with the times of its messages."""

    def __init__(self, pbrt, arguments, folder):
        self.begin = time.monotonic()
        self.process = subprocess.Popen([pbrt, "--outfile", "out.exr", *arguments], cwd=folder, text=True,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.lines = []
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self):
        for line in self.process.stderr:
            self.lines.append((time.monotonic(), line))

    def wait(self, timeout):
        try:
            self.process.wait(timeout)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        end = time.monotonic()
        self.reader.join()
        return end

    def phase(self):
        """The phase in which the signal came, according to the text of the notice."""
        for _, line in self.lines:
            if line.startswith("Interrupted while "):
                return line.removeprefix("Interrupted while ").split(":")[0]
            if line.startswith("Interrupted; "):
                return "writing" if line.startswith("Interrupted; writing") else "rendering"
        return "ending" if any(line.startswith("Wrote ") for _, line in self.lines) else "starting"

    def notice(self):
        return next((when for when, line in self.lines if line.startswith("Interrupted")), None)


def watch(pbrt, arguments, folder, timeout):
    """The phases of an undisturbed run, as pairs (phase, seconds)."""
    run = Run(pbrt, arguments, folder)
    run.wait(timeout)
    if run.process.returncode != 0:
        raise SystemExit("".join(line for _, line in run.lines))
    found, begin = [], run.begin
    for when, line in run.lines:
        if ": done in " in line and line.split(":")[0] in PHASES:
            found.append((line.split(":")[0], when - begin))
            begin = when
    return found


def wait_until(run, phase, seconds):
    """Waits until the phase before this one is done, and the given number of seconds more. Returns False if the process ended
    before."""
    before = PHASES[PHASES.index(phase) - 1]
    begin = run.begin
    while before != "starting":
        if when := next((when for when, line in run.lines if line.startswith(before + ": done in ")), None):
            begin = when
            break
        if run.process.poll() is not None:
            return False
        time.sleep(0.001)
    time.sleep(max(0, begin + seconds - time.monotonic()))
    return run.process.poll() is None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pbrt", required=True, type=os.path.abspath)
    parser.add_argument("--starts", type=int, default=100, help="number of starts of both scenes together")
    parser.add_argument("--size", type=int, nargs=2, default=(2400, 1600), help="width and height of the big image in pixels")
    parser.add_argument("--spp", type=int, default=4, help="samples per pixel of many-rooms")
    parser.add_argument("--pixelbounds", type=int, nargs=4, default=(0, 480, 0, 360), help="pixel bounds of many-rooms")
    parser.add_argument("--minutes", type=float, default=60, help="start no more processes after this time")
    parser.add_argument("--timeout", type=float, default=300, help="seconds until a process counts as hung")
    arguments = parser.parse_args()
    times = collections.defaultdict(list)  # phase: (to the notice, to the end) in milliseconds
    wrong = collections.defaultdict(list)
    early = 0
    until = time.monotonic() + 60 * arguments.minutes
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "big.pbrt").write_text(BIG_IMAGE.format(*arguments.size))
        scenes = [["--lightsampler", "octree", "--spp", str(arguments.spp), "--pixelbounds", *map(str, arguments.pixelbounds),
                   str(MANY_ROOMS)], ["big.pbrt"]]
        phases = [watch(arguments.pbrt, scene, folder, arguments.timeout) for scene in scenes]
        for scene, found in zip(scenes, phases):
            print(pathlib.Path(scene[-1]).stem + ":", ", ".join(f"{name} {seconds:.2f} s" for name, seconds in found), flush=True)
        for number in range(arguments.starts):
            if time.monotonic() > until:
                print(f"{number} starts were made before the time was over.")
                break
            which, turn = number % len(scenes), number // len(scenes)
            phase, seconds = phases[which][turn % len(phases[which])]
            rounds = max(1, arguments.starts // len(scenes) // len(phases[which]))
            moment = seconds * ((turn // len(phases[which]) + 0.5) / rounds % 1)
            kind = SIGNALS[number % len(SIGNALS)]
            # A run that ends sooner than the measured one is repeated with an earlier moment.
            for _ in range(8):
                (folder / "out.exr").unlink(missing_ok=True)
                run = Run(arguments.pbrt, scenes[which], folder)
                if in_time := wait_until(run, phase, moment):
                    break
                run.wait(None)
                moment /= 2
            if not in_time:
                early += 1
                continue
            sent = time.monotonic()
            run.process.send_signal(kind)
            ended = run.wait(arguments.timeout)
            phase, notice = run.phase(), run.notice()
            times[phase].append((1000 * (notice - sent) if notice else None, 1000 * (ended - sent)))
            status = run.process.returncode
            expected = [128 + kind, -kind] if phase == "starting" else [128 + kind]
            # At the very end of a run nothing catches signals any more, or the process is gone.
            if phase == "ending":
                expected += [-kind, 0]
            if status not in expected:
                wrong[phase].append(f"{kind.name}: status {status}")
            if left := [f.name for f in folder.iterdir() if f.name.startswith(".")]:
                wrong[phase].append(f"{kind.name}: left {left}")
                for f in left:
                    (folder / f).unlink()
    print("\n| phase | signals | notice: median, largest ms | end: median, largest ms | wrong |\n|---|---|---|---|---|")
    for phase in PHASES + sorted(set(times) - set(PHASES)):
        if not times[phase]:
            continue
        columns = []
        for values in zip(*times[phase]):
            known = [v for v in values if v is not None]
            columns.append(f"{statistics.median(known):.0f}, {max(known):.0f}" if known else "none")
        print(f"| {phase} | {len(times[phase])} | {columns[0]} | {columns[1]} | {'; '.join(wrong[phase]) or 'none'} |")
    if early:
        print(f"{early} moments were left out because the process had always ended before the signal.")
    return 1 if any(wrong.values()) else 0


if __name__ == "__main__":
    raise SystemExit(main())
