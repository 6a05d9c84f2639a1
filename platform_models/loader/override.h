// Command-line overrides of platform parameters: "-p cluster.workers=4", "-p cluster.clock=240MHz".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform_models/loader/document.h"
#include "platform_models/loader/parameter.h"
#include "platform_models/loader/schema.h"
#include "platform_models/loader/value.h"

namespace leviosim::platform {

/// Source of a value that an override gave. Its first word is a key of `sources`.
inline constexpr const char* kOverrideKey = "override";
inline constexpr const char* kOverrideSource = "override (-p)";
inline constexpr const char* kOverrideMeaning = "given on the command line with -p";

/// Overrides that name another instruction set ("isa.base=rv32imfc") are settled before the file is
/// read; all others replace parameters.
struct SplitOverrides {
  std::optional<BaseOverride> base;
  std::vector<std::string> parameters;
};
SplitOverrides split_overrides(const std::vector<std::string>& overrides);

/// A value as -p takes it, "240MHz", "240". Without a unit, a number is in the unit of what it
/// replaces, or in the base unit where there is nothing.
/// @throws InputError as for a value in a file
Setting read_override(const Field& field, const std::optional<Setting>& replaced,
                      std::string_view value, const Place& place);

/// Replaces one setting as read_override() reads it. Such a value has no source but the person who
/// gave it, hence no range either, and its confidence is "assumed".
/// @param text  "path=value", "path=number unit"
/// @throws InputError as for a value in a file, for unknown paths, and for paths given twice
void apply_override(const Schema& schema, Settings& settings, const std::string& text);

}  // namespace leviosim::platform
