#!/usr/bin/env bash
# How the project's own cycles moved: a history of the baselines in tools/ci, each by the commit that recorded it, and a
# page of it for each profile. Nothing is built or run: git has every version of the baselines.
#   tools/ci/trend.sh [PROGRAM [HISTORY]]
#     PROGRAM  leviosim [build/release/leviosim]
#     HISTORY  to add to [build/ci/history.jsonl]; the pages lie beside it
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

program=${1:-build/release/leviosim}
history=${2:-build/ci/history.jsonl}
commits=30  # of each profile, the newest

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$(dirname "$history")"
for profile in levio next; do
  file=tools/ci/$profile-gap9.json
  for commit in $(git log --reverse -n "$commits" --format=%H -- "$file"); do
    git show "$commit:$file" >"$work/baseline.json" 2>/dev/null || continue # the commit removed it
    # What this version of leviosim does not read is left out.
    "$program" history add "$work/baseline.json" --commit "$commit" --branch main --file "$history" >/dev/null ||
      echo "trend: $file of ${commit:0:9} is left out" >&2
  done
  page=${history%.jsonl}-$profile.html
  "$program" history page --file "$history" --profile "$profile" --budget tools/ci/budgets.yaml --out "$page" --force >"$work/page"
  echo "trend: $page: $(awk '/^in short/ { p = 1 } /^next/ { p = 0 } p' "$work/page" | tr -s '\n ' ' ' | sed 's/in short: //')"
done
