#!/usr/bin/python3
"""Stands in for lightlab: writes a results.json with known errors for the given samplers. STAND_IN_LOG: file
that every command line is added to. STAND_IN_FAIL: campaigns that end with status 1. STAND_IN_BIASED: a label.
STAND_IN_CLEAN_FROM: number of seeds from which verdicts are clean; below they are unknown.
STAND_IN_WAIT: a file that it makes before it waits for Ctrl-C."""
import json
import os
import pathlib
import sys
import time

ERRORS = {"uniform+mesh": 0.4, "spatial": 0.41, "neepp": 0.7, "octree:model=paper": 0.1,
          "octree:model=paper,leaves=512": 0.15, "octree:model=paper,leaves=32768": 0.12, "octree": 0.05, "bvh": 0.3}
STANDARD_ERROR = 0.01


def bias(label, seeds):
    if label == os.environ.get("STAND_IN_BIASED"):
        return {"verdict": "biased"}
    if seeds < int(os.environ.get("STAND_IN_CLEAN_FROM", 0)):
        return {"verdict": "unknown", "visibleImage": 0.2 / seeds, "visibleSixteenth": 2.0 / seeds,
                "selection": {"visibleSixteenth": 0.05}}
    return {"verdict": "clean", "visibleImage": 0.2 / seeds, "visibleSixteenth": 2.0 / seeds,
            "selection": {"visibleSixteenth": 0.007}}


def metrics(whole, trimmed):
    return {"relL2": whole, "relL2Trimmed": trimmed, "relL2Abs": whole, "relL2AbsTrimmed": trimmed}


def sampler(label, seconds, samples, seeds):
    seconds *= 3 if label == "spatial" else 1  # longer than the time budget
    error = ERRORS.get(label, 0.5)
    spread = {"mean": error, "stdDev": STANDARD_ERROR * 2 ** 0.5, "standardError": STANDARD_ERROR}
    octree = label.startswith("octree")
    rounds = [{"checkpoint": i, "samples": 2 ** i, "seconds": seconds / 2 ** (6 - i), "cpuSeconds": 1.0,
               "metrics": metrics(error * 2 ** (6 - i), error)} for i in range(7)]
    return {"label": label, "lightSampler": label.split(":")[0].split("+")[0], "parameters": {},
            "isOracle": label.startswith("oracle"), "reference": 0,
            "report": {"leavesBeforePruning": 77} if label == "octree" else {},
            "runs": [{"seed": s, "rounds": rounds} for s in range(seeds)],
            "summary": {"samples": samples, "seconds": seconds, "metrics": metrics(spread, spread),
                        "firefliesDecide": False, "cpuSecondsPerSample": 1.0, "preparationShare": 0.05,
                        "overhead": {"prepassSeconds": 0.02, "buildSeconds": 0.03, "renderSeconds": seconds - 0.05},
                        "leaves": 4321 if octree else None, "bytes": 51200 if octree else None,
                        "bias": bias(label, seeds)}}


def option(name, otherwise=None):
    return sys.argv[sys.argv.index(name) + 1] if name in sys.argv else otherwise


def labels(text):
    found = []
    for piece in text.split(","):
        if "=" in piece.split(":")[0].split("+")[0]:
            found[-1] += "," + piece
        else:
            found.append(piece)
    return found


out = pathlib.Path(option("--out"))
with open(os.environ["STAND_IN_LOG"], "a", encoding="utf-8") as log:
    log.write(" ".join(sys.argv[1:]) + "\n")
if out.name in os.environ.get("STAND_IN_FAIL", "").split(","):
    sys.exit(1)
if os.environ.get("STAND_IN_WAIT"):
    try:
        pathlib.Path(os.environ["STAND_IN_WAIT"]).touch()
        time.sleep(60)
    except KeyboardInterrupt:
        pathlib.Path(os.environ["STAND_IN_WAIT"]).write_text("ended in good order")
        sys.exit(130)
out.mkdir(parents=True, exist_ok=True)
timed = "--time" in sys.argv
seeds = int(option("--seeds"))
budget = float(option("--time") or option("--spp"))
(out / "results.json").write_text(json.dumps({
    "schema": 2, "scene": sys.argv[1], "sceneName": pathlib.Path(sys.argv[1]).stem, "commit": "abc1234",
    "machine": {"cpu": "Example CPU", "threads": 2}, "mode": "time" if timed else "samples", "budget": budget,
    "seeds": seeds, "resolution": [96, 72], "maxDepth": 5, "direct": "--direct" in sys.argv,
    "settings": {"divisor": int(option("--divisor"))}, "references": [{"samples": 512, "noise": 0.001}],
    "samplers": [sampler(s, budget if timed else 2.0, 64 if timed else budget, seeds)
                 for s in labels(option("--samplers"))]}))
(out / "chart-error-time.svg").write_text("<svg/>")
(out / "report.html").write_text("<html/>")
