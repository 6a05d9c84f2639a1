// A file that is part of the program, so that it needs none beside itself. The build makes tables of
// them (tools/embed.cmake).
#pragma once

#include <string_view>

namespace leviosim::base {

struct BuiltinFile {
  std::string_view name;  ///< file name without extension
  std::string_view text;
};

}  // namespace leviosim::base
