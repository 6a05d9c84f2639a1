// tools/app/validation/published/*.csv as part of the program; generated when it is built
// (embed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace leviosim::tools {

struct BuiltinReferences {
  std::string_view name;  ///< file name without extension
  std::string_view text;
};

/// Sorted by name.
std::span<const BuiltinReferences> builtin_references();

/// The text of published/NAME.csv, which must be there.
std::string_view reference_text(std::string_view name);

}  // namespace leviosim::tools
