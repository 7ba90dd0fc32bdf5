#!/usr/bin/env python3
"""Every scene of ours is what its script makes, and renders without a word: check_scenes.py PBRT"""
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parent.parent.parent / "scenes"
pbrt = sys.argv[1]
problems, checked = [], 0
for script in sorted(root.glob("*/make.py")):
    checked += 1
    made = subprocess.run([sys.executable, "-B", str(script), "--check"], capture_output=True, text=True)
    if made.returncode != 0:
        problems.append(f"{script}: the scene is not what the script makes\n{made.stdout}{made.stderr}")
with tempfile.TemporaryDirectory() as folder:
    for scene in sorted(root.glob("*/*.pbrt")):
        checked += 1
        out = pathlib.Path(folder) / "picture.exr"
        run = subprocess.run([pbrt, "--quick", "--spp", "2", "--outfile", str(out), str(scene)], capture_output=True, text=True)
        if run.returncode != 0 or not out.exists():
            problems.append(f"{scene}: status {run.returncode}\n{run.stderr}")
        elif "Warning" in run.stderr or "warning" in run.stderr:
            problems.append(f"{scene}: warns\n{run.stderr}")
print("\n".join(problems))
print(f"{checked} checks, {len(problems)} problems")
sys.exit(1 if problems or checked < 25 else 0)
