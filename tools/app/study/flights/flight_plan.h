// What a benchmark of flights runs: motions, texture worlds in sets, pieces, variants of the
// workload, seeds. A plan is part of the program and has a name, or a file:
//
//   motions: [MH_01_easy, V1_02_medium]      # folders, where the user says
//   worlds:                                   # seeds of what is drawn, or workshop:1, 0.3m:1
//                                             # (place.h), in sets
//     development: [1, 2, 3]
//     fresh: [4, 5, 6]
//   pieces: [90, 400, rest, whole]            # frames from every start in mid-air; from there to
//                                             # the end; whole flights
//   every: 20                                 # seconds from start to start [20]
//   recordings: [MH_01_easy_t05_t20]          # folders with pictures, beside or without motions
//   starts:                                   # in recordings: the first frame and the step,
//                                             # in sets
//     even: [0, 20]
//     odd: [10, 20]
//   disturbances: [none, noise=10]            # of all pieces (disturbance.h) [none]
//   seeds: [1, 2, 3]                          # of the workload's random draws [1, 2, 3]
//   size: 160x120                             # of the images [160x120]
//   variants:                                 # [next]
//     - { profile: next, workload.window: 8 }
//
// All faults are InputErrors with file, line, key and the nearest valid name.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "sim/base/builtin_file.h"
#include "traces/datasets/disturbance.h"
#include "traces/datasets/image_file.h"
#include "traces/synthesis/place.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {

/// In place of a number of frames: from the first to the last.
inline constexpr std::size_t kWholeFlight = 0;
/// In place of a number of frames: from every start to the last frame, where that is longer than
/// all pieces of the plan that have a number.
inline constexpr std::size_t kRest = std::numeric_limits<std::size_t>::max();

/// The fewest of a piece: that can be aligned.
inline constexpr std::size_t kFewestFrames = 3;

/// "90 frames", "rest", "whole".
std::string length_text(std::size_t frames);

struct FlightSet {
  std::string name;                   ///< "fresh"
  std::vector<traces::Place> worlds;  ///< in which motions are drawn; none: recordings as they are
  std::size_t first = 0;              ///< frame of a recording at which its first piece begins
  std::size_t step = 1;               ///< frames from there to the next one

  bool recorded() const { return worlds.empty(); }
  /// "worlds 1, 2, 3", "frames 10, 30, ...".
  std::string text() const;
};

struct FlightVariant {
  std::string profile;
  std::vector<vio::Assignment> workload;  ///< parameters that differ from the profile's

  /// "next window=8".
  std::string name() const;
};

struct FlightPlan {
  std::string name;  ///< or file
  std::string text;
  std::vector<std::string> motions;
  std::vector<std::string> recordings;
  std::vector<FlightSet> sets;
  std::vector<std::size_t> lengths;               ///< of the pieces, in frames; kRest, kWholeFlight
  std::vector<traces::Disturbance> disturbances;  ///< of every piece; never empty
  double every_s = 20;
  std::vector<std::uint32_t> seeds{1, 2, 3};
  traces::ImageSize size{160, 120};
  std::vector<FlightVariant> variants;
};

/// plans/*.yaml as part of the program, sorted by name.
std::span<const base::BuiltinFile> builtin_flight_plans();

/// A plan of the program, or that of a file if the name has a slash or ends in .yaml.
/// @throws InputError
FlightPlan flight_plan_named(const std::string& name);
/// The same from its text. @param file  for messages
FlightPlan parse_flight_plan(const std::string& file, const std::string& text);

/// Refuses parameters that contradict each other, and variants that are the same. @throws
/// InputError that names the variant
void check_variants(const FlightPlan& plan);

}  // namespace leviosim::tools
