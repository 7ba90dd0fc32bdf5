#!/usr/bin/env bash
# Renders the dollhouse scene with pbrt's default light sampler bvh, with octree and with octree+guide at equal samples
# per pixel; writes the three images, one image of all beside the reference, and their errors. Installs packages and
# builds first if needed.
#   scenes/demo.sh [samples per pixel (16)]
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
spp=${1:-16}
out="$top/build/demo"
scene="$top/scenes/dollhouse/dollhouse.pbrt"

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
pbrt="$build/src/pbrt/cmd/pbrt/pbrt"
imgtool="$build/src/pbrt/cmd/imgtool/imgtool"
mkdir -p "$out"

render() { # render NAME ARGUMENTS...
  local name=$1
  shift
  "$pbrt" --outfile "$out/$name.exr" "$@" "$scene"
  "$imgtool" convert --outfile "$out/$name.png" "$out/$name.exr"
}
# The reference is rendered by stock pbrt's default sampler with its own seed, once.
if [ ! -f "$out/reference.exr" ] || [ "$scene" -nt "$out/reference.exr" ] || [ "$pbrt" -nt "$out/reference.exr" ]; then
  echo "Rendering the reference (bvh, 256 samples per pixel)"
  render reference --lightsampler bvh --spp 256 --seed 1000
fi
samplers="bvh octree octree+guide"
for sampler in $samplers; do
  echo "Rendering with $sampler, $spp samples per pixel"
  render "$sampler" --lightsampler "$sampler" --spp "$spp"
done
strips=()
for sampler in $samplers reference; do strips+=("$out/$sampler.exr"); done
"$imgtool" splitn "${strips[@]}" --outfile "$out/compare.png"

error() { # relL2 of image NAME against the reference; imgtool diff exits with 1 where images differ
  { "$imgtool" diff --json --metric relL2 --reference "$out/reference.exr" "$out/$1.exr" || true; } |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["error"])'
}
echo
echo "relL2 at $spp samples per pixel, $(basename "$scene"):"
bvh=$(error bvh)
for sampler in $samplers; do
  python3 -c "e = $(error "$sampler"); print(f'  {\"$sampler\":13} {e:.3g}   {$bvh / e:.1f} times less than bvh')"
done
echo "All three beside the reference: $out/compare.png"
echo
echo "With a scene of yours:"
echo "  $pbrt --lightsampler octree+guide --outfile octree.exr scene.pbrt"
echo "  $imgtool convert octree.exr octree.png"
echo "or compare light samplers at equal time (builds the rest first, some minutes):"
echo "  bash .ci/build $top/build/release -DPBRT_TESTS=OFF -DPBRT_BENCH=OFF && build/release/src/pbrt/cmd/lightlab/lightlab scene.pbrt --time 20"
