// Small work traces that stand for far more memory than a trace may take: one for each thing of
// which a trace says how many there are.
#pragma once

#include <ostream>

#include "sim/work/offload_regions.h"
#include "tests/traces/trace_parts.h"

namespace leviosim::traces::testing {

struct TraceBomb {
  const char* name;     ///< letters only
  const char* refusal;  ///< part of it
  /// @param whole  with the platform that commands load before they read frames
  std::string (*file)(TraceParts whole);

  friend void PrintTo(const TraceBomb& bomb, std::ostream* out) { *out << bomb.name; }
};

/// With one section of one frame. @param segments  of work in it
inline std::string trace_of_frame(TraceParts parts, const std::string& series,
                                  const std::string& of_frame, std::size_t segments = 0) {
  parts.frames = {section(1, series, of_frame)};
  parts.segments = segments;
  return parts.file();
}

/// With one part of the summary replaced.
inline std::string trace_with(TraceParts parts, std::string TraceParts::*part,
                              std::string content) {
  parts.*part = std::move(content);
  return trace_of_frame(parts, list(0, ""), frame(list(0, "")));
}

inline const std::string kNoSeries = list(0, "");
inline const std::string kOneSeries = list(1, constant_series(0, 0));
inline const std::string kSerialStep = bytes({0, 0});
inline const std::string kNoJob = frame(list(0, ""));
inline const std::string kSamePeakNoSteps = bytes({0, 1, 0});
constexpr std::size_t kMillion = 1'000'000;

inline const TraceBomb kTraceBombs[] = {
    {"Inputs", "inputs",
     [](TraceParts whole) {
       return trace_with(whole, &TraceParts::inputs, list(20 * kMillion, text("") + text("")));
     }},
    {"Stages", "stages",
     [](TraceParts whole) {
       return trace_with(whole, &TraceParts::stages,
                         list(20 * kMillion, text("") + text("") + bytes({0})));
     }},
    {"Names", "names",
     [](TraceParts whole) {
       return trace_with(whole, &TraceParts::names, list(50 * kMillion, text("")));
     }},
    {"Memories", "memories",
     [](TraceParts whole) {
       return trace_with(whole, &TraceParts::memories, list(25 * kMillion, bytes({0, 0, 0})));
     }},
    {"BlocksOfMemories", "blocks of memory",
     [](TraceParts whole) {
       return trace_with(whole, &TraceParts::memories,
                         bytes({1, 0, 0}) + list(50 * kMillion, bytes({0, 0, 0})));
     }},
    {"Stamps", "time stamps",
     [](TraceParts whole) {
       return trace_with(whole, &TraceParts::stamps, list(140 * kMillion, bytes({2})));
     }},
    {"Series", "series",
     [](TraceParts whole) {
       return trace_of_frame(whole, list(3 * kMillion, constant_series(0, 0)), kNoJob);
     }},
    {"Columns", "columns of a series",
     [](TraceParts whole) {
       return trace_of_frame(whole, bytes({1, 0}) + list(30 * kMillion, bytes({0, 0})) + bytes({0}),
                             kNoJob);
     }},
    {"Sums", "sums of a series",
     [](TraceParts whole) {
       return trace_of_frame(whole, bytes({1, 0, 0}) + list(40 * kMillion, bytes({0, 0})), kNoJob);
     }},
    {"Terms", "terms of a sum",
     [](TraceParts whole) {
       return trace_of_frame(whole, bytes({1, 0, 0, 1, 0}) + list(80 * kMillion, bytes({0, 0})),
                             kNoJob);
     }},
    {"StagesOfAJob", "stages of a job",
     [](TraceParts whole) {
       return trace_of_frame(whole, kNoSeries,
                             frame(bytes({1 + 20 * kMillion}) + stage(list(0, "")) +
                                   times(20 * kMillion, kSamePeakNoSteps)));
     }},
    {"Steps", "steps of a stage",
     [](TraceParts whole) {
       return trace_of_frame(whole, kOneSeries, frame(list(1, stage(list(5 * kMillion, kSerialStep)))));
     }},
    {"Blocks", "blocks of memory",
     [](TraceParts whole) {
       const std::string peak = bytes({0, 0, 0}) + list(50 * kMillion, bytes({0, 0, 0}));
       return trace_of_frame(whole, kNoSeries, frame(list(1, stage(list(0, ""), 0, peak))));
     }},
    {"BlocksOfTheSamePeak", "blocks of memory",
     [](TraceParts whole) {
       const std::string peak = bytes({0, 0, 0}) + list(20'000, bytes({0, 0, 0}));
       return trace_of_frame(
           whole, kNoSeries,
           frame(bytes({20'001}) + stage(list(0, ""), 0, peak) + times(20'000, kSamePeakNoSteps)));
     }},
    {"Iterations", "iterations",
     [](TraceParts whole) {
       return trace_of_frame(whole, kNoSeries,
                             frame_facts(4) + list(0, "") + list(80 * kMillion, bytes({0})));
     }},
    {"SharesOfManyCores", "shares of a fork",
     [](TraceParts whole) {
       whole.cores = 1023;
       return trace_of_frame(whole, kOneSeries,
                             frame(list(1, stage(list(20'000, bytes({1, 0, 0}))))),
                             20'000 * whole.cores);
     }},
    {"OffloadRegions", "offload regions",
     [](TraceParts whole) {
       whole.cores = 10;
       whole.names = bytes({work::kOffloadKindCount});
       std::string calls = bytes({work::kOffloadKindCount});
       for (std::size_t k = 0; k < work::kOffloadKindCount; ++k) {
         whole.names += text(work::kOffloadKinds[k].name);
         calls += bytes({k, 0, 0, 0});
       }
       whole.offload = {text(kOneSeries) + text("") + times(301'000, calls)};
       return trace_of_frame(whole, kOneSeries,
                             frame(list(1, stage(list(30'000, bytes({1, 0, 0}))))));
     }},
    {"Content", "the content of the section",
     [](TraceParts whole) {
       const std::string zeros(200 * kMillion, '\0');
       whole.offload = {zeros};
       return trace_of_frame(whole, kNoSeries, kNoJob + zeros);
     }},
};

}  // namespace leviosim::traces::testing
