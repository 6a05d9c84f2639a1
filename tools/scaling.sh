#!/usr/bin/env bash
# Prints how the host's work grows: exponents over frames, points of a sweep, and cores. 1: twice as much takes twice as long; 0: it costs nothing more.
#   tools/scaling.sh [--program FILE]   FILE: leviosim [build/release/leviosim]
# Each is log2 of (t(4n) - t(2n)) / (t(2n) - t(n)), CPU seconds, the least of three: what all sizes take alike, such as
# the start, drops out. Run it on a machine that does nothing else; a few minutes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=build/release/leviosim
if (($# > 0)); then
  [[ $1 == --program && $# == 2 ]] || { echo "scaling: unknown option $1; expected --program FILE" >&2; exit 2; }
  program=$2
fi
program=$(realpath "$program")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

seconds() { # ARGUMENTS...: CPU seconds of the program, the least of three
  local times=() i
  for i in 1 2 3; do
    times+=("$({ TIMEFORMAT='%U %S'; time "$program" "$@" >output 2>log || { cat log output >&2; exit 2; }; } 2>&1)")
  done
  printf '%s\n' "${times[@]}" | awk '{ t = $1 + $2; if (NR == 1 || t < least) least = t } END { print least }'
}
exponent() { # NAME N FUNCTION: calls FUNCTION with N, 2 N, 4 N for the arguments of the program
  local name=$1 n=$2 arguments_of=$3 times=() factor
  for factor in 1 2 4; do
    read -ra words <<<"$("$arguments_of" $((n * factor)))"
    times+=("$(seconds "${words[@]}")")
  done
  awk -v name="$name" -v n="$n" -v a="${times[0]}" -v b="${times[1]}" -v c="${times[2]}" 'BEGIN {
    growth = b > a && c > b ? sprintf("%.2f", log((c - b) / (b - a)) / log(2)) : "too little to say"
    printf "scaling: %-34s %5d, %d, %d: %6.2f, %.2f, %.2f s   exponent %s\n", name, n, 2 * n, 4 * n, a, b, c, growth
  }'
}

"$program" synth --out flight --duration 60 --quiet >/dev/null
for frames in 300 600 1200; do
  for profile in levio next; do
    "$program" run --data flight --frames "0:$frames" --profile "$profile" --record --out "$profile-$frames" --quiet \
      >/dev/null
  done
done
for points in 20 40 80; do
  cat >"points-$points.yaml" <<PLAN
base: { trace: next-300 }
points:
  - grid: { platform.cluster.dma.first_data: { from: 1, to: $points, step: 1 } }
PLAN
done

native() { echo "run --native --data flight --frames 0:$1 --profile next --out a --force --quiet"; }
run_of() { echo "run --data flight --frames 0:$1 --profile next --out b --force --quiet"; }
replay_of() { echo "replay next-$1 --out c --force --quiet"; }
replay_levio() { echo "replay levio-$1 --out c --force --quiet"; }
sweep_of() { echo "sweep points-$1.yaml --out sweep-$1-$RANDOM --jobs 1 --quiet"; }
cores_of() { echo "run --data flight --frames 0:150 --profile levio --cores $1 --out d --force --quiet"; }
exponent "frames, native run" 300 native
exponent "frames, run" 300 run_of
exponent "frames, replay of next" 300 replay_of
exponent "frames, replay of levio" 300 replay_levio
exponent "points of a sweep of a trace" 20 sweep_of
exponent "cores, run of levio" 2 cores_of
