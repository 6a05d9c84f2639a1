#!/usr/bin/env bash
# Same inputs, same bytes: lets leviosim as built by GCC (run twice), by Clang, and without
# optimisation make a short synthetic flight and run over one and the same data, and compares what
# they leave behind byte by byte. Exit status 1 if anything differs.
#   tools/check_reproducible.sh [--data DIR] [--frames A:B] [--quick]
# --quick: frames 0:40, and one build, by Clang without optimisation, that differs from the release
# in both. Default: all frames of the synthetic flight.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

data=synthetic
frames=()
others=(clang dev clang-dev)
while (($# > 0)); do
  case $1 in
    --data) data=${2:?--data needs a folder} && shift 2 ;;
    --frames) frames=(--frames "${2:?--frames needs A:B}") && shift 2 ;;
    --quick) frames=(--frames 0:40) others=(clang-dev) && shift ;;
    *)
      echo "check_reproducible: unknown option $1; expected --data, --frames or --quick" >&2
      exit 2
      ;;
  esac
done

results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT

run() { # run NAME PRESET
  echo "check_reproducible: $1"
  tools/build.sh "$2" leviosim
  "build/$2/leviosim" synth --duration 0.2 --quiet --out "$results/$1/flight" >/dev/null
  "build/$2/leviosim" run --platform gap9 --data "$data" "${frames[@]}" --record --quiet \
    --out "$results/$1/run" >/dev/null
  "build/$2/leviosim" run --platform gap9 -p cluster.clock=100MHz -p controller.clock=100MHz \
    --fps 15 --deadline drop --data "$data" "${frames[@]}" --quiet \
    --out "$results/$1/loop" >/dev/null
}
run release release
run release-again release
for preset in "${others[@]}"; do
  run "$preset" "$preset"
done

# Left out: manifest.json, which holds the command line and the host's time, and its digest.
mapfile -t files < <(cd "$results/release" && find . -type f ! -name manifest.json ! -name .leviosim-files | sort)
status=0
printf '%-20s %-6s %s\n' build files "sha256 of all of them"
for build in release release-again "${others[@]}"; do
  digest=$(cd "$results/$build" && cat "${files[@]}" | sha256sum | cut -c1-64)
  printf '%-20s %-6s %s\n' "$build" "${#files[@]}" "$digest"
done
for build in release-again "${others[@]}"; do
  for file in "${files[@]}"; do
    cmp "$results/release/$file" "$results/$build/$file" || status=1
  done
done
if ((status == 0)); then
  echo "check_reproducible: all files are the same, byte by byte"
else
  echo "check_reproducible: FILES DIFFER" >&2
fi
exit $status
