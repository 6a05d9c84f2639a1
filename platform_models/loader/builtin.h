// Files that are part of the program, so that it needs none beside itself. The tables are generated
// from platform_models/chips/*.yaml, isa/*.yaml and code/*.csv when the program is built (embed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace leviosim::platform {

struct BuiltinFile {
  std::string_view name;  ///< file name without extension
  std::string_view text;
};

/// All sorted by name.
std::span<const BuiltinFile> builtin_platforms();
std::span<const BuiltinFile> builtin_instruction_sets();
/// Sizes of compiled code (code/*.csv).
std::span<const BuiltinFile> builtin_code();

}  // namespace leviosim::platform
