#!/usr/bin/env bash
# Makes the seeds of all fuzz targets: from the shipped platforms and plans, and with the program
# `seeds` of the fuzz build.
#   tests/fuzz/make_corpus.sh SEEDS FOLDER   makes FOLDER/TARGET/*
set -euo pipefail
seeds=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

for target in platform_yaml overrides sweep_plan sensor_yaml asl_tables budget record flight_plan \
  json output_record rendered_table; do
  mkdir -p "$folder/$target"
done
"$seeds" "$folder"

cp platform_models/chips/*.yaml "$folder/platform_yaml"
cp tools/ci/*.json "$folder/record"
cat >"$folder/record/small" <<'END'
{"format": "leviosim run", "version": 1,
"verdicts": [{"about":"time","grade":"good","word":"fits","reasons":[]},{"about":"map","grade":"bad","word":"lost","reasons":["x"]}],
"program": "0.1.0 x",
"facts": {"profile":"levio","seed":1,"platform":"gap9","overrides":[],"cores":8,"image":[160,120],"first_frame":0,"frames":10,"inputs":{"cam0/data.csv":"62"}},
"statistics": {"frames.count":[10,"1"],"stages.feature_extraction.cycles.parallel.mean":[190000.5,"cycles","of a call"],"accuracy.ate.rmse":[0.25,"m","error","SE(3)"]},
"stages": [{"name":"feature extraction","key":"feature_extraction","controller":false,"cycles":1900000,"parts":{"detect":{"issue int_alu":[1400000,1000000]},"":{"fpu":500000}}}]}
END
cat >"$folder/record/outcome" <<'END'
{"format": "leviosim run", "version": 1, "statistics": {"sub_trajectories":[3,""],"frames":[3,""],"matched":[3,""],"completion":[1,""],"map_restarts":[0,""],"scale.windows":[0,""],"scale.mean":[0,""],"scale.sigma":[0,""],"path_m":[1,""],"arrived":[3,""]}}
END
printf 'fleviosim cache 3 ab-fuzzed %s\n{}' "$(printf '{}' | sha256sum | cut -c1-64)" >"$folder/record/file"
cp tools/ci/budgets.yaml "$folder/budget/project"
cat >"$folder/budget/forms" <<'END'
budgets:
  - name: levio on gap9
    platform: gap9*
    profile: levio
    owner: front end
    limits:
      - frame latency p99 <= 45 ms
      - limit: L1 peak <= 110 kB
        reason: the rest of L1 is the radio's
      - stage: "*RANSAC"
        limit: cycles <= +3 %
      - stages.*.memory.parallel <= -1 KiB
      - ATE >= 0.1 m
      - missed <= 1 %
END
cat >"$folder/overrides/some" <<'END'
cluster.clock=240MHz
cluster.workers=4
cluster.l1.size=64 KiB
isa.base=rv32imfc
isa.unmeasured_instructions=1.5
END
echo 'cluster.fpu.units=2' >"$folder/overrides/one"
cat >"$folder/sweep_plan/grid" <<'END'
base: { data: flight, platform: gap9, seed: 1 }
impossible: skip
points:
  - grid: { platform.cluster.clock: [240, 370], cores: [1, 4, 8], workload.window: {from: 4, to: 8, step: 1} }
  - list:
      - { profile: next, workload.guided: off }
      - { profile: levio }
  - random: { number: 20, seed: 3, over: { platform.cluster.clock: {from: 100MHz, to: 370MHz} } }
  - latin_hypercube: { number: 8, over: { platform.cluster.fpu.units: {from: 1, to: 4}, size: [160x120] } }
END
sed 's|data: .*|data: flight|' tools/app/study/sweep/examples/means.yaml >"$folder/sweep_plan/means"
cat >"$folder/sensor_yaml/camera" <<'END'
csensor_type: camera
comment: VI-Sensor cam0 (MT9M034)
T_BS:
  cols: 4
  rows: 4
  data: [0, -1, 0, 0.02, 1, 0, 0, -0.06, 0, 0, 1, 0.01, 0.0, 0.0, 0.0, 1.0]
rate_hz: 20
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
prepared: true
END
cat >"$folder/sensor_yaml/imu" <<'END'
isensor_type: imu
T_BS:
  cols: 4
  rows: 4
  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
rate_hz: 200
gyroscope_noise_density: 1.6968e-04
gyroscope_random_walk: 1.9393e-05
accelerometer_noise_density: 2.0000e-3
accelerometer_random_walk: 3.0000e-3
END
printf 'f#timestamp [ns],filename\n1403636579763555584,1.png\n1403636579813555456,2.png\n' \
  >"$folder/asl_tables/frames"
printf 'i#timestamp [ns],w\r\n1403636579758555392,-0.1,0.1,0.02,8.1,-0.3,-4.0\r\n1403636579763555584,0,0,0,8,0,-4\r\n' \
  >"$folder/asl_tables/imu"

cp tools/app/study/flights/plans/*.yaml "$folder/flight_plan"
printf 'recordings: [a]\nstarts: { even: [0, 20] }\npieces: [90, rest]\nevery: 2.5\ndisturbances: [none, noise=10]\nsize: 32x24\nvariants:\n  - { profile: next, workload.window: 8 }\n' \
  >"$folder/flight_plan/recordings"
printf 'leviosim files 1\n%064d 12 frames.csv\n%064d 0 deep/er/%%0A%%25x\n- - points.jsonl\n' 1 2 \
  >"$folder/output_record/some"
printf 'leviosim journal 1 9\n- - notes.md\n' >"$folder/output_record/journal"
printf 'leviosim files 1\n- - ../x\n' >"$folder/output_record/outside"

# Depth, members and lines of what is JSON; words that mean something where they are printed.
printf '{"a":[{"b":1.5e3},null,true,"\\u00e9"]}' >"$folder/json/some"
printf '{"a":%s%s}' "$(printf '[%.0s' {1..63})" "$(printf ']%.0s' {1..63})" >"$folder/json/deep"
printf '{%s"z":0}' "$(printf '"k%d":0,' {1..600})" >"$folder/json/members"
printf 'a | b\n=%%%%=\n<img src=x> [a](http://b) @team `c`\n=%%%%=\n\xe2\x80\xa8\x1b[2J,"\r\n' >"$folder/rendered_table/words"
