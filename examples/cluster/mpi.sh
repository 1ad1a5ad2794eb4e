#!/bin/bash
# Slurm with Open MPI: rank 0 hands out chunks, so that fast and slow nodes end together.
#
#     sbatch mpi.sh
#
# Where a rank or the job is killed, submit it again: --resume goes on, with any number of ranks. The folder
# of the results must be one that all nodes see.
#SBATCH --job-name=hydrapod
#SBATCH --ntasks=1000
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
set -euo pipefail
exec mpirun "${HYDRAPOD:-hydrapod}" montecarlo "${STUDY:-study.toml}" --results "${RESULTS:-run.h5}" --resume
