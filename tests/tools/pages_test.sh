#!/usr/bin/env bash
# tools/figures.sh and tools/check_pages.sh on a small project of their own, with a program that
# prints a table in place of leviosim. Exit status 0 only if all is as expected.
set -euo pipefail
source_folder=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
project=$(mktemp -d)
trap 'rm -rf "$project"' EXIT
cd "$project"
mkdir -p tools/figures sim data/euroc
cp "$source_folder"/tools/figures.sh "$source_folder"/tools/check_pages.sh tools
cp "$source_folder/tools/figures/cut.sh" tools/figures

cat >program <<'PROGRAM'
#!/usr/bin/env bash
if [[ $1 == draw ]]; then echo '<svg/>' >picture.svg && exit; fi
if [[ $1 == fail ]]; then echo 'no such thing' >&2 && exit 2; fi
cat <<'TABLE'
some text

stage   kcycles, 1 core  speed-up    ms
───────────────────────────────────────
first              1.00      2.00  3.00
second           100.00    200.00  4.00
a note: that has no place in the columns, however long it is

more text
TABLE
PROGRAM
chmod +x program
cat >tools/figures/list.sh <<'LIST'
figure table
shows 'leviosim table'
cut 'table stage stage speed-up | rows second'
figure recorded
needs data
shows 'leviosim table'
figure picture
shows 'leviosim draw'
keeps picture.svg
LIST
: >tools/figures/picture.svg
page() { printf '# Page\n\nbefore\n<!-- figure table -->\nold\n<!-- /figure -->\nafter\n' >page.md; }

expect() { # expect STATUS TEXT COMMAND...: the exit status, and a part of what it prints
  local status=$1 text=$2 output got=0
  shift 2
  output=$("$@" 2>&1) || got=$?
  if [[ $got != "$status" || $output != *"$text"* ]]; then
    echo "pages_test: $*: status $got instead of $status, or no '$text' in: $output" >&2
    exit 1
  fi
}
figures=(tools/figures.sh --program program --data data)

# A stale figure is named, replaced, and then no longer stale; the text around it stays.
page
expect 1 'stale: table in page.md' "${figures[@]}" --check
expect 1 'stale: picture in tools/figures/picture.svg' "${figures[@]}" --check
grep -qx old page.md
expect 0 'table in page.md' "${figures[@]}"
diff page.md - <<'PAGE'
# Page

before
<!-- figure table -->
```text
$ leviosim table
…
stage   speed-up
────────────────
second    200.00
```
<!-- /figure -->
after
PAGE
[[ $(cat tools/figures/picture.svg) == '<svg/>' ]]
expect 0 '0 stale' "${figures[@]}" --check

# What needs data is left out where there are none, with a message.
expect 0 'recorded left out' tools/figures.sh --program program --data nowhere --check

# Markers and names that do not fit are refused, and nothing is changed.
printf '<!-- figure tabel -->\n<!-- /figure -->\n' >page.md
expect 2 "no figure is called 'tabel'" "${figures[@]}"
printf '<!-- figure table -->\n' >page.md
expect 2 'has no end' "${figures[@]}"
[[ $(wc -l <page.md) == 1 ]]
page
expect 2 "no figure is called 'tabel'" "${figures[@]}" tabel
sed -i 's/leviosim table/leviosim fail/' tools/figures/list.sh
expect 2 'no such thing' "${figures[@]}"

# Pages that are too long, and folders without one.
printf '# A\n' >README.md
printf '# Sim\n' >sim/README.md
: >sim/some.h
expect 0 '0 faults' tools/check_pages.sh
printf 'word%.0s ' {1..901} >README.md
expect 1 'has 901 words' tools/check_pages.sh
: >README.md
printf 'word%.0s ' {1..3001} >sim/VALIDATION.md
expect 1 'sim/VALIDATION.md has 3001 words, more than 3000' tools/check_pages.sh
rm sim/VALIDATION.md
printf 'word%.0s ' {1..601} >CHANGELOG.md
expect 1 'CHANGELOG.md has 601 words' tools/check_pages.sh
rm CHANGELOG.md
printf 'line%.0s\n' {1..41} >sim/README.md
expect 1 'sim/README.md has 41 lines' tools/check_pages.sh
rm sim/README.md
expect 1 'sim has no README.md' tools/check_pages.sh
echo "pages_test: all is as expected"
