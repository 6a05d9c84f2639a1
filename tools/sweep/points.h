// A plan expanded: every point checked, each different one once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/run/run_request.h"
#include "tools/sweep/plan.h"

namespace leviosim::tools {

/// What a key of the plan is at a point, set there or not.
struct PointParameter {
  std::string name;
  std::string text;              ///< "240MHz"
  std::optional<double> number;  ///< toggles are 0 or 1; none for names
  std::string unit;
};

struct SweepPoint {
  int number = 0;                          ///< from 1
  SweepRow settings;                       ///< with those of the base
  std::vector<PointParameter> parameters;  ///< in the order of SweepPlan::keys
  std::string key;                         ///< point_key()
};

/// A point made ready to run.
struct ResolvedPoint {
  RunRequest request;
  const traces::WorkTrace* trace = nullptr;  ///< replayed if there is one
  std::string identity;                      ///< for point_key()
};

/// @param where  begins the messages
/// @throws InputError for a point that contradicts itself or its inputs
ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where);

struct Expansion {
  std::vector<SweepPoint> points;
  std::size_t asked = 0;                ///< points of the plan, repetitions included
  std::vector<std::string> impossible;  ///< why points were left out, if the plan says skip
};

/// @throws InputError for points that cannot be
Expansion expand(const SweepPlan& plan, SweepInputs& inputs);

/// "platform.cluster.clock=240MHz workload.window=6", in the order of SweepPlan::keys.
std::string settings_text(const SweepPoint& point);

}  // namespace leviosim::tools
