#!/usr/bin/env bash
# Builds leviosim and tests it. A summary ends it, what was printed is in build/test/, and the exit status
# is 0 only if all is well.
#   tools/test.sh           the program, its unit tests, a system test for each command, the pages
#   tools/test.sh --full    and all other tests, the same bytes from other compilers, fuzzing, guards: what CI
#                           calls
#   tools/test.sh --asan    all tests under address and undefined-behaviour sanitizers
#   tools/test.sh --tsan    tests of what runs in threads (sweeps, batches, drawing) under the
#                           thread sanitizer
#   tools/test.sh --clang   all tests, built by Clang
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

kind=${1:-}
case $kind in
  "" | --full) preset=release ;;
  --asan | --tsan | --clang) preset=${kind#--} ;;
  *)
    echo "test: unknown option $kind; expected --full, --asan, --tsan or --clang" >&2
    exit 2
    ;;
esac

# A test of each command that takes no minutes.
commands=(
  AblateCommand.ResumesAfterAKillAndComparesProfiles
  BenchmarkOfFewFrames.ListsItsPiecesWithoutDrawingThem
  Calibration.RecoversKnownConstants
  Check.AFirstBudgetIsMetByItsRunAndItsTrace
  'CommandLine.*'
  Compare.TextFitsEightyColumns
  EvalCommand.PrintsFiguresWithTheirProtocol
  FlowCommand.PrintsTheTablesOfAllWorkloadsAndItsOwn
  PrintoutTest.ARunFitsAScreenOf24LinesOf80Columns
  ReplayCommand.LeavesTheFolderOfTheRun
  ReplayCommand.TraceShowsAndChecks
  Report.OfAFolderIsThatOfTheRunItself
  StudyCommands.RunOnASyntheticFlight
  SweepCommand.HoldsEveryPointAgainstABudget
  TuneCommand.RefusesWhatCannotBe
  WorkloadCommand.ListsProfilesAndParameters
)
logs=build/test
mkdir -p "$logs"
summary=()
failed=0
check() { # check NAME COMMAND...: its output goes to a file, its end is shown where it fails
  local name=$1 log="$logs/$1.log" started=$SECONDS result=passed
  shift
  echo "test: $name"
  "$@" >"$log" 2>&1 || result=FAILED
  if [[ $result == FAILED ]]; then
    failed=1
    # What failed, first: the end of a log of many tests is a list of their names.
    grep -aE -m 20 -B 1 -A 6 ': Failure$|SUMMARY: |terminate called|not byte|differs' "$log" || true
    tail -n 40 "$log"
  fi
  summary+=("$(printf '%-16s %-6s %5d s  %s' "$name" "$result" $((SECONDS - started)) "$(counted "$log" "$result")")")
}
counted() { # counted LOG RESULT: how many tests, or where to look
  if [[ $2 == FAILED ]]; then
    echo "$1"
  else
    sed -n 's/^100% tests passed, 0 tests failed out of \([0-9]*\)$/\1 tests/p' "$1"
    awk '/^\[  PASSED  \]/ { sum += $4 } END { if (sum) print sum " tests" }' "$1"
  fi
}
# A process for each core; what a suite shares is made once in each.
command_tests() {
  local pids=() shards shard status=0
  shards=$(nproc)
  for ((shard = 0; shard < shards; ++shard)); do
    GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$shard "build/$preset/tests/leviosim_system_tests" \
      --gtest_filter="$(IFS=: && echo "${commands[*]}")" &
    pids+=("$!")
  done
  for pid in "${pids[@]}"; do wait "$pid" || status=1; done
  return "$status"
}
tests() { ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "$@"; }

if [[ $kind == "" ]]; then
  tools/setup.sh tests
  tools/build.sh release leviosim leviosim_{sim,workload,platform_models,traces,tools,system}_tests
else
  tools/setup.sh full
  if [[ $kind == --full ]]; then export LEVIOSIM_WASM=ON; fi  # pages that compute
  tools/build.sh "$preset"
fi
check pages tools/check_pages.sh
if [[ $preset == release ]]; then
  check unit tests --label-regex unit
  check commands command_tests
else
  check all-tests tests
fi
if [[ $kind == --full ]]; then
  check other-tests tests --label-exclude unit
  check fuzz tools/fuzz.sh --seconds 15 --light
  check guard tools/ci/guard.sh
  check host-work tools/ci/host_work.sh
  check reproducible tools/check_reproducible.sh --quick
fi
printf 'test: %s\n' "${summary[@]}"
exit "$failed"
