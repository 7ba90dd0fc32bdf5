#!/usr/bin/env bash
# Renders the dollhouse scene with pbrt's default light sampler bvh, with octree and with octree+guide at equal samples
# per pixel; prints their errors and times, and writes one labelled image of all beside the reference. Installs packages
# and builds first if needed; PBRT_BUILD names a build folder to use instead.
#   scenes/demo.sh [samples per pixel (16)]
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
spp=${1:-16}
out="$top/build/demo"
scene="$top/scenes/dollhouse/dollhouse.pbrt"

if [ -n "${PBRT_BUILD:-}" ]; then
  build=$(cd "$PBRT_BUILD" && pwd)
else
  bash "$top/.ci/install"
  # A complete build is used if there is one; else only the two programs are compiled, which is quicker.
  build="$top/build/release"
  if [ -x "$build/src/pbrt/cmd/lightlab/lightlab" ]; then
    options=()
  else
    build="$top/build/demo-programs"
    options=(-DPBRT_UNITY=ON -DPBRT_TESTS=OFF -DPBRT_BENCH=OFF)
  fi
  echo "Building (the first time: some minutes; log in ${build#"$top/"}.log)"
  # On a terminal the counter of ninja is shown beside it; the build itself is in the foreground, so that Ctrl-C ends it.
  watching=""
  if [ -t 1 ]; then
    while sleep 1; do printf '\r  %s  ' "$(grep -oE '^\[[0-9]+/[0-9]+\]' "$build.log" 2> /dev/null | tail -1)"; done &
    watching=$!
    trap 'kill "$watching" 2> /dev/null || true' EXIT
  fi
  bash "$top/.ci/build" "$build" "${options[@]+"${options[@]}"}" -- pbrt imgtool
  if [ -n "$watching" ]; then
    kill "$watching" 2> /dev/null || true
    printf '\r'
  fi
fi
pbrt="$build/src/pbrt/cmd/pbrt/pbrt"
imgtool="$build/src/pbrt/cmd/imgtool/imgtool"
mkdir -p "$out"

# 16 times the samples of the compared images, a seed of its own, made once. All samplers have the same mean; octree has
# less noise than bvh, so that the reference adds little to the errors.
reference="$out/reference-$((16 * spp)).exr"
if [ ! -f "$reference" ] || [ "$scene" -nt "$reference" ] || [ "$pbrt" -nt "$reference" ]; then
  echo "Rendering the reference (octree, $((16 * spp)) samples per pixel)"
  "$pbrt" --outfile "$reference" --lightsampler octree --spp $((16 * spp)) --seed 1000 "$scene"
fi
panels=()
for sampler in bvh octree octree+guide; do
  echo "Rendering with $sampler, $spp samples per pixel"
  "$pbrt" --outfile "$out/$sampler.exr" --lightsampler "$sampler" --spp "$spp" --stats=json "$scene" > "$out/$sampler.json"
  panels+=("$sampler=$out/$sampler.exr")
done
echo
echo "$(basename "$scene"), $spp samples per pixel:"
for sampler in bvh octree octree+guide; do
  # imgtool diff exits with 1 where images differ.
  { "$imgtool" diff --json --metric relL2 --reference "$reference" "$out/$sampler.exr" || true; } > "$out/$sampler-error.json"
done
python3 - "$out" << 'END'
import json, sys
def result(name):
    with open(f"{sys.argv[1]}/{name}-error.json") as errors, open(f"{sys.argv[1]}/{name}.json") as stats:
        return json.load(errors)["error"], json.load(stats)["seconds"]["total"]
bvh = result("bvh")
for name in ("bvh", "octree", "octree+guide"):
    error, seconds = result(name)
    than = f"; {bvh[0] / error:.1f} times less error than bvh, {bvh[0] * bvh[1] / (error * seconds):.1f} times at equal time"
    print(f"  {name:13} relL2 {error:.3g} in {seconds:.1f} s{than if name != 'bvh' else ''}")
END
/usr/bin/python3 "$top/docs/pictures/panels" --build "$build" --reference "$reference" --brightness 0.5 --out "$out/compare.png" "${panels[@]}"
echo "All three beside the reference, with enlarged crops: $out/compare.png"
echo
echo "With a scene of yours:"
echo "  $pbrt --lightsampler octree+guide --outfile octree.exr scene.pbrt"
echo "  $imgtool convert octree.exr octree.png"
echo "or compare light samplers at equal time (builds the rest first, some minutes):"
echo "  bash .ci/build $top/build/release -DPBRT_TESTS=OFF -DPBRT_BENCH=OFF && build/release/src/pbrt/cmd/lightlab/lightlab scene.pbrt --time 20"
