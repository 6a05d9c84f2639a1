#!/usr/bin/env bash
# A sweep as a Slurm array, one share of the points per task:
#
#   sbatch --array=1-16 tools/app/study/sweep/examples/slurm_array.sh PLAN.yaml OUT
#   leviosim sweep --merge OUT/all OUT/shard-*        # when all tasks are done
#
# A task that is requeued goes on where it was. PLAN and OUT lie where all nodes see them; the
# program is $LEVIOSIM, or leviosim in the PATH.
#SBATCH --job-name=leviosim-sweep
#SBATCH --cpus-per-task=2
#SBATCH --requeue
set -euo pipefail

plan=${1:?usage: sbatch --array=1-N slurm_array.sh PLAN.yaml OUT}
out=${2:?usage: sbatch --array=1-N slurm_array.sh PLAN.yaml OUT}
task=${SLURM_ARRAY_TASK_ID:?is set by sbatch --array=1-N}
tasks=${SLURM_ARRAY_TASK_COUNT:?is set by sbatch --array=1-N}

"${LEVIOSIM:-leviosim}" sweep "$plan" --shard "$task/$tasks" --out "$out/shard-$task" \
  --cache "$out/cache" --jobs "${SLURM_CPUS_PER_TASK:-1}" --quiet || (($? == 1)) # 1: points failed
