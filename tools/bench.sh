#!/usr/bin/env bash
# Builds and runs the benchmarks (tests/bench/README.md has their figures). Further options go to them, e.g.
# tools/bench.sh --benchmark_filter=Kernel
# --scaling: how the host's work grows, in their place (tools/scaling.sh).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh tests
tools/build.sh release
if [[ ${1:-} == --scaling ]]; then exec tools/scaling.sh; fi
found=no
for program in build/release/tests/bench/*; do
  [[ -f $program && -x $program ]] || continue
  found=yes
  echo "bench: $(basename "$program")"
  "$program" "$@"
done
if [[ $found == no ]]; then
  echo "bench: no benchmark programs in build/release/tests/bench" >&2
  exit 1
fi
