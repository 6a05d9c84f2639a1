// One point of a plan made ready to run, with all that can be said against it.
#pragma once

#include <string>
#include <vector>

#include "tools/app/study/point.h"
#include "tools/app/study/sweep/plan.h"

namespace leviosim::tools {

struct ResolvedPoint : Point {
  platform::PlatformFile* chip = nullptr;  ///< the inputs'
  std::vector<std::string> overrides;      ///< of the chip
  std::vector<IdentityLine> identity;
};

/// @param where  begins the messages
/// @throws InputError for a point that contradicts itself or its inputs
ResolvedPoint resolve(const SweepPlan& plan, const SweepRow& settings, SweepInputs& inputs,
                      const std::string& where);

}  // namespace leviosim::tools
