#include "tools/app/validation/released_work.h"

#include <algorithm>

namespace leviosim::tools {

RunOptions as_released(RunOptions options) {
  if (options.profile != "levio") return options;
  const std::string parameter = "workload.released=";
  const bool said = std::any_of(options.overrides.begin(), options.overrides.end(),
                                [&](const std::string& set) { return set.starts_with(parameter); });
  if (!said) options.overrides.push_back(parameter + "on");
  return options;
}

}  // namespace leviosim::tools
