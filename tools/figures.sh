#!/usr/bin/env bash
# Brings the figures in the pages up to date. A figure stands in a page between two marker lines,
#   <!-- figure NAME -->
#   <!-- /figure -->
# as a fenced block: a command and what it printed. tools/figures/list.sh has the command of each NAME.
#   tools/figures.sh [--check] [--slow] [--program FILE] [--data DIR] [NAME...]
#   tools/figures.sh --list
# --check changes nothing, and names the figures that are stale: exit status 1 if there are any.
# Figures that take minutes are left out unless they are named or --slow is given; --check leaves out photos of
# pages (Chromium), which differ from version to version. DIR is the folder
# that contains euroc/ [LEVIOSIM_DATA, else ../shared/data]; figures that need it are left out where it is
# absent. FILE is the leviosim to run [build/release/leviosim].
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tools/figures/cut.sh

names=()
declare -A needs after command cut result photo
figure() { # figure NAME: the following lines are about it
  name=$1
  names+=("$name")
  needs[$name]=
}
needs() { needs[$name]="$*"; }  # data, slow, aha, engine
after() { after[$name]=$1; }    # a command that makes what the figure's command reads; not shown
shows() { command[$name]=$1; }  # the command; it runs in an empty folder beside euroc/
cut() { cut[$name]=$1; }        # the part of its output that is shown: functions of cut.sh
keeps() { result[$name]=$1; }   # a picture that the command makes, kept as tools/figures/NAME.svg
# photo WIDTHxHEIGHT PAGE: how a browser shows a page that the command makes, kept as NAME.png; of a page
# that computes PAGE#SETTING
photo() { photo[$name]=$1 result[$name]=$2; }
source tools/figures/list.sh

fail() {
  echo "figures: $1" >&2
  exit 2
}

check=no
slow=no
list=no
leviosim=build/release/leviosim
data=${LEVIOSIM_DATA:-../shared/data}
wanted=()
while (($# > 0)); do
  case $1 in
    --check) check=yes && shift ;;
    --slow) slow=yes && shift ;;
    --list) list=yes && shift ;;
    --program) leviosim=${2:?--program needs a file} && shift 2 ;;
    --data) data=${2:?--data needs a folder} && shift 2 ;;
    -*) fail "unknown option $1; expected --check, --list, --slow, --program or --data" ;;
    *)
      [[ -v needs[$1] ]] || fail "no figure is called '$1'; tools/figures.sh --list names them"
      wanted+=("$1") && shift
      ;;
  esac
done

mapfile -t pages < <(find . -name '*.md' -not -path './build/*' -not -path './out/*' | sed 's|^\./||' | sort)

# Every marked figure as PAGE and NAME. Refuses markers that do not belong together.
marked=$(perl -ne '
  sub bad { print STDERR "figures: $ARGV line $.: $_[0]\n"; exit 2 }
  if (/^<!-- figure (\S+) -->$/) {
    bad("\"$1\" begins inside of \"$open\"") if $open;
    $open = $1;
    print "$ARGV\t$1\n";
  } elsif (m{^<!-- /figure -->$}) {
    bad("the end of a figure that has no begin") unless $open;
    $open = "";
  }
  if (eof) {
    bad("\"$open\" has no end: <!-- /figure -->") if $open;
    close ARGV;
  }' "${pages[@]}") || exit 2
while IFS=$'\t' read -r page name; do
  [[ -z $name || -v needs[$name] ]] || fail "$page: no figure is called '$name' in tools/figures/list.sh"
done <<<"$marked"

pages_of() { awk -F '\t' -v name="$1" '$2 == name { print $1 }' <<<"$marked" | sort -u; }

if [[ $list == yes ]]; then
  for name in "${names[@]}"; do
    printf '%-20s %-10s %s\n' "$name" "${needs[$name]:--}" "$(pages_of "$name" | paste -sd ' ')"
    printf '  $ %s\n' "${command[$name]}"
  done
  exit 0
fi

[[ -x $leviosim ]] || fail "there is no program $leviosim; build it (tools/build.sh release leviosim) or give --program"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/outputs" "$work/folder"
ln -s "$(realpath "$leviosim")" "$work/bin/leviosim"
for script in tools/figures/*.py; do [[ ! -e $script ]] || ln -s "$(realpath "$script")" "$work/bin"; done
if [[ -d $data/euroc ]]; then ln -s "$(realpath "$data/euroc")" "$work/folder/euroc"; fi

# Runs a command once, however many figures show parts of what it prints; the name of its output.
output_of() { # output_of NAME COMMAND
  local output status=0
  output=$work/outputs/$(sha256sum <<<"$2" | head -c 16)
  if [[ ! -e $output ]]; then
    (cd "$work/folder" && COLUMNS=1000 LINES=0 PATH=$work/bin:$PATH bash -c "$2" >"$output" 2>"$output.errors" </dev/null) || status=$?
    if ((status > 1)); then # 1 is an answer: a limit is not met
      echo "figures: $1: the command failed: $(tail -1 "$output.errors")" >&2
      exit 2
    fi
  fi
  echo "$output"
}

take_photo() { # take_photo SIZE PAGE PICTURE
  if [[ $2 == *#* ]]; then
    python3 tools/figures/page_still.py "$2" "$1" "$3" >/dev/null 2>"$work/still.errors" ||
      fail "$2: $(tail -1 "$work/still.errors")"
    return
  fi
  chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --virtual-time-budget=5000 \
    --window-size="${1/x/,}" --screenshot="$3" "file://$2" >/dev/null 2>&1 ||
    fail "chromium shows no $2; tools/setup.sh tests installs it"
}

# What stands between the markers.
block_of() { # block_of NAME
  local output
  [[ -z ${after[$1]:-} ]] || output_of "$1" "${after[$1]}" >/dev/null
  output=$(output_of "$1" "${command[$1]}")
  echo '```text'
  echo "\$ ${command[$1]}"
  if [[ -n ${cut[$1]:-} ]]; then
    echo '…'
    eval "${cut[$1]}" <"$output" >"$work/shown"
    [[ -s $work/shown ]] || fail "$1: '${cut[$1]}' leaves nothing of the output of: ${command[$1]}"
    cat "$work/shown"
  else
    cat "$output"
  fi
  echo '```'
}

with_figure() { # with_figure PAGE NAME BLOCK: the page with the text of the file BLOCK
  perl -e '
    my ($page, $name, $block) = @ARGV;
    open my $file, "<", $block or die "figures: $block: $!\n";
    my $text = join "", <$file>;
    open $file, "<", $page or die "figures: $page: $!\n";
    my $inside = 0;
    while (<$file>) {
      $inside = 0 if m{^<!-- /figure -->$};
      print unless $inside;
      if ($_ eq "<!-- figure $name -->\n") { print $text; $inside = 1 }
    }' "$1" "$2" "$3"
}

stale=0
update() { # update FILE NEW NAME: put NEW in place of FILE, or say that it differs
  cmp -s "$1" "$2" && return
  if [[ $check == yes ]]; then
    echo "figures: stale: $3 in $1"
    stale=$((stale + 1))
  else
    cp "$2" "$1"
    echo "figures: $3 in $1"
  fi
}

done_figures=0
for name in "${names[@]}"; do
  if ((${#wanted[@]} > 0)); then
    [[ " ${wanted[*]} " == *" $name "* ]] || continue
  elif [[ " ${needs[$name]} " == *" slow "* && $slow == no ]]; then
    echo "figures: $name left out: it takes minutes; name it, or give --slow"
    continue
  fi
  if [[ " ${needs[$name]} " == *" data "* && ! -d $data/euroc ]]; then
    echo "figures: $name left out: there is no $data/euroc"
    continue
  fi
  if [[ " ${needs[$name]} " == *" aha "* ]] && ! command -v aha >/dev/null; then
    echo "figures: $name left out: it needs aha (apt-get install aha)"
    continue
  fi
  if [[ " ${needs[$name]} " == *" engine "* ]] && "$leviosim" report none --interactive -o none 2>&1 | grep -q "without the engine"; then
    echo "figures: $name left out: it needs a program with the engine of pages (LEVIOSIM_WASM=ON tools/build.sh release)"
    continue
  fi
  if [[ -n ${photo[$name]:-} ]]; then
    [[ $check == no ]] || continue
    [[ -z ${after[$name]:-} ]] || output_of "$name" "${after[$name]}" >/dev/null
    output_of "$name" "${command[$name]}" >/dev/null
    take_photo "${photo[$name]}" "$work/folder/${result[$name]}" "$work/photo.png"
    update "tools/figures/$name.png" "$work/photo.png" "$name"
  elif [[ -n ${result[$name]:-} ]]; then
    output_of "$name" "${command[$name]}" >/dev/null
    update "tools/figures/$name.svg" "$work/folder/${result[$name]}" "$name"
  else
    block_of "$name" >"$work/block"
    while IFS= read -r page; do
      [[ -n $page ]] || continue
      with_figure "$page" "$name" "$work/block" >"$work/page"
      update "$page" "$work/page" "$name"
    done < <(pages_of "$name")
  fi
  done_figures=$((done_figures + 1))
done

if [[ $check == yes ]]; then
  echo "figures: $done_figures checked, $stale stale"
  ((stale == 0)) || exit 1
fi
