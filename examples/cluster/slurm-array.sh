#!/bin/bash
# Slurm without MPI: 64 parts of one study, each with the threads of its task; then one job joins them.
#
#     parts=$(sbatch --parsable slurm-array.sh)
#     sbatch --dependency=afterok:$parts --array=1 --export=ALL,JOIN=1 slurm-array.sh
#
# A part that was killed (time limit, node) goes on with the same command: --resume.
#SBATCH --job-name=hydrapod
#SBATCH --array=1-64
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=16
#SBATCH --time=01:00:00
set -euo pipefail
parts=${PARTS:-64}
study=${STUDY:-study.toml}
results=${RESULTS:-run.h5}
hydrapod=${HYDRAPOD:-hydrapod}

if [[ -n ${JOIN:-} ]]; then
  exec "$hydrapod" montecarlo "$study" --results "$results" --shard "$parts" --join --no-mpi
fi
exec "$hydrapod" montecarlo "$study" --results "$results" --shard "${SLURM_ARRAY_TASK_ID:?}/$parts" \
  --threads "${SLURM_CPUS_PER_TASK:-1}" --resume --no-mpi
