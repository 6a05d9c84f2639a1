// One point of a plan made ready to run, with all that can be said against it.
#pragma once

#include <string>
#include <vector>

#include "tools/app/run/run_request.h"
#include "tools/app/study/sweep/plan.h"

namespace leviosim::tools {

/// A part of what a point is.
struct IdentityLine {
  std::string key;   ///< of a plan that sets it, such as "seed"; empty if none does by itself
  std::string text;  ///< "seed 1\n"
};

struct ResolvedPoint {
  RunRequest request;
  const traces::WorkTrace* trace = nullptr;  ///< replayed if there is one
  platform::PlatformFile* chip = nullptr;    ///< the inputs'
  std::vector<std::string> overrides;        ///< of the chip
  std::vector<IdentityLine> identity;
};

/// @param where  begins the messages
/// @throws InputError for a point that contradicts itself or its inputs
ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where);

/// All that the point is, for point_key().
std::string identity_text(const ResolvedPoint& point);

}  // namespace leviosim::tools
