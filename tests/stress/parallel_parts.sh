#!/usr/bin/env bash
# Runs docs/guide/many-machines/parallel.sh, breaks it off, runs it again, and compares the picture with that of one render.
#   tests/stress/parallel_parts.sh PBRT IMGTOOL LIGHTSAMPLER
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
export PBRT=$1 IMGTOOL=$2 JOBS=2
sampler=$3
command -v parallel > /dev/null || { echo "SKIPPED: GNU parallel is not installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export PARALLEL_HOME=$folder  # else it writes into the home folder
{
  echo 'LookAt 0 3 -5  0 0 0  0 1 0
Camera "perspective"
Film "gbuffer" "integer xresolution" 60 "integer yresolution" 40
Integrator "path" "integer maxdepth" 3
WorldBegin'
  for ((i = 0; i < 80; ++i)); do
    echo "LightSource \"point\" \"point3 from\" [ $((i % 10 - 5)) 1 $((i / 10 - 4)) ] \"rgb I\" [ 1 $((i % 3)) 1 ]"
  done
  echo 'Shape "bilinearmesh" "point3 P" [ -6 0 -6  6 0 -6  -6 0 6  6 0 6 ]
Shape "bilinearmesh" "point3 P" [ 0 0 -6  0 0 6  0 2 -6  0 2 6 ]'
} > scene.pbrt

bash "$top/docs/guide/many-machines/parallel.sh" scene.pbrt out.exr 23 5 --lightsampler "$sampler"
lights=()
[ -f out.exr.parts/lights ] && lights=(--load-lights out.exr.parts/lights)
"$PBRT" --quiet --spp 23 --lightsampler "$sampler" "${lights[@]}" --outfile whole.exr scene.pbrt
# One part is lost, and made again.
rm out.exr out.exr.parts/9:13.chk
! "$IMGTOOL" merge out.exr out.exr.parts/*.chk 2> refused.txt
grep -q "The samples 9:13 are in no file" refused.txt
bash "$top/docs/guide/many-machines/parallel.sh" scene.pbrt out.exr 23 5 --lightsampler "$sampler"
for channels in R,G,B Variance.R,Variance.G,Variance.B; do
  for picture in out whole; do "$IMGTOOL" convert --channels $channels $picture.exr --outfile $picture.pfm; done
  cmp out.pfm whole.pfm
done
echo "the same bits"
