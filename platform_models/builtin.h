// Files that are part of the program, so that it needs none beside itself. The tables are generated
// from platform_models/*.yaml and platform_models/isa/*.yaml when the program is built
// (embed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace leviosim::platform {

struct BuiltinFile {
  std::string_view name;  ///< file name without extension
  std::string_view text;
};

/// Both sorted by name.
std::span<const BuiltinFile> builtin_platforms();
std::span<const BuiltinFile> builtin_instruction_sets();

}  // namespace leviosim::platform
