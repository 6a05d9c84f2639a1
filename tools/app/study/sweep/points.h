// The points of a group of a plan, in an order that depends on nothing but the plan.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/platform_file.h"
#include "tools/app/study/point.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/sweep_inputs.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {

/// A sweep has no more points than this.
inline constexpr std::size_t kMostPoints = 100'000;

/// One dimension of `count` points of the unit cube, drawn evenly, in [0, 1). A point does not
/// depend on how many there are.
std::vector<double> random_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

/// One dimension of a Latin hypercube (McKay, Beckman and Conover, Technometrics 21(2), 1979): if
/// it is cut into `count` equal strata, every stratum holds exactly one point.
std::vector<double> latin_draws(std::size_t count, std::size_t dimension, std::uint64_t seed);

/// The rows of a group: the last key of a grid and the last member vary fastest.
/// @throws InputError for more than kMostPoints, Interrupted
std::vector<SweepRow> rows_of(const SweepGroup& group);

/// What a sweep keeps of a point, for point_key().
inline constexpr std::string_view kSweepFigures = "figures of a sweep";

struct ResolvedPoint : Point {
  platform::PlatformFile* chip = nullptr;  ///< the inputs'
  std::vector<std::string> overrides;      ///< of the chip
  std::string identity;                    ///< identity_of()
};

/// @param where  begins the messages
/// @throws InputError for a point that contradicts itself or its inputs
ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where);

/// What a key of the plan is at a point, set there or not.
struct PointParameter {
  std::string name;
  std::string text;                ///< "240MHz"
  std::optional<double> number{};  ///< toggles are 0 or 1; none for names
  std::string unit{};
};

struct SweepPoint {
  int number = 0;                          ///< from 1
  SweepRow settings;                       ///< with those of the base
  std::vector<PointParameter> parameters;  ///< in the order of SweepPlan::keys
  std::string key;                         ///< point_key()

  /// "platform.cluster.clock=240MHz workload.window=6".
  std::string settings_text() const;
};

struct Expansion {
  std::vector<SweepPoint> points;
  std::size_t asked = 0;           ///< points of the plan, repetitions included
  std::size_t impossible = 0;      ///< points that were left out, if the plan says skip
  std::string first_impossible{};  ///< why the first was
};

/// @throws InputError for points that cannot be, Interrupted
Expansion expand(const SweepPlan& plan, SweepInputs& inputs);

}  // namespace leviosim::tools
