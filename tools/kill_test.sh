#!/usr/bin/env bash
# Kills leviosim at random moments (SIGKILL, which nothing can catch) and checks that nothing is
# lost: what stands under the name of a result is whole, foreign files are untouched, and the same
# command given again ends with the same bytes as one that was never killed and leaves nothing else.
#   tools/kill_test.sh [--kills N] [--seed S] [--program LEVIOSIM]
# The commands run, sweep, tune, synth, ablate and history take turns. Exit status 1 with the first loss. At
# the end, also of a run that is interrupted, it says how many kills there were and what they left.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

kills=500
RANDOM=1
leviosim=build/release/leviosim
while (($# > 0)); do
  case $1 in
    --kills) kills=${2:?--kills needs a number} && shift 2 ;;
    --seed) RANDOM=${2:?--seed needs a number} && shift 2 ;;
    --program) leviosim=${2:?--program needs a file} && shift 2 ;;
    *)
      echo "kill_test: unknown option $1; expected --kills, --seed or --program" >&2
      exit 2
      ;;
  esac
done
leviosim=$(realpath "$leviosim")

names=(run sweep tune synth ablate history)
declare -A struck unfinished
done_kills=0
fifties=0
missed=0
loss=0
end() {
  for name in "${names[@]}"; do
    printf 'kill_test: %-7s %4d kills, %d left something unfinished\n' "$name" \
      "${struck[$name]:-0}" "${unfinished[$name]:-0}"
  done
  echo "kill_test: $done_kills kills, $missed came too late, $loss losses"
  rm -rf "$work"
}

work=$(mktemp -d)
trap end EXIT
trap 'exit 130' INT TERM
cd "$work"
export XDG_CACHE_HOME=$work/cache

# Inputs: a short flight, its recorded work, and a plan over that.
"$leviosim" synth --duration 0.5 --quiet --out flight >/dev/null
"$leviosim" run --platform gap9 --data flight --size 32x24 --record --quiet --out recorded >/dev/null
cat >plan.yaml <<'YAML'
base: { trace: recorded/work.trace }
points:
  - grid:
      platform.cluster.fpu.units: [1, 2, 4]
      platform.cluster.l1.banks: [8, 16]
YAML
for n in 1 2 3; do # a history that grows
  "$leviosim" history add recorded --file begun.jsonl --commit "c$n" --branch main --time "$n" --subject s \
    >/dev/null
done

command_of() { # command_of NAME: the words in `words`
  case $1 in
    run) words=(run --platform gap9 --data flight --size 32x24 --record --out out) ;;
    sweep) words=(sweep plan.yaml --cache points --out out) ;;
    tune) words=(tune --data flight --size 32x24 --clock 200:370:85 --fps 20 --seed 1 --cache runs --out out) ;;
    synth) words=(synth --duration 0.1 --out out) ;;
    ablate) words=(ablate --data flight --size 32x24 --seed 1,2 --cache runs --out out) ;;
    history) words=(history add recorded --file out --commit c4 --branch main --time 4 --subject s) ;;
  esac
}

begin_of() { # begin_of NAME: what is there before the command
  [[ $1 != history ]] || cp begun.jsonl history/out
}

results_of() { # results_of FOLDER|FILE: digests of what must be the same in every run
  [[ ! -f $1 ]] || { sha256sum <"$1" && return; }
  (cd "$1" && find . -type f ! -name manifest.json ! -name .leviosim-files -print0 |
    sort -z | xargs -0 sha256sum)
}

# What an undisturbed run gives, and how long it takes (in hundredths of a second).
declare -A expected duration
for name in "${names[@]}"; do
  mkdir -p "$name"
  cp -r flight recorded plan.yaml "$name"
  begin_of "$name"
  command_of "$name"
  begin=$(date +%s%N)
  (cd "$name" && "$leviosim" "${words[@]}" --quiet >/dev/null) || (($? == 1)) # a limit was not met
  duration[$name]=$((($(date +%s%N) - begin) / 10000000 + 1))
  expected[$name]=$(results_of "$name/out")
  (cd "$name" && rm -rf out points runs && echo mine >thesis.tex && mkdir notes && echo mine >notes/a)
done

lose() { # lose NAME MESSAGE
  loss=1
  echo "kill_test: LOST after $done_kills kills, $1: $2" >&2
  find "$work/$1" -maxdepth 2 | sort >&2
  exit 1
}

check_foreign() { # check_foreign NAME
  [[ $(cat "$1/thesis.tex") == mine && $(cat "$1/notes/a") == mine ]] || lose "$1" "a foreign file has changed"
  if [[ $1 == history ]]; then # the runs that were there, and a part of a line at most
    cmp -s -n "$(stat -c %s begun.jsonl)" begun.jsonl history/out || lose history "a run is gone"
    return 0
  fi
  [[ $1 == sweep || ! -e $1/out || $(results_of "$1/out") == "${expected[$1]}" ]] ||
    lose "$1" "a half-written result"
}

resume() { # resume NAME: the same command again, undisturbed
  command_of "$1"
  (cd "$1" && "$leviosim" "${words[@]}" --quiet >/dev/null 2>error) || (($? == 1)) || lose "$1" "$(cat "$1/error")"
  rm "$1/error"
  [[ $(results_of "$1/out") == "${expected[$1]}" ]] || lose "$1" "other bytes after it was resumed"
  local left
  left=$(cd "$1" && find . -mindepth 1 -maxdepth 1 ! -name flight ! -name recorded ! -name plan.yaml \
    ! -name out ! -name thesis.tex ! -name notes ! -name points ! -name runs)
  [[ -z $left ]] || lose "$1" "left behind: $left"
  left=$(find "$1" -name '*.leviosim*' ! -name .leviosim-files)
  [[ -z $left ]] || lose "$1" "left behind: $left"
  rm -rf "$1/out" "$1/points" "$1/runs"
}

while ((done_kills < kills)); do
  name=${names[$((done_kills % ${#names[@]}))]}
  command_of "$name"
  begin_of "$name"
  # Up to three kills in a row before the command may end.
  for ((strikes = RANDOM % 3; strikes >= 0 && done_kills < kills; strikes--)); do
    (cd "$name" && exec "$leviosim" "${words[@]}" --quiet >/dev/null 2>&1) &
    pid=$!
    hundredths=$((RANDOM % (duration[$name] + 1)))
    sleep "$((hundredths / 100)).$(printf %02d $((hundredths % 100)))"
    kill -KILL "$pid" 2>/dev/null || true
    ended=0
    wait "$pid" 2>/dev/null || ended=$?
    if ((ended == 137)); then
      struck[$name]=$((${struck[$name]:-0} + 1))
      done_kills=$((done_kills + 1))
      if compgen -G "$name/.*.leviosim" >/dev/null ||
        [[ $name == sweep && -e $name/out && ! -e $name/out/sweep.csv ]]; then
        unfinished[$name]=$((${unfinished[$name]:-0} + 1))
      fi
    else
      missed=$((missed + 1))
    fi
    check_foreign "$name"
    [[ -e $name/out && $name != sweep && $name != history ]] && break
  done
  [[ -e $name/out && $name != sweep && $name != history ]] && rm -rf "$name/out"
  resume "$name"
  if ((done_kills / 50 > fifties)); then
    fifties=$((done_kills / 50))
    echo "kill_test: $done_kills kills so far"
  fi
done
