// Platform files that are part of the program, so that it needs no files beside itself. The table
// is generated from platform_models/*.yaml when the program is built (embed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace leviosim::platform {

struct BuiltinPlatform {
  std::string_view name;  ///< file name without extension
  std::string_view text;
};

/// Sorted by name.
std::span<const BuiltinPlatform> builtin_platforms();

/// Sizes of compiled code (code/*.csv), in the same form.
std::span<const BuiltinPlatform> builtin_code();

}  // namespace leviosim::platform
