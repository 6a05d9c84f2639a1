#!/usr/bin/env bash
# Configures and builds a preset: tools/build.sh PRESET [TARGET...]; all targets if none is named.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:?usage: tools/build.sh PRESET [TARGET...]}
shift
launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
targets=()
if (($# > 0)); then targets=(--target "$@"); fi

cmake --preset "$preset" "${launcher[@]}" >/dev/null
cmake --build --preset "$preset" --parallel "$(nproc)" "${targets[@]}"
