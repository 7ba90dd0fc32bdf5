#!/usr/bin/env bash
# One picture as a Slurm array of 16 tasks. Train the lights once, submit, and merge when all tasks have ended:
#   pbrt --lightsampler octree --quick --spp 64 --save-lights lights --outfile training.exr scene.pbrt
#   render=$(sbatch --parsable docs/guide/many-machines/slurm.sh scene.pbrt 1024 --lightsampler octree --load-lights lights)
#   sbatch --dependency=afterok:$render --wrap 'imgtool merge picture.exr part-*.chk'
#SBATCH --array=0-15
#SBATCH --cpus-per-task=8
#SBATCH --mem=16G
#SBATCH --time=04:00:00
#SBATCH --requeue
# Slurm sends SIGTERM before it kills a task whose time is over: the checkpoint is written, and the task that is started
# again goes on from it. Without a warning only the last minute is lost.
#SBATCH --signal=TERM@60
set -euo pipefail
scene=$1 samples=$2
shift 2
k=$SLURM_ARRAY_TASK_ID parts=$SLURM_ARRAY_TASK_COUNT
exec pbrt --quiet --nthreads "$SLURM_CPUS_PER_TASK" --memory-limit 15000 --spp "$samples" \
  --samples "$((k * samples / parts)):$(((k + 1) * samples / parts))" --checkpoint "part-$k.chk" --resume "$@" "$scene"
