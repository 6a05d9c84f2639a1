#!/usr/bin/env bash
# From a fresh clone to results: installs what the program needs, builds it, and shows what it does.
#   LEVIOSIM_WASM=ON tools/demo.sh     with the engine of interactive pages: 10 s and 85 CPU-seconds more
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh ${LEVIOSIM_WASM:+pages}
tools/build.sh release leviosim
echo "demo: for the commands that it names: export PATH=\$PWD/build/release:\$PATH"
build/release/leviosim demo --out out/demo --force
