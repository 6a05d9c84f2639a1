#!/usr/bin/env bash
# Compiles the replay engine of interactive pages to WebAssembly, with Debian's clang. CMake calls it
# (option LEVIOSIM_WASM, preset wasm); packages: tools/setup.sh pages.
#   tools/wasm/build.sh OUTPUT.wasm     rooms are compiled side by side, each in one piece
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
output=$(realpath -m "$1")
work=$output.parts
mkdir -p "$work"
cd "$root"

# The sources of a room, without those that need files, threads, or libraries that the engine lacks.
declare -A pieces=(
  [sim]="$(echo sim/{work,events,energy,soc}/*.cpp)"
  [chip]="$(echo sim/chip/*.cpp)"
  [base]="sim/base/nearest_name.cpp sim/base/printable.cpp sim/base/text.cpp sim/base/yaml_node.cpp"
  [platform]="$(echo platform_models/loader/*.cpp)"
  [traces]="$(echo traces/work_traces/{memory_budget,section_file,work_columns,work_frames,work_trace}.cpp)"
  [run]="tools/app/run/trace_source.cpp tools/app/run/replay.cpp tools/app/run/simulate.cpp"
  [result]="$(echo tools/app/result/*.cpp)"
  [record]="tools/app/record/cycle_parts.cpp tools/app/record/statistics.cpp tools/app/record/statistic_list.cpp tools/app/table/json.cpp"
  [engine]="$(echo tools/wasm/*.cpp)"
)
# -O2 and one piece a room. Results must be those of the host: no contraction. Coroutines call each
# other's ends by tail calls (Chromium 112, Firefox 121).
flags=(--target=wasm32-wasi -std=c++20 -O2 -DNDEBUG -fexceptions -ffp-contract=off -mtail-call
  -ffunction-sections -fdata-sections -D_WASI_EMULATED_SIGNAL -DFMT_HEADER_ONLY
  -Wall -Wextra -Wno-unused-function -Wno-unused-const-variable -Wno-missing-field-initializers
  -isystem "$root/tools/wasm/headers" -isystem /usr/include/eigen3 "-I$root")
compile() { # compile NAME
  local source
  for source in ${pieces[$1]}; do echo "#include \"$root/$source\""; done >"$work/$1.cpp"
  ${LAUNCHER:-} "${CLANG:-clang++-14}" "${flags[@]}" -c "$work/$1.cpp" -o "$work/$1.o"
}
running=0
for name in "${!pieces[@]}"; do
  compile "$name" &
  if ((++running >= $(nproc))); then
    wait -n
    ((--running)) || true
  fi
done
while ((running > 0)); do
  wait -n
  ((--running)) || true
done
${CLANG:-clang++-14} --target=wasm32-wasi -O2 -mexec-model=reactor "$work"/*.o -o "$output.new" \
  -lwasi-emulated-signal -Wl,--gc-sections,--strip-all,--export=__stack_pointer,-z,stack-size=1048576
mv "$output.new" "$output"
