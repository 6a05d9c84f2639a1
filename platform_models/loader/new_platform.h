// A file to begin a chip of one's own with.
#pragma once

#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "platform_models/loader/parameter.h"

namespace leviosim::platform {

/// What a number was found at, so that it may not hold on a chip where that differs.
struct Dependence {
  std::string_view mark;     ///< in the file, in parentheses: "clock"
  std::string_view meaning;  ///< a line
};
std::vector<Dependence> dependences();

/// The marks of a parameter, in the order of dependences().
std::vector<std::string_view> marks_of(const Parameter& parameter);

/// A platform file with everything of `from` under another name: what each number is, its source,
/// and the marks of those that depend on what the new chip may have otherwise. It loads to the same
/// configuration.
/// @param from_name  as it was asked for: "gap9"
std::string new_platform(const std::string& name, const ResolvedPlatform& from,
                         const std::string& from_name);

}  // namespace leviosim::platform
