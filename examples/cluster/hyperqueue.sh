#!/bin/bash
# HyperQueue: many small parts on whatever workers there are.
#
#     hq submit --array 1-256 --cpus 4 --wait hyperqueue.sh
#     hydrapod montecarlo study.toml --results run.h5 --shard 256 --join
#
# A part that was killed goes on when HyperQueue starts it again: --resume.
set -euo pipefail
parts=${PARTS:-256}
exec "${HYDRAPOD:-hydrapod}" montecarlo "${STUDY:-study.toml}" --results "${RESULTS:-run.h5}" \
  --shard "${HQ_TASK_ID:?}/$parts" --threads "${HQ_CPUS_COUNT:-4}" --resume
