// Commands that the program had once, and what does their work now. The error for an unknown command
// names it.
#pragma once

#include <array>
#include <string_view>

namespace leviosim::tools {

struct FormerCommand {
  std::string_view name;
  std::string_view successor;  ///< a command line
};

inline constexpr std::array kFormerCommands{
    FormerCommand{"explore", "leviosim ablate --vary paper"},
    FormerCommand{"calibrate", "leviosim validate --fit"},
    FormerCommand{"image-statistics", "tools/research/image_statistics.py DIR"},
};

}  // namespace leviosim::tools
