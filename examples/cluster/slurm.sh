#!/bin/bash
# One image on four machines of a Slurm cluster, one rank each, which uses all devices of its machine:
#   sbatch examples/cluster/slurm.sh
# The scene is read by rank 0 only. If the job ends early, submit it again: it continues from the checkpoint.
#SBATCH --job-name=claray
#SBATCH --nodes=4
#SBATCH --ntasks-per-node=1
#SBATCH --exclusive
#SBATCH --time=02:00:00
#SBATCH --signal=B:TERM@60
set -euo pipefail
scene=${1:-scene.glb} image=${2:-image.exr} checkpoint=${3:-image.ckpt}
resume=()
[[ ! -f $checkpoint ]] || resume=(--resume "$checkpoint")
# Rank 0 writes image and checkpoint within a second of SIGTERM, or in this time.
export OMPI_MCA_odls_base_sigkill_timeout=30
exec mpirun claray render "$scene" -o "$image" --device all --size 3840x2160 --spp 4096 \
    --checkpoint "$checkpoint" --checkpoint-every 1min "${resume[@]}"
