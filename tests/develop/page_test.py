#!/usr/bin/env python3
"""The code on docs/develop/adding-a-light-sampler.md is the code that the tests compile."""
import pathlib
import sys

here = pathlib.Path(__file__).resolve().parent
page = (here.parent.parent / "docs/develop/adding-a-light-sampler.md").read_text()
missing = [f.name for f in sorted((here / "nearest").iterdir()) if f"```cpp\n{f.read_text().rstrip()}\n```" not in page]
for name in missing:
    print(f"docs/develop/adding-a-light-sampler.md does not hold tests/develop/nearest/{name} as it is")
sys.exit(1 if missing else 0)
