// The files that others build on: the instruction set of `isa: { base: rv32imfc_xpulp }`, the
// platform of `extends: gap9`.
#pragma once

#include <string>

#include "platform_models/loader/value.h"

namespace leviosim::platform {

/// The keys that name them.
inline constexpr const char* kBasePath = "isa.base";
inline constexpr const char* kParentPath = "extends";

struct TextFile {
  std::string name;  ///< for messages: "isa/rv32imfc.yaml"
  std::string text;
};

/// @param base   name of a built-in instruction set, or path of a file (what contains a '/' or ends
///               in .yaml or .yml), relative to the folder of `from`
/// @param from   the file that names it
/// @param place  where it does; begins the message if there is no such file
TextFile find_instruction_set(const std::string& base, const std::string& from, const Place& place);
/// Checks the instruction set of a platform.
TextFile find_platform(const std::string& name, const std::string& from, const Place& place);

/// Whether a platform or an instruction set is given by path and not by name.
bool is_path(std::string_view name);

}  // namespace leviosim::platform
