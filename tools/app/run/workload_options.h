// Parameters of the workload on the command line: "-p workload.window=6", beside those of the chip.
#pragma once

#include <string>
#include <vector>

#include "workload/vio/parameters.h"

namespace leviosim::tools {

struct SplitOverrides {
  std::vector<std::string> chip;
  std::vector<std::string> workload;  ///< those that begin with "workload."
};
SplitOverrides split_overrides(const std::vector<std::string>& overrides);

/// @throws InputError for unknown names, with the nearest valid one, for values that the parameter
///         cannot have, and for parameters given twice
std::vector<vio::Assignment> parse_workload_overrides(const std::vector<std::string>& overrides);

/// The parameter of that name. @throws InputError, which begins with `where`, if there is none
const vio::Parameter& workload_parameter(const std::string& where, const std::string& name);

/// A value of the parameter: a number, or off or on for a toggle; its unit may follow.
/// @throws InputError, which begins with `where`
double parse_workload_value(const std::string& where, const vio::Parameter& parameter,
                            const std::string& text);

/// "a whole number of keyframes from 2 to 32", "off or on".
std::string valid_values(const vio::Parameter& parameter);

}  // namespace leviosim::tools
