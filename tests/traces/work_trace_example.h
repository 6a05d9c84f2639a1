// A small work trace, made by hand, with every kind of step: tests write it, read it and break it.
#pragma once

#include <gtest/gtest.h>

#include "sim/work/op.h"
#include "traces/work_traces/work_frames.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::traces::testing {

inline work::Counts counts(std::uint64_t loops) {
  work::Counts c;
  c[work::Op::LoopIteration] = loops;
  c[work::Op::F32Fma] = 3 * loops + 2;
  c[work::Op::BranchTaken] = loops / 3;
  c.code[5] = 16 * (loops % 7);
  c.code[work::kNeverFetched] = 480;
  const work::CompiledWork compiled{9 * loops, 8 * loops, loops, loops / 4, 2 * loops, 3 * loops};
  for (std::size_t set = 0; set < work::kCompiledFor.size(); ++set) {
    work::CompiledWork of_set = compiled;
    of_set[0] += set * loops;
    work::set_compiled(c.compiled, static_cast<work::CompiledFor>(set), of_set);
  }
  return c;
}

/// The work segment with calls of two kernels in it.
inline work::Segment with_offload(work::Segment segment, std::uint64_t calls) {
  work::Counts of_calls;
  of_calls[work::Op::F32Fma] = segment[work::Op::F32Fma] / 3;
  work::Counts of_others;
  of_others[work::Op::LoopIteration] = segment[work::Op::LoopIteration] / 2;
  segment.offload = {{work::OffloadKind::Eigen12, calls, 5 * calls, of_calls},
                     {work::OffloadKind::Hamming, 1, calls, of_others}};
  return segment;
}

inline work::StageRun cluster_stage(int frame) {
  const auto n = static_cast<std::uint64_t>(frame);
  work::StageRun stage{"matching", {}, {Bytes(900 + frame % 2), Bytes(500), {}}};
  stage.memory.blocks = {{"image", Bytes(0), Bytes(300)}, {"scratch", Bytes(300), Bytes(600)}};
  stage.steps.emplace_back(work::Serial{counts(10 + n)});
  stage.steps.emplace_back(work::Transfer{work::Direction::L2ToL1, Bytes(300), true, Bytes(20)});
  stage.steps.emplace_back(
      work::Fork{"compare", {counts(1000 + n * n), counts(990), counts(n)}, false});
  stage.steps.emplace_back(work::TransferWait{0});
  stage.steps.emplace_back(
      work::Fork{"detect", {counts(70), counts(71), counts(72), counts(5 * n)}, true});
  stage.steps.emplace_back(work::Transfer{work::Direction::L1ToL2, Bytes(8 + frame), false});
  stage.steps.emplace_back(work::Serial{counts(3)});
  return stage;
}

/// An optimisation begins with every even frame; its result is seen one frame later.
inline WorkFrame example_frame(int frame) {
  WorkFrame f;
  f.index = frame;
  f.t_ns = 1'403'636'579'763'555'584 + 50'000'000 * std::int64_t{frame};
  f.source = frame == 0 ? "first" : "epnp";
  f.keyframe = frame % 3 == 0;
  f.facts = {300 + frame, 40, 50, 30, 999};
  f.T_world_body.translation() = Eigen::Vector3d(0.1 * frame, -1e-9, 2);
  f.start_ns = 50'000'000 * std::int64_t{frame};
  f.optimised = frame % 2 == 0;
  f.seen = frame == 0 ? -1 : (frame - 1) / 2 * 2;
  f.front_end.stages = {cluster_stage(frame), cluster_stage(frame + 1)};
  if (!f.optimised) return f;
  work::StageRun iteration{"iteration", {}, {Bytes(5000), Bytes(5000), {}}};
  iteration.steps.emplace_back(work::Serial{counts(12345 + 7 * static_cast<std::uint64_t>(frame))});
  iteration.steps.emplace_back(work::Transfer{work::Direction::ExternalToL2, Bytes(64), false});
  f.iterations = {work::Job{{iteration}}, work::Job{{iteration}}};
  return f;
}

/// The same with offload regions in some of its work.
inline WorkFrame example_frame_with_offload(int frame) {
  WorkFrame f = example_frame(frame);
  for (work::StageRun& stage : f.front_end.stages)
    for (work::Step& step : stage.steps) {
      if (auto* fork = std::get_if<work::Fork>(&step)) {
        fork->shares.front() = with_offload(fork->shares.front(), 3);
        fork->shares.back() =
            with_offload(fork->shares.back(), static_cast<std::uint64_t>(frame + 1));
      }
    }
  for (work::Job& job : f.iterations) {
    auto& serial = std::get<work::Serial>(job.stages.at(0).steps.at(0));
    serial.counts = with_offload(serial.counts, 1);
  }
  return f;
}

inline WorkTraceInfo example_info() {
  WorkTraceInfo info;
  info.program = "leviosim";
  info.profile = "levio";
  info.data = "synthetic";
  info.platform = "gap9";
  info.platform_yaml = "format: none";
  info.image_width = 160;
  info.image_height = 120;
  info.frame_period_ns = 50'000'000;
  info.stages = {{"matching", "frame", false}, {"iteration", "iteration", true}};
  info.facts = {"features", "world_matches", "frame_matches", "inliers", "landmarks"};
  info.l2 = {{"pose graph", Bytes(40), {{"poses", Bytes(0), Bytes(40)}}}};
  info.ate = Evaluation{};
  info.ate->translation = {0.25, 0.125, 0.1, 0.75};
  info.ate->size_ratio = 1.5;
  info.ate->located_rmse_m = 0.2;
  info.ate->protocol = "aligned";
  info.inputs = {{"imu0/data.csv", "c0ffee"}};
  return info;
}

inline std::string example_trace(int frames) {
  WorkTraceWriter writer(3);
  for (int i = 0; i < frames; ++i) writer.add(example_frame(i));
  return writer.finish(example_info());
}

inline std::string example_trace_with_offload(int frames) {
  WorkTraceWriter writer(3);
  for (int i = 0; i < frames; ++i) writer.add(example_frame_with_offload(i));
  return writer.finish(example_info());
}

inline void expect_equal(const work::StageRun& a, const work::StageRun& b) {
  EXPECT_EQ(a.stage, b.stage);
  EXPECT_EQ(a.memory.parallel, b.memory.parallel);
  EXPECT_EQ(a.memory.single, b.memory.single);
  ASSERT_EQ(a.memory.blocks.size(), b.memory.blocks.size());
  for (std::size_t i = 0; i < a.memory.blocks.size(); ++i) {
    EXPECT_EQ(a.memory.blocks[i].name, b.memory.blocks[i].name);
    EXPECT_EQ(a.memory.blocks[i].offset, b.memory.blocks[i].offset);
    EXPECT_EQ(a.memory.blocks[i].size, b.memory.blocks[i].size);
  }
  ASSERT_EQ(a.steps.size(), b.steps.size());
  for (std::size_t i = 0; i < a.steps.size(); ++i) {
    ASSERT_EQ(a.steps[i].index(), b.steps[i].index());
    if (const auto* serial = std::get_if<work::Serial>(&a.steps[i])) {
      EXPECT_EQ(serial->counts, std::get<work::Serial>(b.steps[i]).counts);
    }
    if (const auto* fork = std::get_if<work::Fork>(&a.steps[i])) {
      const auto& other = std::get<work::Fork>(b.steps[i]);
      EXPECT_EQ(fork->name, other.name);
      EXPECT_EQ(fork->shares, other.shares);
      EXPECT_EQ(fork->master_takes_part, other.master_takes_part);
      EXPECT_EQ(fork->aligned_on_one_core, other.aligned_on_one_core);
    }
    if (const auto* transfer = std::get_if<work::Transfer>(&a.steps[i])) {
      const auto& other = std::get<work::Transfer>(b.steps[i]);
      EXPECT_EQ(transfer->direction, other.direction);
      EXPECT_EQ(transfer->bytes, other.bytes);
      EXPECT_EQ(transfer->background, other.background);
      EXPECT_EQ(transfer->more, other.more);
    }
    if (const auto* wait = std::get_if<work::TransferWait>(&a.steps[i])) {
      EXPECT_EQ(wait->number, std::get<work::TransferWait>(b.steps[i]).number);
    }
  }
}

inline void expect_equal(const work::Job& a, const work::Job& b) {
  ASSERT_EQ(a.stages.size(), b.stages.size());
  for (std::size_t i = 0; i < a.stages.size(); ++i) expect_equal(a.stages[i], b.stages[i]);
}

inline void expect_equal(const WorkFrame& a, const WorkFrame& b) {
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.t_ns, b.t_ns);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.keyframe, b.keyframe);
  EXPECT_EQ(a.facts, b.facts);
  EXPECT_EQ(a.T_world_body.matrix(), b.T_world_body.matrix());
  EXPECT_EQ(a.start_ns, b.start_ns);
  EXPECT_EQ(a.optimiser_busy, b.optimiser_busy);
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.optimised, b.optimised);
  expect_equal(a.front_end, b.front_end);
  ASSERT_EQ(a.iterations.size(), b.iterations.size());
  for (std::size_t i = 0; i < a.iterations.size(); ++i)
    expect_equal(a.iterations[i], b.iterations[i]);
}

/// Everything that a replay reads. @param offload  on a chip with accelerators
inline int read_all(const WorkTrace& trace, bool offload = true) {
  WorkFrames reader(trace, offload);
  int frames = 0;
  for (WorkFrame frame; reader.next(frame);) ++frames;
  return frames;
}

}  // namespace leviosim::traces::testing
