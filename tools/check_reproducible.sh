#!/usr/bin/env bash
# Same inputs, same bytes: runs leviosim twice as built by GCC, once as built by Clang and once
# without optimisation, and compares what the runs leave behind byte by byte. Exit status 1 if
# anything differs.
#   tools/check_reproducible.sh [--data DIR] [--frames A:B] [--quick]
# --quick: frames 0:30. Default: all frames of the synthetic flight.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

data=synthetic
frames=()
while (($# > 0)); do
  case $1 in
    --data) data=${2:?--data needs a folder} && shift 2 ;;
    --frames) frames=(--frames "${2:?--frames needs A:B}") && shift 2 ;;
    --quick) frames=(--frames 0:30) && shift ;;
    *)
      echo "check_reproducible: unknown option $1; expected --data, --frames or --quick" >&2
      exit 2
      ;;
  esac
done

runs=$(mktemp -d)
trap 'rm -rf "$runs"' EXIT

run() { # run NAME PRESET
  echo "check_reproducible: $1"
  tools/build.sh "$2" leviosim
  "build/$2/leviosim" run --platform gap9 --data "$data" "${frames[@]}" --quiet \
    --out "$runs/$1" >/dev/null
}
run gcc-release release
run gcc-release-again release
run clang-release clang
run gcc-debug dev

# All but manifest.json, which holds the command line and the host's time.
status=0
printf '%-20s %-18s %s\n' file run sha256
for file in stats.json trajectory.tum stages.csv frames.csv memory.csv platform.yaml; do
  for folder in "$runs"/*/; do
    name=$(basename "$folder")
    verdict=""
    if ! cmp -s "$runs/gcc-release/$file" "$folder/$file"; then
      verdict="  DIFFERS from gcc-release"
      status=1
    fi
    printf '%-20s %-18s %s%s\n' "$file" "$name" "$(sha256sum <"$folder/$file" | cut -c1-64)" "$verdict"
  done
done
if ((status == 0)); then
  echo "check_reproducible: all files are the same, byte by byte"
else
  echo "check_reproducible: FILES DIFFER" >&2
fi
exit $status
