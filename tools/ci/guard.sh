#!/usr/bin/env bash
# Holds the profiles levio and next on the synthetic flight against tools/ci/budgets.yaml and the baselines beside it.
# Exit status as that of leviosim: 0 all limits are met, 1 one is not, 2 bad input.
# Each run is added to a history, which servers keep as an artifact, and tools/ci/trend.sh draws its pages.
#   tools/ci/guard.sh [--renew] [--program FILE] [--data DIR] [--history FILE]
#     --renew    record the baselines anew instead; the difference shows in git
#     --program  leviosim [build/release/leviosim]
#     --data     instead of the synthetic flight
#     --history  of the runs [build/ci/history.jsonl]; a page lies beside it for each profile
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

program=build/release/leviosim
data=synthetic
renew=no
history=build/ci/history.jsonl
while (($# > 0)); do
  case $1 in
    --renew) renew=yes ;;
    --program) program=${2:?"--program: expected a file"} && shift ;;
    --data) data=${2:?"--data: expected a folder"} && shift ;;
    --history) history=${2:?"--history: expected a file"} && shift ;;
    *)
      echo "guard: unknown option $1; expected --renew, --program, --data or --history" >&2
      exit 2
      ;;
  esac
  shift
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
budget=tools/ci/budgets.yaml
status=0
for profile in levio next; do
  baseline=tools/ci/$profile-gap9.json
  "$program" run --platform gap9 --data "$data" --profile "$profile" --out "$work/$profile" --quiet >"$work/report"
  if [[ $renew == yes ]]; then
    "$program" budget record "$work/$profile" --budget "$budget" >"$work/baseline.json"
    mv "$work/baseline.json" "$baseline"
    echo "guard: $baseline"
    continue
  fi
  code=0
  "$program" check "$work/$profile" --budget "$budget" --baseline "$baseline" --all >"$work/check" || code=$?
  # A tree with changes that are not committed yet is no run of its commit.
  mkdir -p "$(dirname "$history")"
  "$program" history add "$work/$profile" --branch main --budget "$budget" --baseline "$baseline" --file "$history" >/dev/null ||
    echo "guard: $profile is not added to $history" >&2
  if ((code == 0)); then
    echo "guard: $profile: $(head -n 1 "$work/check" | sed 's/.*: //')"
  else
    sed "s|$work/||" "$work/check"
    ((code > status)) && status=$code
  fi
done
# Without git's history, as in an archive, there is no trend.
if [[ $renew == no ]]; then
  tools/ci/trend.sh "$program" "$history" || echo "guard: no trend (above)" >&2
fi
exit "$status"
