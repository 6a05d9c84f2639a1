// Platforms: the numbers of a chip with their sources, from a YAML file and overrides.
//
// gap9.yaml says what each number means and where it comes from; README.md describes the format.
// All faults of files and overrides are InputErrors that name file and line or the override, the
// key, what was found, what was expected and the nearest valid name.
#pragma once

#include <string>
#include <vector>

#include "platform_models/loader/parameter.h"
#include "sim/chip/config.h"

namespace leviosim::platform {

struct ResolvedPlatform {
  std::string name;  ///< of the chip
  std::string description;
  sim::ChipConfig config;
  std::vector<Parameter> parameters;                         ///< in the order of the schema
  std::vector<std::pair<std::string, std::string>> sources;  ///< key → what it is, sorted
};

/// Names of the platforms that are built in, sorted.
std::vector<std::string> platform_names();

/// Loads a platform and applies overrides ("cluster.workers=4", "cluster.clock=240MHz").
/// @param name_or_path  name of a built-in platform, or path of a file: what contains a '/' or ends
///                      in .yaml or .yml is a path. With ":PATH=VALUE,PATH=VALUE" it is a variant
///                      of that platform
ResolvedPlatform resolve_platform(const std::string& name_or_path,
                                  const std::vector<std::string>& overrides = {});

/// Loads a platform from the text of a file; `file` is its name for messages.
ResolvedPlatform resolve_platform_text(const std::string& file, const std::string& text,
                                       const std::vector<std::string>& overrides = {});

/// Only the numbers.
sim::ChipConfig load_platform(const std::string& name_or_path,
                              const std::vector<std::string>& overrides = {});

/// A platform file that gives the same configuration, overrides included, when it is loaded.
std::string to_yaml(const ResolvedPlatform& platform);

}  // namespace leviosim::platform
