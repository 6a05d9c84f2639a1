#!/usr/bin/env bash
# Feeds broken input to every reader of user's files (tests/fuzz): builds the fuzz targets, makes
# their seeds, runs each for a while and shows a table. Exit status 0 if nothing was found, else 1
# with the path of the input that found something.
#   tools/fuzz.sh [--seconds N] [--light] [TARGET...]   N seconds for each target, 60 by default
# --light leaves out those that need most of the program, and take as long to build as all others.
# What a target learns stays in build/fuzz/corpus and serves the next time.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

all=(asl_tables budget evaluation film flight_plan history image json output_record overrides platform_yaml
  record rendered_table sensor_yaml sweep_points sweep_plan work_trace work_trace_content)
light=(asl_tables evaluation film image json output_record overrides platform_yaml rendered_table sensor_yaml
  work_trace work_trace_content)
seconds=60
targets=()
while (($# > 0)); do
  case $1 in
    --light)
      all=("${light[@]}")
      shift
      ;;
    --seconds)
      seconds=${2:-}
      if ! [[ $seconds =~ ^[1-9][0-9]*$ ]]; then
        echo "fuzz: --seconds '$seconds': expected a whole number above 0" >&2
        exit 2
      fi
      shift 2
      ;;
    *)
      if [[ " ${all[*]} " != *" $1 "* ]]; then
        echo "fuzz: unknown target '$1'; expected one of ${all[*]}" >&2
        exit 2
      fi
      targets+=("$1")
      shift
      ;;
  esac
done
((${#targets[@]} > 0)) || mapfile -t targets < <(printf '%s\n' "${all[@]}" | grep .)

build=build/fuzz
started=$SECONDS
tools/build.sh fuzz fuzz_seeds "${targets[@]/#/fuzz_}"
echo "fuzz: built in $((SECONDS - started)) s"
rm -rf "$build/seeds"
tests/fuzz/make_corpus.sh "$build/tests/fuzz/fuzz_seeds" "$build/seeds"

export ASAN_OPTIONS=quarantine_size_mb=16${ASAN_OPTIONS:+:$ASAN_OPTIONS}  # new pages take most of the time
# Seconds for one input and MB for the process: readers are bounded, so both are generous.
limits=(-timeout=10 -rss_limit_mb=1024 -malloc_limit_mb=512 -max_len=65536)
status=0
table=$(printf '%-20s %12s %12s  %s' target executions per-second found)
for target in "${targets[@]}"; do
  corpus=$build/corpus/$target
  found=$build/found/$target
  log=$build/$target.log
  mkdir -p "$corpus" "$found"
  echo "fuzz: $target for $seconds s"
  failed=0
  "$build/tests/fuzz/fuzz_$target" "$corpus" "$build/seeds/$target" "${limits[@]}" \
    -max_total_time="$seconds" -print_final_stats=1 -artifact_prefix="$found/" \
    >"$log" 2>&1 || failed=$?
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
  input=-
  if ((failed != 0)); then
    status=1
    input=$(sed -n 's/.*Test unit written to //p' "$log" | tail -n 1)
    input=${input:-"status $failed, see $log"}
    grep -m 1 -E 'ERROR:|runtime error:' "$log" | sed "s/^/fuzz: $target: /" || true
  fi
  table+=$'\n'$(printf '%-20s %12s %12s  %s' "$target" "${executions:--}" "${rate:--}" "$input")
done
echo "$table"
exit $status
