#!/usr/bin/env bash
# From a fresh clone to results: installs what is missing, builds, and runs LEVIO on GAP9 over a
# synthetic flight.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
echo "demo: building"
tools/build.sh release leviosim
echo "demo: leviosim run --platform gap9 --data synthetic --out out/demo"
mkdir -p out
build/release/leviosim run --platform gap9 --data synthetic --out out/demo --force
echo
echo "demo: tables above, files in out/demo/ (stats.json, stages.csv, frames.csv, memory.csv, trajectory.tum)"
