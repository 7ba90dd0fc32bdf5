#!/usr/bin/env python3
"""Checks every #include under src/ against .ci/layers (docs/develop/architecture.md): a file may include its own folder and
folders of lower rank; extensions up to the rank named there; src/pbrt never names ext; third-party libraries stay
behind their door. Prints each violation and a closing count."""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
ranks = {}
for line in (root / ".ci/layers").read_text().splitlines():
    words = line.split("#")[0].split()
    if len(words) == 2:
        ranks[words[1]] = words[0]
DOORS = [(re.compile(r"^(embree|rtcore)"), {"pbrt/accel"}),
         (re.compile(r"^(OpenEXR|Imath)/|^Im[a-z]+\.h"), {"pbrt/images"}),
         (re.compile(r"^OpenImageIO/"), {"pbrt/images/oiio_module.cpp"}),  # loaded when it is needed
         (re.compile(r"^tbb/|^oneapi/"), {"pbrt/core"}),
         (re.compile(r"^glm/"), {"pbrt/math"}),
         (re.compile(r"^opensubdiv/"), {"pbrt/shapes"}),
         (re.compile(r"^CLI/"), {"pbrt/cmd", "ext/lab"})]


def folder_of(path):
    return "/".join(path.split("/")[:2])


def allowed(source, target):
    if source == target:
        return True
    a, b = ranks[source], ranks[target]
    if a.isdigit():
        return b.isdigit() and int(b) < int(a)
    if b.isdigit():
        return int(b) <= int(a[1:])
    return not b.isdigit() and b[0] < a[0]


problems = []
checked = 0
for file in sorted((root / "src").rglob("*")):
    if file.suffix not in (".h", ".cpp"):
        continue
    relative = file.relative_to(root / "src").as_posix()
    source = folder_of(relative)
    if source not in ranks:
        problems.append(f"src/{relative}: folder {source} has no rank in .ci/layers")
        continue
    for number, line in enumerate(file.read_text().splitlines(), 1):
        if source.startswith("pbrt/") and re.search(r"\bext(::|/)", line):
            problems.append(f"src/{relative}:{number}: src/pbrt names ext")
        match = re.match(r'\s*#\s*include\s*["<]([^">]+)[">]', line)
        if not match:
            continue
        checked += 1
        include = match.group(1)
        if include.startswith(("pbrt/", "ext/")):
            target = folder_of(include)
            if target not in ranks or not allowed(source, target):
                problems.append(f"src/{relative}:{number}: {source} ({ranks[source]}) may not include {target} ({ranks.get(target)})")
        for pattern, doors in DOORS:
            if pattern.search(include) and source not in doors and relative not in doors:
                problems.append(f"src/{relative}:{number}: <{include}> belongs behind {', '.join(sorted(doors))}")
print("\n".join(problems))
print(f"layers: {checked} includes checked, {len(problems)} violations")
sys.exit(1 if problems or checked == 0 else 0)
