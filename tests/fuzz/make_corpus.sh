#!/usr/bin/env bash
# Makes the seeds of all fuzz targets: from the shipped platforms and plans, and with the program
# `seeds` of the fuzz build.
#   tests/fuzz/make_corpus.sh SEEDS FOLDER   makes FOLDER/TARGET/*
set -euo pipefail
seeds=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

for target in platform_yaml overrides sweep_plan sensor_yaml asl_tables budget baseline; do
  mkdir -p "$folder/$target"
done
"$seeds" "$folder"

cp platform_models/chips/*.yaml "$folder/platform_yaml"
cp tools/ci/*.json "$folder/baseline"
cat >"$folder/baseline/small" <<'END'
{"format": "leviosim baseline", "version": 1,
"facts": {"program":"0.1.0 x","profile":"levio","seed":1,"platform":"gap9","overrides":[],"cores":8,"image":[160,120],"first_frame":0,"frames":10,"inputs":{"cam0/data.csv":"62"}},
"statistics": {"frames.count":[10,"1"],"stages.feature_extraction.cycles.parallel.mean":[190000.5,"cycles"]},
"stages": [{"name":"feature extraction","key":"feature_extraction","controller":false,"cycles":1900000,"parts":{"detect":{"issue int_alu":[1400000,1000000]},"":{"fpu":500000}}}]}
END
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
isa.instruction_overhead=1.5
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
