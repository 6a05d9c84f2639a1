// The record of a run: facts about its inputs, its figures, its verdicts, and where its cycles
// went. It has one form on disk, JSON, of which a reader takes as much as it needs: all in the
// folder of a run; what comparisons and budgets are made of in a baseline and in a line of a
// history; figures alone in a point of a sweep and in the cache of finished runs.
//
//   {"format":"leviosim run","version":1,
//    "verdicts":[{"about":"time","grade":"good","word":"fits","reasons":[…]},…],
//    "program":"0.1.0 ea42…","facts":{…},
//    "statistics":{"frame.time.mean":[43.3e6,"ns","time that a frame takes by itself"],…},
//    "stages":[{"name":"EPnP RANSAC","key":"epnp_ransac","controller":false,"cycles":8123,
//               "parts":{"score":{"issue f32_fma":[812,3401],…},…}},…]}
//
// Left out: frames, blocks of memory and poses, which are tables of the folder (run/run_folder.h).
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/app/record/cycle_parts.h"
#include "tools/app/record/json_reader.h"
#include "tools/app/result/run_figures.h"
#include "tools/app/table/json.h"

namespace leviosim::tools {

struct RunFacts {
  bool measured = false;  ///< elsewhere (measured.h): nothing is known but profile and platform
  std::string program;    ///< "0.1.0 ea4229934d2b"
  std::string profile;
  std::vector<std::string> workload;  ///< parameters that were set
  std::uint32_t seed = 1;
  std::string platform;  ///< as requested; empty for a native run
  std::vector<std::string> overrides;
  int cores = 0;
  std::string camera;  ///< of a closed loop, "10 frames/s, drop"; else empty
  int image_width = 0;
  int image_height = 0;
  std::int64_t first_frame = 0;
  std::int64_t frames = 0;
  std::vector<std::pair<std::string, std::string>> inputs;  ///< of the data: name → SHA-256

  friend bool operator==(const RunFacts&, const RunFacts&) = default;
};

struct RunRecord : RunFigures {
  std::string name = {};  ///< in the words of the user; in no file
  RunFacts facts = {};
  std::vector<StageParts> cycles = {};  ///< empty of what was measured elsewhere
  /// Of a point of a study: why it has no figures, such as too little L1. Else empty.
  std::string failure = {};

  /// Null if there is no such stage.
  const StageParts* stage_parts(std::string_view stage) const;
};

/// How much of a record is kept.
enum class Level {
  figures,  ///< statistics, but not those by operation, mechanism, block and domain
  kept,     ///< the statistics that most budgets are about, and the larger parts of all cycles
  all
};

/// @param further  statistics to keep besides, at Level::kept
/// @throws InputError at Level::kept for a record without a breakdown of cycles
RunRecord reduced(const RunRecord& record, Level level, const std::set<std::string>& further = {});

/// The form without format and version, as in a line of a file that has its own.
Json record_json(const RunRecord& record);
/// @param where  of the text, for messages
/// @param least  that has to be there
/// @throws InputError for what record_json() never wrote
RunRecord record_of_json(const std::string& where, const Json& json, Level least);

/// The content of a file: a statistic, a fact or a stage on a line, so that two files can be
/// compared line by line.
std::string record_text(const RunRecord& record);
/// @throws InputError for other texts, and for older files with what to do about them
RunRecord parse_record(const std::string& where, std::string_view text, Level least);

/// The facts alone.
Json facts_json(const RunFacts& facts);

}  // namespace leviosim::tools
