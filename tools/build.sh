#!/usr/bin/env bash
# Configures and builds a preset: tools/build.sh PRESET [TARGET...]; all targets if none is named. What
# the tools print goes to build/PRESET.log. A build of the program alone needs no packages of the tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tools/progress.sh

preset=${1:?usage: tools/build.sh PRESET [TARGET...]}
shift
log=build/$preset.log
mkdir -p build
options=()
# Once asked for, the engine of interactive pages is part of a build.
if [[ -n ${LEVIOSIM_WASM:-} ]]; then options+=("-DLEVIOSIM_WASM=$LEVIOSIM_WASM"); fi
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
if [[ $preset == python ]]; then
  options+=(-DLEVIOSIM_BUILD_TESTS=OFF -DLEVIOSIM_BUILD_BENCHMARKS=OFF)
elif [[ $* != leviosim ]]; then
  options+=(-DLEVIOSIM_BUILD_TESTS=ON)
elif ! grep -qs '^LEVIOSIM_BUILD_TESTS:.*=ON' "build/$preset/CMakeCache.txt"; then
  options+=(-DLEVIOSIM_BUILD_TESTS=OFF)
fi
[[ $preset != fuzz ]] || options+=(-DLEVIOSIM_BUILD_TESTS=OFF)
targets=()
if (($# > 0)); then targets=(--target "$@"); fi

fail() {
  grep -E -A 2 -m 10 '[Ee]rror[: ]' "$log" >&2 || tail -n 10 "$log" >&2
  echo "build: failed; all that was printed is in $log" >&2
  exit 1
}
started=$SECONDS
cmake --preset "$preset" "${options[@]}" >"$log" 2>&1 || fail
NINJA_STATUS='[%f/%t] ' cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}" 2>&1 |
  tee -a "$log" | sed -nu 's|^\[\([0-9]*\)/\([0-9]*\)\] .*|\1 \2|p' | progress "build: $preset" || fail
echo "build: $preset in $((SECONDS - started)) s"
