#!/usr/bin/env bash
# A sweep with GNU parallel, one share of the points per job, and the merge:
#
#   tools/app/study/sweep/examples/gnu_parallel.sh PLAN.yaml OUT SHARES [options of parallel...]
#   tools/app/study/sweep/examples/gnu_parallel.sh plan.yaml out 16 --sshloginfile hosts --workdir .
#
# Run again after an interruption, it goes on where it was. Beyond one machine, PLAN and OUT lie
# where all see them; the program is $LEVIOSIM, or leviosim in the PATH.
set -euo pipefail

usage="usage: gnu_parallel.sh PLAN.yaml OUT SHARES [options of parallel...]"
plan=${1:?$usage}
out=${2:?$usage}
shares=${3:?$usage}
shift 3
leviosim=${LEVIOSIM:-leviosim}

seq 1 "$shares" | parallel --halt now,fail=1 "$@" \
  "$leviosim" sweep "$plan" --shard "{}/$shares" --out "$out/shard-{}" --cache "$out/cache" \
  --jobs 1 --quiet ">" /dev/null "||" test '$?' = 1 # 1: points failed, as the table says

parts=()
for ((i = 1; i <= shares; ++i)); do parts+=("$out/shard-$i"); done
"$leviosim" sweep --merge "$out/all" "${parts[@]}"
