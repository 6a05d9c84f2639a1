#!/usr/bin/env bash
# Compiles the workload for RV32, RV32 with Xpulp, Thumb-2 and ARMv6, traces it under QEMU, and writes the tables that
# the repository keeps: platform_models/code/*.csv and the tables of this folder. See README.md.
# usage: tools/rv32/measure.sh [--only rv32imfc|rv32imfc_xpulp|thumb2|armv6] [ASL folder to take frames from]
#        tools/rv32/measure.sh --libraries
# --libraries: the routines of RV32's libraries only, a minute in the place of a quarter of an hour
# Without a folder, frames come from the synthetic flight.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
root=$(cd ../.. && pwd)
out=$root/build/rv32
mkdir -p "$out"

instruction_sets=(rv32imfc rv32imfc_xpulp thumb2 armv6)
libraries=false
if [[ ${1:-} == --libraries ]]; then
  libraries=true
  instruction_sets=(rv32imfc rv32imfc_xpulp)
elif [[ ${1:-} == --only ]]; then
  instruction_sets=("${2:?measure.sh: --only takes rv32imfc, rv32imfc_xpulp, thumb2 or armv6}")
  shift 2
fi
for tool in riscv64-unknown-elf-g++ arm-none-eabi-g++ qemu-riscv32 qemu-arm python3; do
  command -v "$tool" >/dev/null || {
    echo "measure.sh: $tool is missing; README.md says what to install" >&2
    exit 1
  }
done

# Bytes in front of all code: where a function lies changes which lines of 16 bytes it covers.
layouts=(0 4 8 12)

trace() {  # ISA WORK NAME: runs the program NAME of WORK and leaves WORK/NAME.tsv
  local qemu=(qemu-riscv32) plugin=$2/trace.so
  # QEMU 7.2 does not start Linux programs on its Cortex-M; a Cortex-A15 executes the same Thumb-2.
  [[ $1 == thumb2 ]] && qemu=(qemu-arm -cpu cortex-a15) plugin=$2/trace_arm.so
  [[ $1 == armv6 ]] && qemu=(qemu-arm -cpu arm1176) plugin=$2/trace_arm.so
  "${qemu[@]}" -plugin "$plugin,program=$2/$3,out=$2/$3.tsv" "$2/$3" 2>"$2/$3.log"
}

trace_libraries() {  # ISA WORK
  [[ $1 == rv32imfc ]] && trace "$1" "$2" library_soft
  for layout in "${layouts[@]}"; do trace "$1" "$2" "library_hard_at_$layout"; done
}

if $libraries; then
  for isa in "${instruction_sets[@]}"; do
    work=$out/libraries/$isa
    mkdir -p "$work"
    make --no-print-directory -j"$(nproc)" ISA="$isa" OUT="$work" INPUTS= LAYOUTS="${layouts[*]}" libraries
    trace_libraries "$isa" "$work"
    python3 report.py --isa "$isa" --work "$work" --root "$root" --layouts "${layouts[@]}"
  done
  exit
fi

"$root"/tools/build.sh release leviosim leviosim_rv32_inputs >/dev/null
flight=${1:-$out/flight}
if [[ $# -eq 0 && ! -d $flight ]]; then
  "$root"/build/release/leviosim synth --out "$flight" --seed 1 --duration 20 --quiet
fi
"$root"/build/release/tests/leviosim_rv32_inputs "$flight" "$out/inputs.new"
# Only a change of the inputs makes the programs out of date.
cmp -s "$out/inputs.new" "$out/inputs.bin" || cp "$out/inputs.new" "$out/inputs.bin"
make --no-print-directory -j"$(nproc)" OUT="$out" "$out/counts"
"$out/counts" "$out/inputs.bin" >"$out/counted.tsv" 2>"$out/counted.log"

measure() {  # ISA
  local work=$out
  [[ $1 == rv32imfc ]] || work=$out/$1
  mkdir -p "$work"
  make --no-print-directory -j"$(nproc)" ISA="$1" OUT="$work" INPUTS="$out/inputs.bin" \
    LAYOUTS="${layouts[*]}"
  trace_libraries "$1" "$work"
  # One core is busy with the layouts while the other does the rest.
  (for layout in "${layouts[@]}"; do trace "$1" "$work" "scenes_at_$layout"; done) &
  local contracted=$!
  trace "$1" "$work" scenes_uncontracted
  wait "$contracted"
  # Without contraction the target computes the bits that the host computes.
  cmp "$out/counted.log" "$work/scenes_uncontracted.log"
  python3 report.py --isa "$1" --work "$work" --counts "$out/counted.tsv" --root "$root" \
    --layouts "${layouts[@]}"
}

for isa in "${instruction_sets[@]}"; do measure "$isa"; done
