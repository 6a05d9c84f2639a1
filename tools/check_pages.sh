#!/usr/bin/env bash
# Checks the pages: every link within the project leads to a file and, where it names one, to a
# heading; README.md has at most 900 words, the README of a folder at most 40 lines, and every folder
# with sources has one. Exit status 1 with a line for each fault. Does not look at links to the web.
#   tools/check_pages.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mapfile -t pages < <(find . -name '*.md' -not -path './build/*' -not -path './out/*' | sed 's|^\./||' | sort)
faults=0
fault() {
  echo "check_pages: $1"
  faults=$((faults + 1))
}

# PAGE, LINE, FOLDER of the page, FILE that a link names (may be empty), HEADING (may be empty).
links() {
  perl -ne '
    $fenced = !$fenced if /^```/;
    (my $folder = $ARGV) =~ s{[^/]*$}{};
    unless ($fenced || /^    /) {
      while (/\]\(([^)\s]+)\)/g) {
        my $link = $1;
        next if $link =~ /^[a-z]+:/;
        my ($file, $heading) = split /#/, $link, 2;
        print join("|", $ARGV, $., $folder, $file, $heading // ""), "\n";
      }
    }
    if (eof) { close ARGV; $fenced = 0 }' "${pages[@]}"
}

# The names by which links know the headings of a page.
headings() {
  perl -CSDA -Mutf8 -ne '
    $fenced = !$fenced if /^```/;
    next if $fenced || !/^#+ (.*)/;
    my $name = lc $1;
    $name =~ s/[^\w\- ]//g;
    $name =~ s/ /-/g;
    print "$name\n"' "$1"
}

number=0
while IFS='|' read -r page line folder file heading; do
  number=$((number + 1))
  target=${file:+$folder$file}
  target=${target:-$page}
  if [[ ! -e $target ]]; then
    fault "$page line $line: there is no $file"
  elif [[ -n $heading ]] && ! headings "$target" | grep -qxF -- "$heading"; then
    fault "$page line $line: $target has no heading '$heading'"
  fi
done < <(links)

words=$(wc -w <README.md)
((words <= 900)) || fault "README.md has $words words, more than 900"
for page in "${pages[@]}"; do
  [[ $page == */README.md ]] || continue
  lines=$(wc -l <"$page")
  ((lines <= 40)) || fault "$page has $lines lines, more than 40"
done
while IFS= read -r folder; do
  [[ -e $folder/README.md || $folder == tests/* || $folder == */headers* || $folder == */target* ]] ||
    fault "$folder has no README.md"
done < <(find sim workload platform_models traces tools tests -name '*.h' -printf '%h\n' | sort -u)

echo "check_pages: ${#pages[@]} pages, $number links, $faults faults"
((faults == 0))
