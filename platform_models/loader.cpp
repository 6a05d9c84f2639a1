#include "platform_models/loader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "platform_models/builtin.h"
#include "platform_models/configure.h"
#include "platform_models/document.h"
#include "platform_models/instruction_set.h"
#include "platform_models/nearest.h"
#include "platform_models/override.h"
#include "platform_models/rules.h"
#include "sim/error.h"

namespace leviosim::platform {
namespace {

[[noreturn]] void unknown_platform(const std::string& name) {
  const std::vector<std::string> names = platform_names();
  throw InputError(
      fmt::format("unknown platform '{}'{} (built in: {}; a file is given by a path that contains "
                  "'/' or ends in .yaml)",
                  name, did_you_mean(name, names), fmt::join(names, ", ")));
}

/// Without the sources of rows that others replaced.
std::vector<std::pair<std::string, std::string>> cited_only(
    const std::map<std::string, std::string>& sources, const std::vector<Parameter>& parameters) {
  std::vector<std::pair<std::string, std::string>> kept;
  for (const auto& source : sources)
    if (std::any_of(parameters.begin(), parameters.end(), [&](const Parameter& parameter) {
          return parameter.source.find(source.first) != std::string::npos;
        }))
      kept.emplace_back(source);
  return kept;
}

}  // namespace

std::vector<std::string> platform_names() {
  std::vector<std::string> names;
  for (const BuiltinFile& platform : builtin_platforms()) names.emplace_back(platform.name);
  return names;
}

ResolvedPlatform resolve_platform_text(const std::string& file, const std::string& text,
                                       const std::vector<std::string>& overrides) {
  const Schema schema;
  const SplitOverrides split = split_overrides(overrides);
  Document document = read_document(schema, file, text, split.base);
  for (const std::string& override : split.parameters)
    apply_override(schema, document.settings, override);
  ResolvedPlatform platform;
  platform.config = configure(schema, document.name, document.settings);
  check_rules(schema, document.settings, platform.config);
  platform.name = document.name;
  platform.description = document.description;
  for (const auto& setting : document.settings)
    if (setting) platform.parameters.push_back(setting->parameter);
  if (!overrides.empty()) document.sources[kOverrideKey] = kOverrideMeaning;
  platform.sources = cited_only(document.sources, platform.parameters);
  return platform;
}

ResolvedPlatform resolve_platform(const std::string& name_or_path,
                                  const std::vector<std::string>& overrides) {
  if (is_path(name_or_path))
    return resolve_platform_text(name_or_path, read_file(name_or_path, "a platform file"),
                                 overrides);
  for (const BuiltinFile& platform : builtin_platforms())
    if (platform.name == name_or_path)
      return resolve_platform_text(fmt::format("{}.yaml", platform.name),
                                   std::string(platform.text), overrides);
  unknown_platform(name_or_path);
}

sim::ChipConfig load_platform(const std::string& name_or_path,
                              const std::vector<std::string>& overrides) {
  return resolve_platform(name_or_path, overrides).config;
}

}  // namespace leviosim::platform
