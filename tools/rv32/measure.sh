#!/usr/bin/env bash
# Compiles the workload for RV32, traces it under QEMU, and writes the tables that the repository
# keeps: platform_models/code/rv32imfc.csv and the tables of this folder. See README.md.
# usage: tools/rv32/measure.sh [ASL folder to take frames from; the synthetic flight by default]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root=$(cd ../.. && pwd)
out=$root/build/rv32
mkdir -p "$out"

for tool in riscv64-unknown-elf-g++ qemu-riscv32 python3; do
  command -v "$tool" >/dev/null || {
    echo "measure.sh: $tool is missing; apt-get install gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf qemu-user python3" >&2
    exit 1
  }
done

"$root"/tools/build.sh release leviosim leviosim_rv32_inputs >/dev/null
flight=${1:-$out/flight}
if [[ $# -eq 0 && ! -d $flight ]]; then
  "$root"/build/release/leviosim synth --out "$flight" --seed 1 --duration 20 --quiet
fi
"$root"/build/release/tests/leviosim_rv32_inputs "$flight" "$out/inputs.new"
# Only a change of the inputs makes the programs out of date.
cmp -s "$out/inputs.new" "$out/inputs.bin" || cp "$out/inputs.new" "$out/inputs.bin"
# Bytes in front of all code: where a function lies changes which lines of 16 bytes it covers.
layouts=(0 4 8 12)
make --no-print-directory -j"$(nproc)" OUT="$out" LAYOUTS="${layouts[*]}"

trace() {  # NAME: runs the program NAME of $out and leaves $out/NAME.tsv
  qemu-riscv32 -plugin "$out/trace.so,program=$out/$1,out=$out/$1.tsv" "$out/$1" 2>"$out/$1.log"
}
trace library_soft
trace library_hard
# One core is busy with the layouts while the other does the rest.
(for layout in "${layouts[@]}"; do trace "scenes_at_$layout"; done) &
contracted=$!
trace scenes_uncontracted
"$out/counts" "$out/inputs.bin" >"$out/counted.tsv" 2>"$out/counted.log"
wait "$contracted"
# Without contraction RV32 computes the bits that the host computes.
cmp "$out/counted.log" "$out/scenes_uncontracted.log"

python3 report.py --work "$out" --code "$root/platform_models/code/rv32imfc.csv" --here . --layouts "${layouts[@]}"
