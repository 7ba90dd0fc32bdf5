#!/usr/bin/env bash
# Runs the programs once with every integrator and every kind of file that they write and read again. Made for builds with
# sanitizers, whose reports end a program with another status than 0. Prints each command that failed.
#   tests/stress/programs_once.sh BUILD_FOLDER
set -uo pipefail
programs=$(cd "$1" && pwd)/src/pbrt/cmd
pbrt=$programs/pbrt/pbrt imgtool=$programs/imgtool/imgtool lightlab=$programs/lightlab/lightlab
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
faults=0
run() { # run COMMAND...: must succeed
  "$@" > log.txt 2>&1
  local status=$?
  [ $status -eq 0 ] && return
  faults=$((faults + 1))
  echo "status $status: $*"
  tail -40 log.txt
}

{
  echo 'LookAt 0 2 -5  0 0 0  0 1 0
Camera "perspective"
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
Sampler "independent" "integer pixelsamples" 8
WorldBegin
LightSource "infinite" "rgb L" [ .1 .1 .2 ]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 3 2 1 ]
Translate -2 1 1
Shape "sphere" "float radius" .2
AttributeEnd'
  for ((i = 0; i < 40; ++i)); do
    echo "LightSource \"point\" \"point3 from\" [ $((i % 8 - 4)) 1 $((i / 8 - 2)) ] \"rgb I\" [ 1 $((i % 3)) 1 ]"
  done
  echo 'Material "coateddiffuse"
Shape "bilinearmesh" "point3 P" [ -6 0 -6  6 0 -6  -6 0 6  6 0 6 ]
Material "diffuse"
Shape "bilinearmesh" "point3 P" [ 0 0 -6  0 0 6  0 2 -6  0 2 6 ]'
} > scene.pbrt

for integrator in path volpath bdpt mlt sppm lightpath simplepath randomwalk ambientocclusion; do
  run "$pbrt" --integrator $integrator --spp 8 --nthreads 2 --outfile $integrator.exr scene.pbrt
done
for sampler in uniform power bvh exhaustive spatial neepp oracle:samples=2 octree:model=paper octree:portals=always; do
  run "$pbrt" --lightsampler $sampler --nthreads 2 --spp 2 --outfile sampler.exr scene.pbrt
done
run "$pbrt" --integrator bdpt --shooting-sampler seen --nthreads 2 --spp 2 --outfile seen.exr scene.pbrt
learning=(--lightsampler octree+guide --nthreads 2)
run "$pbrt" "${learning[@]}" --aov albedo,normal --stats=json --outfile whole.exr scene.pbrt
run "$pbrt" "${learning[@]}" --spp 4 --checkpoint half.chk --outfile half.exr scene.pbrt
run "$pbrt" "${learning[@]}" --spp 4 --save-lights lights --outfile saved.exr scene.pbrt
run "$pbrt" "${learning[@]}" --adaptive --aov samples --checkpoint adaptive.chk --outfile adaptive.exr scene.pbrt
run "$pbrt" "${learning[@]}" --noise 0.3 --spp 32 --checkpoint noise.chk --outfile noise.exr scene.pbrt
run "$pbrt" "${learning[@]}" --noise 0.1 --spp 32 --checkpoint noise.chk --resume --outfile noise.exr scene.pbrt
for samples in 0:4 4:8; do
  run "$pbrt" "${learning[@]}" --load-lights lights --samples $samples --checkpoint part-$samples.chk scene.pbrt
done
run "$imgtool" merge merged.exr part-0:4.chk part-4:8.chk
run "$imgtool" info merged.exr
run "$imgtool" convert --exposure 1 merged.exr --outfile merged.png
run "$imgtool" diff --metric FLIP --reference path.exr volpath.exr --outfile difference.png
run "$lightlab" scene.pbrt --samplers bvh,octree+guide --spp 4 --reference-spp 8 --seeds 2 --out lab --nthreads 2
run "$lightlab" inspect scene.pbrt --sampler octree --out inspected
[ $faults -eq 0 ]
