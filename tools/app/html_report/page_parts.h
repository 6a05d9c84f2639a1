// The files of page/, and the chart library with its licence, as part of the program; generated
// when it is built (embed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace leviosim::tools {

struct PagePart {
  std::string_view name;  ///< file name without extension
  std::string_view text;
};

/// Sorted by path.
std::span<const PagePart> page_parts();

}  // namespace leviosim::tools
