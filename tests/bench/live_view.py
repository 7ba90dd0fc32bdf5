#!/usr/bin/env python3
"""Measures what watching a render costs: renders a scene with and without viewers in turns, and prints the CPU seconds of
pbrt of each (the smallest of the rounds) and their ratio. The viewers are a stand-in for tev that reads everything, and a
client of the live page that sends requests as often as the page does.

    tests/bench/live_view.py --pbrt build/release/src/pbrt/cmd/pbrt/pbrt scenes/three-lights/three-lights.pbrt --spp 32
"""
import argparse
import json
import os
import re
import resource
import socket
import subprocess
import tempfile
import threading
import time
import urllib.request


def cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def swallow(listener, counts):
    """Reads all that is sent, and counts the pictures: packets of red that begin a picture are not told apart, so bytes."""
    while True:
        try:
            connection = listener.accept()[0]
        except OSError:
            return
        while data := connection.recv(1 << 20):
            counts["bytes"] += len(data)
        connection.close()


def watch(address, counts):
    version = 0
    while True:
        try:
            with urllib.request.urlopen(address + "status", timeout=5) as answer:
                status = json.load(answer)
            if status["version"] > version:
                with urllib.request.urlopen(address + "picture", timeout=20) as answer:
                    answer.read()
                version = status["version"]
                counts["pictures"] += 1
        except OSError:
            return
        time.sleep(0.5)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pbrt", required=True)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("scene")
    options = parser.parse_args()
    listener = socket.create_server(("127.0.0.1", 0))
    counts = {"bytes": 0, "pictures": 0}
    threading.Thread(target=swallow, args=(listener, counts), daemon=True).start()
    viewers = ["--display-server", f"127.0.0.1:{listener.getsockname()[1]}", "--serve=0"]
    times = {"alone": [], "watched": []}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(options.rounds):
            for name in times:
                before = cpu_of_children()
                process = subprocess.Popen([options.pbrt, "--spp", str(options.spp), "--outfile",
                                            os.path.join(folder, "p.exr"), *(viewers if name == "watched" else []),
                                            options.scene], stderr=subprocess.PIPE, text=True)
                for line in process.stderr:
                    if found := re.match(r"Live page: (\S+)", line):
                        threading.Thread(target=watch, args=(found[1], counts), daemon=True).start()
                process.wait()
                times[name].append(cpu_of_children() - before)
    pairs = sorted(w / a for a, w in zip(times["alone"], times["watched"]))
    alone, watched = min(times["alone"]), min(times["watched"])
    print(f"{options.scene}: alone {alone:.2f} s, watched {watched:.2f} s, ratio {watched / alone:.4f}, median of pairs "
          f"{pairs[len(pairs) // 2]:.4f}; {counts['pictures'] / options.rounds:.1f} pictures and "
          f"{counts['bytes'] / options.rounds / 1e6:.1f} MB a render")


if __name__ == "__main__":
    main()
