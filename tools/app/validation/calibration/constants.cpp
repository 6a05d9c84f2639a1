#include "tools/app/validation/calibration/constants.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/nearest.h"
#include "sim/base/text.h"

namespace leviosim::tools {
namespace {

void check_fittable(const std::string& option, const std::string& path) {
  std::vector<std::string> known;
  for (const FittableConstant& constant : kFittableConstants) known.emplace_back(constant.path);
  if (std::find(known.begin(), known.end(), path) != known.end()) return;
  throw InputError(
      fmt::format("{} '{}': is no constant that may be fitted{}; expected up to {} of {}", option,
                  path, base::did_you_mean(path, known), kMostConstants, fmt::join(known, ", ")));
}

}  // namespace

std::vector<std::string> parse_constants(const std::string& option, const std::string& text) {
  std::vector<std::string> paths = base::split(text, ',');
  for (const std::string& path : paths) check_fittable(option, path);
  if (paths.size() > kMostConstants)
    throw InputError(fmt::format("{} '{}': {} constants; expected at most {}", option, text,
                                 paths.size(), kMostConstants));
  for (const std::string& path : paths)
    if (std::count(paths.begin(), paths.end(), path) > 1)
      throw InputError(fmt::format("{} '{}': {} is there twice", option, text, path));
  return paths;
}

std::vector<Bounded> bounds_of(const platform::Variants& platform,
                               const std::vector<std::string>& paths) {
  std::vector<Bounded> constants;
  for (const std::string& path : paths) {
    const platform::Parameter* parameter = platform.find(path);
    if (parameter == nullptr)
      throw InputError(
          fmt::format("platform {}: does not give {}", platform.platform().name, path));
    if (!parameter->range)
      throw InputError(fmt::format("platform {}: {} has no range to be fitted within (source: {})",
                                   platform.platform().name, path, parameter->source));
    const auto value = platform::parse_number(parameter->value);
    check(value.has_value(), "a resolved parameter is no number");
    constants.push_back(
        {path, parameter->unit, *value, parameter->range->low, parameter->range->high});
  }
  return constants;
}

}  // namespace leviosim::tools
