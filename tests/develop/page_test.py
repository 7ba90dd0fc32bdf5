#!/usr/bin/env python3
"""The code on the pages of docs/develop is the code that the tests compile."""
import pathlib
import sys

PAGES = {"adding-a-light-sampler.md": "nearest", "adding-an-integrator.md": "directlight"}
here = pathlib.Path(__file__).resolve().parent
missing = []
for name, folder in PAGES.items():
    page = (here.parent.parent / "docs/develop" / name).read_text()
    for file in sorted((here / folder).iterdir()):
        if f"```cpp\n{file.read_text().rstrip()}\n```" not in page:
            missing.append(f"docs/develop/{name} does not hold tests/develop/{folder}/{file.name} as it is")
print(*missing, sep="\n")
sys.exit(1 if missing else 0)
