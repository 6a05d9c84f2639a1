// A small run, made by hand, whose derived figures are easy to work out: tests of tables,
// statistics and files read it.
#pragma once

#include "sim/work/op.h"
#include "tools/app/result/run_result.h"

namespace leviosim::tools::testing {

inline work::Block block(std::string_view name, std::int64_t bytes) {
  return {name, Bytes(0), Bytes(bytes)};
}

/// Two calls, 8 Mcycles on one core, 2 Mcycles on four: a speed-up of 4.
inline StageResult parallel_stage() {
  StageResult stage;
  stage.name = "feature extraction";
  stage.unit = "frame";
  stage.calls = 2;
  stage.single = Cycles(8'000'000);
  stage.parallel = Cycles(2'000'000);
  stage.worst_parallel = Cycles(1'200'000);
  stage.account.team[sim::Mechanism::Issue] = 3e6;
  stage.account.team[sim::Mechanism::LoadUse] = 1e6;
  stage.account.team[sim::Mechanism::Control] = 5e5;
  stage.account.team[sim::Mechanism::Memory] = 2e5;
  stage.account.team[sim::Mechanism::Arithmetic] = 3e5;
  stage.account.team[sim::Mechanism::Fpu] = 1e6;
  stage.account.team[sim::Mechanism::Divider] = 5e5;
  stage.account.team[sim::Mechanism::Banks] = 1e5;
  stage.account.team[sim::Mechanism::Imbalance] = 3e5;
  stage.account.team[sim::Mechanism::Synchronisation] = 1e5;
  stage.account.team[sim::Mechanism::Transfer] = 2e5;
  stage.account.team[sim::Mechanism::Serial] = 799'000;
  stage.account.team[sim::Mechanism::Rounding] = 1'000;
  stage.counts[work::Op::F32Add] = 12'345;
  stage.memory.single = Bytes(32'000);
  stage.memory.parallel = Bytes(64'000);
  stage.memory.blocks = {block("image", 19'200), block("scratch", 10'000),
                         block("scratch", 10'000)};
  return stage;
}

inline StageResult stage_without_calls() {
  StageResult stage;
  stage.name = "EPnP RANSAC";
  stage.unit = "frame";
  return stage;
}

inline StageResult controller_stage() {
  StageResult stage;
  stage.name = "optimiser iteration";
  stage.unit = "iteration";
  stage.on_controller = true;
  stage.calls = 3;
  stage.single = stage.parallel = Cycles(1'500'000);
  stage.worst_parallel = Cycles(600'000);
  stage.account.team[sim::Mechanism::Issue] = 1'500'000;
  stage.memory.single = stage.memory.parallel = Bytes(743'600);
  return stage;
}

inline FrameResult frame(int index, PoseSource source, bool keyframe, std::int64_t latency_ns) {
  FrameResult f;
  f.index = index;
  f.t_ns = 1'000'000'000 + 50'000'000 * std::int64_t{index};
  f.source = source;
  f.keyframe = keyframe;
  f.features = 100 + index;
  f.world_matches = 40;
  f.frame_matches = 60;
  f.inliers = 30;
  f.landmarks = 200;
  f.arrival_ns = 50'000'000 * std::int64_t{index};
  f.start_ns = f.arrival_ns + (index == 3 ? 2'500'000 : 0);
  f.end_ns = f.arrival_ns + latency_ns;
  f.cycles = Cycles(latency_ns / 10);
  f.single_cycles = Cycles(latency_ns / 2);
  f.pose.t_ns = f.t_ns;
  f.pose.T_world_body.translation() = Eigen::Vector3d(0.5 * index, 0, 0);
  return f;
}

/// 100 MHz cluster, 50 MHz controller, 128 kB of L1 and 1600 kB of L2, 20 frames per second.
inline RunResult example_run() {
  RunResult run;
  run.profile = "levio";
  run.cores = 4;
  run.cluster_clock = Hertz(100'000'000);
  run.controller_clock = Hertz(50'000'000);
  run.l1_size = Bytes(131'072);
  run.l2_size = Bytes(1'638'400);
  run.frame_period_ns = 50'000'000;
  run.image_width = 160;
  run.image_height = 120;
  run.stages = {parallel_stage(), stage_without_calls(), controller_stage()};
  run.frames = {frame(0, PoseSource::First, true, 10'000'000),
                frame(1, PoseSource::EightPoint, false, 20'000'000),
                frame(2, PoseSource::EightPoint, true, 60'000'000),
                frame(3, PoseSource::Epnp, false, 30'000'000),
                frame(4, PoseSource::Epnp, false, 40'000'000)};
  for (const FrameResult& f : run.frames) run.trajectory.push_back(f.pose);
  run.l2 = {
      {"last keyframe",
       Bytes(50'900),
       {block("keypoints", 2'816), block("image", 19'200), block("count", 4), block("flags", 49)}},
      {"optimiser", Bytes(743'600), {block("landmark records", 700'000)}}};
  run.optimiser_published = 1;
  run.optimiser_late = 2;
  traces::Evaluation ate;
  ate.translation = {0.176, 0.15, 0.14, 0.47};
  ate.rotation_rmse_deg = 2.5;
  ate.matched = 5;
  ate.estimates = 5;
  ate.completion = 1;
  ate.path_length_m = 5.4;
  ate.protocol =
      "SE3-aligned, 5 of 5 poses matched with interpolated truth (a sample within 10 ms), "
      "completion 100.0 % (5 expected poses), 5.40 m of path";
  run.ate = ate;
  run.host_seconds = 2.5;
  return run;
}

}  // namespace leviosim::tools::testing
