// Work traces written byte by byte (traces/work_traces/FORMAT.md), with checksums that are right:
// what no recording gives. Tests of what the reader refuses make them, small files that stand for
// much among them.
#pragma once

#include <string>
#include <vector>

#include "sim/work/op.h"
#include "traces/work_traces/bytes.h"
#include "traces/work_traces/section_file.h"
#include "traces/work_traces/work_columns.h"
#include "traces/work_traces/work_trace.h"

namespace leviosim::traces::testing {

inline std::string bytes(std::initializer_list<std::uint64_t> wholes) {
  ByteWriter out;
  for (const std::uint64_t value : wholes) out.whole(value);
  return out.take();
}

inline std::string text(std::string_view value) {
  ByteWriter out;
  out.text(value);
  return out.take();
}

/// The same bytes so many times.
inline std::string times(std::size_t n, std::string_view one) {
  std::string all;
  all.reserve(n * one.size());
  for (std::size_t i = 0; i < n; ++i) all += one;
  return all;
}

/// A list of n things that are all the same.
inline std::string list(std::size_t n, std::string_view one) { return bytes({n}) + times(n, one); }

/// A trace as its parts: each is as it stands in the file.
struct TraceParts {
  std::string platform_yaml;
  std::string inputs = list(0, "");
  std::uint64_t cores = 1;
  std::uint64_t frame_period_ns = 50'000'000;
  std::string stages = list(0, "");
  std::string names = list(1, text("first"));
  std::string memories = list(0, "");
  std::vector<std::uint64_t> chunk_frames{1};
  std::string stamps = list(1, bytes({2}));
  std::vector<std::string> frames;   ///< contents of the sections of frames
  std::vector<std::string> offload;  ///< contents of those of kernels; empty: there are no kernels
  std::size_t segments = 0;          ///< of work in each section of frames, where offload is empty

  std::string summary() const {
    ByteWriter out;
    out.append("summary\n");
    for (const std::string& one : {std::string("a test"), std::string("none"), std::string("none"),
                                   std::string("gap9"), platform_yaml})
      out.text(one);
    for (const std::uint64_t value : {1, 0}) out.whole(value);  // seed, first frame
    out.append(inputs);
    for (const std::uint64_t value : {cores, std::uint64_t{160}, std::uint64_t{120}})
      out.whole(value);
    out.whole(frame_period_ns);
    out.whole(work::kOpCount);
    for (const work::OpInfo& op : work::kOps) out.text(op.name);
    out.whole(work::kReuseDistances.size());
    for (const std::uint32_t end : work::kReuseDistances) out.whole(end);
    out.whole(work::kCompiledFor.size());
    for (const std::string_view set : work::kCompiledFor) out.text(set);
    out.whole(work::kCompiledCount);
    out.append(stages);
    out.append(list(5, text("fact")));
    out.byte(0);  // no accuracy
    for (const std::string* part : {&names, &memories}) out.append(*part);
    out.whole(chunk_frames.size());
    for (const std::uint64_t n : chunk_frames) out.whole(n);
    out.append(stamps);
    return out.take();
  }

  std::string file() const {
    std::string all = file_head(kWorkTraceFile);
    const std::string no_kernels = text(list(0, "")) + text("") + std::string(segments, '\0');
    for (std::size_t i = 0; i < frames.size(); ++i)
      all += packed_section(frames[i], 1) +
             packed_section(offload.empty() ? no_kernels : offload[i], 1);
    return all + packed_section(summary(), 1);
  }
};

/// A series of work segments that all count the same of one counter.
inline std::string constant_series(std::uint64_t counter, std::uint64_t value) {
  return value == 0 ? bytes({0, 0, 0}) : bytes({1, counter, value, 0, 0});
}

/// A section of frames. @param series  a list of them
inline std::string section(std::size_t frames, const std::string& series,
                           const std::string& of_frames) {
  return bytes({frames}) + text(series) + text("") + of_frames;
}

/// A frame up to its jobs. @param flags  4: an optimisation begins
/// @param seen  the frame whose optimisation it sees, plus one: 0 is none
inline std::string frame_facts(std::uint64_t flags = 0, std::int64_t seen = -1) {
  ByteWriter out;
  for (const std::uint64_t value : {std::uint64_t{0}, std::uint64_t{0}, flags}) out.whole(value);
  for (int i = 0; i < 5; ++i) out.whole(0);  // facts
  for (int i = 0; i < 12; ++i) out.f64(0);
  out.whole(0);  // start
  out.integer(seen);
  return out.take();
}

inline const std::string kNoPeak = bytes({0, 0, 0, 0});  ///< written out, without blocks

/// A stage run with its steps. @param name  its number
inline std::string stage(const std::string& steps, std::uint64_t name = 0,
                         const std::string& peak = kNoPeak) {
  return bytes({name}) + peak + steps;
}

/// A frame with one job.
inline std::string frame(const std::string& stages) { return frame_facts() + stages; }

}  // namespace leviosim::traces::testing
