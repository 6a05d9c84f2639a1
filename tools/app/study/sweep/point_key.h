// What the result of a point is found again by: a digest of everything that it depends on.
#pragma once

#include <string>

namespace leviosim::tools {

/// @param identity  all that the point is: the resolved chip, the work or data and the workload
/// @returns 64 hexadecimal digits
std::string point_key(const std::string& identity);

}  // namespace leviosim::tools
