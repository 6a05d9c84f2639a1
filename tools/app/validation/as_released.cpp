#include "tools/app/validation/as_released.h"

#include <algorithm>
#include <string>

namespace leviosim::tools {

std::optional<RunOptions> paper_keypoints(RunOptions options) {
  if (options.profile != "levio") return std::nullopt;
  for (const std::string_view set : kPaperKeypoints) {
    const std::string_view parameter = set.substr(0, set.find('=') + 1);
    for (const std::string& given : options.overrides)
      if (given.starts_with(parameter)) return std::nullopt;
  }
  options.overrides.insert(options.overrides.end(), kPaperKeypoints.begin(), kPaperKeypoints.end());
  return options;
}

RunOptions as_released(RunOptions options) {
  if (options.profile != "levio") return options;
  const std::string parameter = "workload.released=";
  const bool said = std::any_of(options.overrides.begin(), options.overrides.end(),
                                [&](const std::string& set) { return set.starts_with(parameter); });
  if (!said) options.overrides.push_back(parameter + "on");
  return options;
}

}  // namespace leviosim::tools
