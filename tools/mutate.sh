#!/usr/bin/env bash
# Mutation testing: makes one small change of meaning after the other and looks whether the tests
# notice. Works on a private copy of the tree in build/mutate, without recorded data; the checkout
# is only read. Exit status 0 if every change is noticed or marked as equivalent, else 1.
#   tools/mutate.sh [--list FILE] [--only PATTERN] [--jobs N]
#     --list FILE     the changes (default: tests/mutants.txt, which says how it is written)
#     --only PATTERN  those whose file, old text or new text matches this regular expression
#     --jobs N        compilers at once, and parts in which the tests run (default: 2)
# First come the tests that include the changed file's header or are named like it, then those that
# include another header of its folder, those of its part of the tree, the golden flights, which use
# nearly all of the program, and all others; only the test programs that are needed are built. A test
# run longer than 20 minutes counts as a failure: it hangs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$PWD
copy=$root/build/mutate
binary=$copy/build/release
limit=1200
list=tests/mutants.txt
only=
jobs=2

fail() {
  echo "mutate: $*" >&2
  exit 2
}

while (($# > 0)); do
  [[ $1 == --list || $1 == --only || $1 == --jobs ]] ||
    fail "unknown option $1; expected --list, --only or --jobs"
  [[ -n ${2-} ]] || fail "$1 needs a value"
  case $1 in
    --list) list=$2 ;;
    --only) only=$2 ;;
    --jobs) jobs=$2 ;;
  esac
  shift 2
done
[[ -r $list ]] || fail "$list: no such file; expected a list of mutants"
[[ $jobs =~ ^[1-9][0-9]?$ ]] || fail "--jobs $jobs: expected a number from 1 to 99"

# The tests find no recorded data and share no cache with other builds.
export LEVIOSIM_DATA=$copy/no-data XDG_CACHE_HOME=$copy/cache GTEST_TOTAL_SHARDS=$jobs
unset LEVIOSIM_TEST_PROGRAM

# All mutants of the list that --only asks for, one a line: file, old, new, reason why it is
# equivalent; between unit separators.
read_list() {
  perl -e '
    my ($list, $only) = @ARGV;
    open(my $in, "<", $list) or die "mutate: $list: $!\n";
    my ($file, $old, $new, $reason);
    my $refuse = sub { print STDERR "mutate: $list:$.: $_[0]\n"; exit 2 };
    my $put = sub {
      return unless defined $file;
      $refuse->("the mutant above lacks its - or + line") unless defined $old && defined $new;
      $refuse->("the mutant above changes nothing") if $old eq $new;
      print join("\x1f", $file, $old, $new, $reason // ""), "\n"
        if "$file $old $new" =~ /(?:$only)/;  # an empty // means another thing
      ($file, $old, $new, $reason) = ();
    };
    while (<$in>) {
      chomp;
      $refuse->("a tab; expected spaces") if /\t/;
      next if /^#/;
      if (/^\s*$/) { $put->(); }
      elsif (/^@ (\S+)$/ && !defined $file) { $file = $1; }
      elsif (/^- (.*\S.*)$/ && defined $file && !defined $old) { $old = $1; }
      elsif (/^\+(?: (.*))?$/ && defined $old && !defined $new) { $new = $1 // ""; }
      elsif (/^= (.+)$/ && defined $new && !defined $reason) { $reason = $1; }
      else { $refuse->("expected \"@ FILE\", \"- OLD\", \"+ NEW\", \"= REASON\" in this order"); }
    }
    $put->();
  ' "$list" "$only"
}

# Files of the checkout, committed or not.
sources() {
  git ls-files --cached --others --exclude-standard | while IFS= read -r file; do
    [[ ! -f $file ]] || echo "$file"
  done
}

# Only what differs is copied, so that only that is built again.
update_copy() {
  mkdir -p "$copy"
  sources | while IFS= read -r file; do
    cmp -s "$file" "$copy/$file" && continue
    mkdir -p "$copy/$(dirname "$file")"
    cp "$file" "$copy/$file"
  done
  comm -13 <(sources | LC_ALL=C sort) \
    <(cd "$copy" && find . \( -path ./build -o -path ./cache -o -path ./logs \) -prune -o -type f \
      -printf '%P\n' | LC_ALL=C sort) |
    while IFS= read -r file; do rm "$copy/$file"; done
}

build() { # build LOG TARGET...; tests are not listed after the build, which would run mutants
  local log=$1
  local options=(-DLEVIOSIM_BUILD_BENCHMARKS=OFF -DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST)
  shift
  {
    [[ -f $binary/build.ninja ]] || (cd "$copy" && cmake --preset release "${options[@]}")
    ninja -C "$binary" -j "$jobs" "$@"
  } >"$log" 2>&1
}

# Replaces OLD, which must be there once. Status 1, and nothing changed, if it is not.
replace() { # replace FILE OLD NEW
  [[ -f $copy/$1 ]] && perl -e '
    my ($file, $old, $new) = @ARGV;
    local $/;
    open(my $in, "<", $file) or exit 1;
    my $text = <$in>;
    my $count = () = $text =~ /\Q$old\E/g;
    exit 1 unless $count == 1;
    $text =~ s/\Q$old\E/$new/;
    open(my $out, ">", $file) or exit 1;
    print $out $text;
    close($out) or exit 1;
  ' "$copy/$1" "$2" "$3"
}

# The folders of tests, each of which is a program: leviosim_FOLDER_tests.
parts=(sim workload platform_models traces tools examples system validation)

# The test sources of a step in a folder of tests, nearest first.
tests_of() { # tests_of near|room|part|golden|all FOLDER FILE
  local header=${3%.*}.h stem
  stem=$(basename "${3%.*}")
  case $1 in
    near)
      { grep -rlF --include=*_test.cpp "#include \"$header\"" "tests/$2" || true
        find "tests/$2" -name "${stem}*_test.cpp"; } | LC_ALL=C sort -u ;;
    room) grep -rlF --include=*_test.cpp "#include \"${3%/*}/" "tests/$2" | LC_ALL=C sort || true ;;
    part) [[ $2 != "${3%%/*}" ]] || find "tests/$2" -name '*_test.cpp' | LC_ALL=C sort ;;
    golden) [[ $2 != system ]] || echo tests/system/golden_flight_test.cpp ;;
    all) find "tests/$2" -name '*_test.cpp' | LC_ALL=C sort ;;
  esac
}

# A filter of GoogleTest for the suites of test sources, read as names.
filter_of() {
  xargs -r perl -ne '
    $suites{$1} = 1 if /^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),/;
    END { print join(":", map { "$_.*:*/$_.*:$_/*" } sort keys %suites) }'
}

# Compares the list of mutants with the code, and so notices every one of them.
blind=PageFiles.MutantsChangeTheCodeOfNow

# Runs tests of a program in parts at the same time, all of which end with the first that fails.
run_tests() { # run_tests FOLDER FILTER WITHOUT; logs are $copy/logs/N.txt
  local running=() part status=0
  rm -rf "$copy/logs" && mkdir -p "$copy/logs"
  for ((part = 0; part < jobs; ++part)); do
    (
      ulimit -S -v 40000000 -c 0  # browsers raise it
      GTEST_SHARD_INDEX=$part exec timeout -s KILL "$limit" "$binary/tests/leviosim_$1_tests" \
        --gtest_fail_fast --gtest_filter="$2-$blind:$3"
    ) >"$copy/logs/$part.txt" 2>&1 &
    running+=($!)
  done
  for ((part = 0; part < jobs; ++part)); do
    wait -n || { status=1; break; }
  done
  kill "${running[@]}" 2>/dev/null || true
  wait "${running[@]}" 2>/dev/null || true
  return $status
}

# Which test it was that failed.
culprit() {
  local test
  test=$(sed -n 's/^\[  FAILED  \] \([^ ,]*\.[^ ,]*\).*/\1/p' "$copy"/logs/*.txt | head -1)
  [[ -n $test ]] && echo "$test" && return
  for log in "$copy"/logs/*.txt; do # a test that has begun and not ended: a crash, or too long
    grep -q '^\[  PASSED  \]' "$log" && continue
    test=$(sed -n 's/^\[ RUN      \] //p' "$log" | tail -1)
    [[ -n $test ]] && echo "$test did not end" && return
  done
  echo "?"
}

# Status 0 if no test notices the change of FILE, 1 if one does, 2 if it does not build.
survives() { # survives FILE
  local step part filter
  local -A ran=()
  for step in near room part golden all; do
    for part in "${parts[@]}"; do
      filter=$(tests_of "$step" "$part" "$1" | filter_of)
      [[ -n $filter ]] || continue
      build "$copy/build.txt" leviosim "leviosim_${part}_tests" || return 2
      run_tests "$part" "$filter" "${ran[$part]-}" || return 1
      ran[$part]=$filter
    done
  done
}

mutants=$(read_list) || exit 2
[[ -n $mutants ]] || fail "$list: no mutant matches '$only'"
update_copy
mkdir -p "$copy/logs" "$XDG_CACHE_HOME"
echo "mutate: building without a change"
build "$copy/build.txt" leviosim leviosim_tests || { tail -20 "$copy/build.txt" >&2; fail "the tree does not build"; }
state=$(sources | grep -v -e '\.md$' -e '^tests/mutants.txt$' | xargs sha256sum | sha256sum)
if [[ $(cat "$copy/build/passed" 2>/dev/null) != "$state" ]]; then
  echo "mutate: running all tests without a change"
  for part in "${parts[@]}"; do
    run_tests "$part" '*' '' || fail "$(culprit) fails without a change"
  done
  echo "$state" >"$copy/build/passed"
fi

declare -A count=([noticed]=0 [survived]=0 [equivalent]=0 [unbuilt]=0 [stale]=0)
report() { # report OUTCOME HOW; about $file, $old and $new
  count[$1]=$((count[$1] + 1))
  printf '%-10s %5d s  %s: %s  ->  %s\n' "$1" $((SECONDS - began)) "$file" "$old" "${new:-(nothing)}"
  [[ -z $2 ]] || printf '                    %s\n' "$2"
}
changed=
restore() { [[ -z $changed ]] || cp "$root/$changed" "$copy/$changed"; }
trap restore EXIT

# What was changed before is built together with what is changed now.
while IFS=$'\x1f' read -r file old new reason <&3; do
  began=$SECONDS
  restore
  changed=
  if ! replace "$file" "$old" "$new"; then
    report stale "the old text is not there exactly once"
    continue
  fi
  changed=$file
  survived=0
  survives "$file" || survived=$?
  case $survived in
    1) report noticed "by $(culprit)" ;;
    2) report unbuilt "$(grep -m1 -E 'error|FAILED' "$copy/build.txt" || true)" ;;
    0) [[ -n $reason ]] && report equivalent "$reason" || report survived "" ;;
  esac
done 3<<<"$mutants"

judged=$((count[noticed] + count[survived]))
echo "mutate: ${count[noticed]} noticed, ${count[survived]} survived, ${count[equivalent]} survived" \
  "as equivalent, ${count[unbuilt]} did not build, ${count[stale]} do not apply"
((judged == 0)) || awk -v n="${count[noticed]}" -v all="$judged" \
  'BEGIN { printf "mutate: %.1f %% of %d that count are noticed\n", 100 * n / all, all }'
((count[survived] == 0 && count[stale] == 0))
