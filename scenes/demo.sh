#!/usr/bin/env bash
# Renders our dollhouse scene with the uniform and the octree light sampler at equal samples per pixel; writes both
# pictures, a difference picture and the two errors. Installs packages and builds first if needed.
#   scenes/demo.sh [samples per pixel (16)]
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
spp=${1:-16}
out="$top/build/demo"
scene="$top/scenes/dollhouse/dollhouse.pbrt"

bash "$top/.ci/install"
# Where everything is built already, that is used; else only the two programs are compiled, which is quicker.
build="$top/build/release"
if [ -x "$build/src/ext/lab/lightlab/lightlab" ]; then
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
for sampler in uniform octree; do
  echo "Rendering with $sampler, $spp samples per pixel"
  render "$sampler" --lightsampler "$sampler" --spp "$spp"
done

error() { # relL2 of NAME against the reference; imgtool diff says so and returns 1
  "$imgtool" diff --metric relL2 --reference "$out/reference.exr" "$@" 2>&1 || true
}
error --outfile "$out/error-uniform.exr" "$out/uniform.exr" > "$out/uniform.txt"
error --outfile "$out/error-octree.exr" "$out/octree.exr" > "$out/octree.txt"
"$imgtool" diff --metric MAE --reference "$out/uniform.exr" --outfile "$out/difference.exr" "$out/octree.exr" > /dev/null 2>&1 || true
"$imgtool" falsecolor --maxvalue 0.5 --outfile "$out/difference.png" "$out/difference.exr" > /dev/null
value() { grep -oE "relL2[^0-9]*[0-9.e+-]+" "$1" | grep -oE "[0-9.][0-9.e+-]*$" | tail -1; }
u=$(value "$out/uniform.txt")
o=$(value "$out/octree.txt")
echo
echo "relL2 error at $spp samples per pixel, $(basename "$scene"):"
echo "  uniform  $u    $out/uniform.png"
echo "  octree   $o    $out/octree.png"
python3 -c "print(f'  octree has {float(\"$u\")/float(\"$o\"):.1f} times less error')"
echo "  difference of the two: $out/difference.png (false colour), reference: $out/reference.png"
echo
echo "With a scene of yours:"
echo "  $pbrt --lightsampler octree --outfile octree.exr scene.pbrt"
echo "  $imgtool diff --metric relL2 --reference reference.exr octree.exr"
echo "or let lightlab compare six light samplers on it (builds the rest first, some minutes):"
echo "  bash .ci/build $top/build/release && build/release/src/pbrt/cmd/lightlab/lightlab scene.pbrt --time 20"
