#include "tools/app/report/number_text.h"

#include <fmt/core.h>

namespace leviosim::tools {

std::string figure_text(std::optional<double> value, int decimals, std::string_view otherwise) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string(otherwise);
}

}  // namespace leviosim::tools
