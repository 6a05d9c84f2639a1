// Numbers as text for tables.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "sim/base/units.h"

namespace leviosim::tools {

/// What stands in a cell of which nothing is known.
inline constexpr const char* kNothing = "–";

/// With so many decimals; `otherwise` for what does not exist.
std::string figure_text(std::optional<double> value, int decimals,
                        std::string_view otherwise = kNothing);

/// A clock in MHz.
inline double megahertz(Hertz clock) { return static_cast<double>(clock.count()) / 1e6; }

}  // namespace leviosim::tools
