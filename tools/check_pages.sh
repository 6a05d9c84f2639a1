#!/usr/bin/env bash
# Checks the lengths of the pages: README.md has at most 900 words, sim/VALIDATION.md and
# workload/ACCURACY.md at most 3000, CHANGELOG.md 600, the README of a folder at most 40 lines, and every
# folder with headers has one. Exit status 1 with a line for each fault. Links are
# checked by tests/tools/citations_test.cpp, figures by tools/figures.sh --check.
#   tools/check_pages.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mapfile -t pages < <(find . -name '*.md' -not -path './build/*' -not -path './out/*' | sed 's|^\./||' | sort)
faults=0
fault() {
  echo "check_pages: $1"
  faults=$((faults + 1))
}

while read -r page most; do
  [[ -e $page ]] || continue
  words=$(wc -w <"$page")
  ((words <= most)) || fault "$page has $words words, more than $most"
done <<END
README.md 900
sim/VALIDATION.md 3000
workload/ACCURACY.md 3000
CHANGELOG.md 600
END
for page in "${pages[@]}"; do
  [[ $page == */README.md ]] || continue
  lines=$(wc -l <"$page")
  ((lines <= 40)) || fault "$page has $lines lines, more than 40"
done
while IFS= read -r folder; do
  [[ -e $folder/README.md || $folder == tests/* || $folder == */headers* || $folder == */target* ]] ||
    fault "$folder has no README.md"
done < <(find sim workload platform_models traces tools tests -name '*.h' -printf '%h\n' | sort -u)

echo "check_pages: ${#pages[@]} pages, $faults faults"
((faults == 0))
