#!/usr/bin/env bash
# From a fresh clone to results: installs what the program needs, builds it, and shows what it does.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
tools/build.sh release leviosim
echo "demo: for the commands that it names: export PATH=\$PWD/build/release:\$PATH"
build/release/leviosim demo --out out/demo --force
