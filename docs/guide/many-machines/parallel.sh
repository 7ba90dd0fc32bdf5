#!/usr/bin/env bash
# Renders one picture as parts, several at a time, with GNU parallel, and merges them.
#   docs/guide/many-machines/parallel.sh SCENE OUT.exr SAMPLES PARTS [flags of pbrt ...]
# PBRT, IMGTOOL: the programs. JOBS: parts at a time (1 for each thread of this machine). LOGINS: a comma-separated list of
# machines for parallel --sshlogin, which see this folder under the same path. Started again after a crash or power cut,
# it renders only what is missing.
set -euo pipefail
scene=$1 out=$2 samples=$3 parts=$4
shift 4
pbrt=${PBRT:-build/release/src/pbrt/cmd/pbrt/pbrt}
imgtool=${IMGTOOL:-build/release/src/pbrt/cmd/imgtool/imgtool}
folder=$out.parts
mkdir -p "$folder"

# A light sampler that learns is trained once, in a small picture; bvh and others learn nothing and need no file.
lights=()
case " $* " in
*" octree"*)
  [ -f "$folder/lights" ] ||
    "$pbrt" --quiet --quick --spp 64 --save-lights "$folder/lights" --outfile "$folder/training.exr" "$@" "$scene"
  lights=(--load-lights "$folder/lights")
  ;;
esac

# Part k has the samples from k SAMPLES / PARTS up to (k + 1) SAMPLES / PARTS - 1. A finished part returns at once.
for ((k = 0; k < parts; ++k)); do echo "$((k * samples / parts)):$(((k + 1) * samples / parts))"; done |
  parallel --quote --halt now,fail=1 --jobs "${JOBS:-$(nproc)}" ${LOGINS:+--sshlogin "$LOGINS" --workdir .} \
    "$pbrt" --quiet --nthreads 1 --spp "$samples" --samples {} --checkpoint "$folder/{}.chk" --resume "${lights[@]}" "$@" "$scene"
"$imgtool" merge "$out" "$folder"/*.chk
