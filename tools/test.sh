#!/usr/bin/env bash
# Builds everything, runs every test, and checks the pages and their figures; what CI calls. Exit
# status 0 only if all is well.
#   tools/test.sh           release build (GCC), reproducibility over compilers, all tests
#                           and 20 s of each light fuzz target
#   tools/test.sh --fast    only the program and its quick tests (ctest -L unit), and the pages
#   tools/test.sh --asan    all tests under address and undefined-behaviour sanitizers
#   tools/test.sh --tsan    tests of what runs in threads (sweeps, batches, drawing) under the
#                           thread sanitizer
#   tools/test.sh --clang   all tests, built by Clang
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
reproducible=yes
targets=()
tests=()
for option in "$@"; do
  case $option in
    --fast)
      reproducible=no
      targets=(leviosim leviosim_{sim,workload,platform_models,traces,tools}_tests)
      tests=(--label-regex unit)
      ;;
    --asan) preset=asan reproducible=no ;;
    --tsan) preset=tsan reproducible=no ;;
    --clang) preset=clang reproducible=no ;;
    *)
      echo "test: unknown option $option; expected --fast, --asan, --tsan or --clang" >&2
      exit 2
      ;;
  esac
done

tools/setup.sh
echo "test: building preset $preset"
tools/build.sh "$preset" "${targets[@]}"

failed=()
check() { "$@" || failed+=("$*"); }
if [[ $reproducible == yes ]]; then
  check tools/check_reproducible.sh --quick
  check tools/fuzz.sh --seconds 20 --light
fi
check tools/check_pages.sh
if [[ $preset == release && ${#targets[@]} == 0 ]]; then
  check tools/ci/guard.sh
  tools/figures.sh --check || echo "test: figures are stale (above); tools/figures.sh makes them anew"
fi
# Last, so that its summary is what stands at the end of the log.
check ctest --preset "$preset" --parallel 2 "${tests[@]}"
((${#failed[@]} == 0)) || printf 'test: failed: %s\n' "${failed[@]}" >&2
exit $((${#failed[@]} > 0))
