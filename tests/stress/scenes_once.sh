#!/usr/bin/env bash
# Renders every conformance scene with one sample per pixel; those of the group "errors" are refused. Made for builds with
# sanitizers. Prints the scenes with reports, or with another status than that.
#   tests/stress/scenes_once.sh BUILD_FOLDER
set -uo pipefail
pbrt=$(cd "$1" && pwd)/src/pbrt/cmd/pbrt/pbrt
top=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
faults=0 scenes=0
for scene in "$top"/tests/conformance/suite/scenes/*/*.pbrt; do
  [[ $scene == */errors/* ]] && wanted=1 || wanted=0
  scenes=$((scenes + 1))
  "$pbrt" --quick --nthreads 2 --quiet --outfile "$folder/image.exr" "$scene" > "$folder/log.txt" 2>&1
  status=$?
  # A few files with questionable content render with a warning.
  [ $status -le $wanted ] && ! grep -qE "Sanitizer|runtime error" "$folder/log.txt" && continue
  faults=$((faults + 1))
  echo "status $status: $scene"
  tail -40 "$folder/log.txt"
done
echo "$scenes scenes, $faults with faults"
[ $faults -eq 0 ] && [ $scenes -gt 100 ]
