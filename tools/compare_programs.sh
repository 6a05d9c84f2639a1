#!/usr/bin/env bash
# Holds two builds of leviosim against each other: both run the same commands on the same data, and
# every result is compared byte by byte. For changes that must not change behaviour.
#   tools/compare_programs.sh OLD NEW [--data DIR] [--frames A:B]
# OLD and NEW are programs, --data is an ASL folder [the synthetic flight only], --frames a part of it
# for all commands but the first two [0:60]. Exit status 1 if a file differs or a command fails.
# Compared: statistics, trajectories, tables, flights, and replays of work traces. Not compared:
# manifests and work traces themselves, which name the program that wrote them, platform.yaml,
# plots, and databases (their tables are compared).
set -euo pipefail

usage="usage: tools/compare_programs.sh OLD NEW [--data DIR] [--frames A:B]"
old=$(realpath "${1:?$usage}")
new=$(realpath "${2:?$usage}")
shift 2
data=
frames=0:60
while (($# > 0)); do
  case $1 in
    --data) data=$(realpath "${2:?--data needs a folder}") && shift 2 ;;
    --frames) frames=${2:?--frames needs A:B} && shift 2 ;;
    *)
      echo "compare_programs: unknown option $1; expected --data or --frames" >&2
      exit 2
      ;;
  esac
done

results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT

plan() { # plan TRACE
  cat <<YAML
base: { trace: $1 }
points:
  - list:
      - { platform.cluster.clock: 240MHz, platform.controller.clock: 240MHz, platform.supply.voltage: 0.65V }
      - { platform.cluster.clock: 370MHz }
    grid:
      platform.cluster.fpu.units: [1, 4]
      platform.cluster.l1.size: [64KiB, 128KiB]
YAML
}

step() { # step NAME LEVIOSIM ARGUMENT...
  local name=$1
  shift
  local status=0
  "$@" >"$name.out" 2>"$name.err" || status=$?
  if ((status > 1)); then # 1: a limit was not met, or a point failed
    echo "compare_programs: $name failed: $(tail -1 "$name.err")" >&2
    return 1
  fi
}

# Every command with results, on one data set, in the present folder.
commands() { # commands LEVIOSIM DATA FRAMES
  local leviosim=$1 data=$2 part=(--frames "$3")
  step run "$leviosim" run --platform gap9 --data "$data" --record --quiet --out run
  step next "$leviosim" run --platform gap9 --profile next --data "$data" --quiet --out next
  step native "$leviosim" run --native --data "$data" "${part[@]}" --quiet --out native
  step loop "$leviosim" run --platform gap9 -p cluster.clock=100MHz -p controller.clock=100MHz \
    --fps 15 --deadline drop --data "$data" "${part[@]}" --quiet --out loop
  step queue "$leviosim" run --platform cortex-m7-h7a3 --fps 10 --deadline queue \
    --data "$data" "${part[@]}" --quiet --out queue
  step replay "$leviosim" replay run/work.trace --quiet --out replay
  step replay-gap8 "$leviosim" replay run/work.trace --platform gap9-hamming --quiet --out replay-gap8
  step tune "$leviosim" tune --data "$data" "${part[@]}" --clock 150:370:110 --fps 10,20 --seed 1 \
    --cache tune-cache --quiet --out tune
  plan run/work.trace >plan.yaml
  step sweep "$leviosim" sweep plan.yaml --cache sweep-cache --quiet --out sweep
  step ablate "$leviosim" ablate --data "$data" "${part[@]}" --seed 1 --relative 0.05 --cache ablate-cache --quiet --out ablate
  step eval "$leviosim" eval run/trajectory.tum "$data" --json eval.json
  step flow "$leviosim" flow --platform gap8 -p cluster.clock=50MHz -p controller.clock=50MHz \
    -p supply.voltage=1.0V --data "$data" "${part[@]}" --quiet --out flow
  studies "$leviosim" "$data" "${part[@]}"
  tables "$leviosim"
}

# What asks about a run or a data set, on stdout as lines and as JSON.
studies() { # studies LEVIOSIM DATA --frames FRAMES
  local leviosim=$1 data=$2 part=("${@:3}")
  both whatif "$leviosim" whatif run --quiet
  both whatif-some "$leviosim" whatif run cluster.fpu.units=2,4 gap9-hamming --quiet
  both sensitivity "$leviosim" sensitivity --data "$data" "${part[@]}" --quiet
  both feasibility "$leviosim" platforms feasibility --data "$data" "${part[@]}" --quiet
  both stages "$leviosim" platforms stages gap9 gap9-eigen --data "$data" "${part[@]}" --quiet
  both systems "$leviosim" platforms systems --data "$data" "${part[@]}" --quiet
  both vary "$leviosim" ablate --data "$data" "${part[@]}" --profile levio \
    --vary workload.window=6:12 --points 3 --seed 1 --relative 0.05 --cache vary-cache \
    --quiet --force --out varied
  both compare "$leviosim" compare run replay-gap8
  step compare-md "$leviosim" compare run replay-gap8 --format markdown
  step compare-csv "$leviosim" compare run replay-gap8 --format csv
  step report "$leviosim" report run next native loop --out report.html
}

# What prints tables without running anything.
tables() { # tables LEVIOSIM
  both platforms "$1" platforms
  both show "$1" platforms show gap9
  both diff "$1" platforms diff gap9 gap8
  both area "$1" platforms area gap9
  both workload "$1" workload
  both microbench "$1" microbench
}

both() { # both NAME LEVIOSIM ARGUMENT...
  step "$1" "${@:2}" --all
  step "$1-json" "${@:2}" --json
}

all() { # all NAME LEVIOSIM
  mkdir -p "$results/$1/synthetic"
  cd "$results/$1/synthetic"
  step synth "$2" synth --duration 5 --quiet --out flight
  commands "$2" flight 0:40
  if [[ -n $data ]]; then
    mkdir -p "$results/$1/recorded"
    cd "$results/$1/recorded"
    commands "$2" "$data" "$frames"
  fi
}

all old "$old" &
all new "$new" &
wait -n && wait -n || exit 1

mapfile -t files < <(cd "$results/old" && find . -type f \
  \( -name '*.json' -o -name '*.csv' -o -name '*.tum' -o -name '*.md' -o -name '*.png' \
     -o -name '*.out' -o -name sensor.yaml \) ! -name manifest.json ! -path '*-cache/*' | sort)
status=0
for file in "${files[@]}"; do
  cmp "$results/old/$file" "$results/new/$file" || status=1
done
echo "compare_programs: ${#files[@]} files compared, $(printf '%s\n' "${files[@]}" | grep -c run.json) of them run.json"
if ((status == 0)); then
  echo "compare_programs: all files are the same, byte by byte"
else
  echo "compare_programs: FILES DIFFER" >&2
fi
exit $status
