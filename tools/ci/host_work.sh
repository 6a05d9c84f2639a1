#!/usr/bin/env bash
# Holds how much the host computes for typical commands against tools/ci/host_work.csv: instructions,
# counted by callgrind, which differ by less than 0.1 % from run to run and do not depend on what else
# the machine does. Exit status 1 if a command takes over 1 % more or fewer than its budget; fewer,
# because an improvement that nobody wrote down can be lost again unseen.
#   tools/ci/host_work.sh [--renew] [--program FILE]
#     --renew    write the budget anew instead; the difference shows in git
#     --program  leviosim [build/release/leviosim]
# Budgets hold for the release preset with Debian 12's compiler.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

program=build/release/leviosim
renew=no
while (($# > 0)); do
  case $1 in
    --renew) renew=yes ;;
    --program) program=${2:?"--program: expected a file"} && shift ;;
    *)
      echo "host_work: unknown option $1; expected --renew or --program" >&2
      exit 2
      ;;
  esac
  shift
done
command -v valgrind >/dev/null || { echo "host_work: valgrind is missing: tools/setup.sh full" >&2; exit 2; }
program=$(realpath "$program")
budget=$PWD/tools/ci/host_work.csv
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# Few frames: callgrind takes fifty times as long. The flight is drawn once, uncounted.
"$program" synth --out flight --duration 3 --quiet >/dev/null
for profile in levio next; do
  "$program" run --data flight --profile "$profile" --record --out "of-$profile" --quiet >/dev/null
done
commands() { # NAME ARGUMENTS...
  cat <<COMMANDS
run_levio run --data flight --frames 0:12 --profile levio --out a --force --quiet
run_next run --data flight --frames 0:12 --profile next --out b --force --quiet
replay_levio replay of-levio --out c --force --quiet
replay_next replay of-next --out d --force --quiet
whatif_next whatif of-next cluster.fpu.units=2,8 --jobs 1 --quiet
synth synth --out drawn --duration 0.2 --quiet
COMMANDS
}
counted() { # ARGUMENTS...: prints instructions
  valgrind --tool=callgrind --callgrind-out-file=counts "$program" "$@" >output 2>log ||
    { tail -n 5 log output >&2 && exit 2; }
  awk '/^(summary|totals):/ { print $2; exit }' counts
}

status=0
echo "command,instructions" >measured.csv
while read -r name arguments; do
  read -ra words <<<"$arguments"
  instructions=$(counted "${words[@]}")
  echo "$name,$instructions" >>measured.csv
  [[ $renew == yes ]] && continue
  awk -F, -v name="$name" -v now="$instructions" '
    $1 == name { budget = $2 }
    END {
      if (!budget) { printf "host_work: %s has no budget\n", name; exit 1 }
      change = 100 * (now / budget - 1)
      verdict = ""
      if (change > 1) verdict = ": over its budget"
      if (change < -1) verdict = ": less; take it with --renew"
      printf "host_work: %-13s %8.1f million instructions, %+.2f %%%s\n", name, now / 1e6, change, verdict
      exit verdict != ""
    }' "$budget" || status=1
done < <(commands)
if [[ $renew == yes ]]; then
  cp measured.csv "$budget"
  echo "host_work: tools/ci/host_work.csv"
fi
exit "$status"
