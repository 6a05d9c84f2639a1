#include "platform_models/loader/platform_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "platform_models/loader/builtin.h"
#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/instruction_set.h"
#include "platform_models/loader/override.h"
#include "platform_models/loader/parameter.h"
#include "platform_models/loader/rules.h"
#include "platform_models/loader/value.h"
#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"

namespace leviosim::platform {
namespace {

[[noreturn]] void unknown_platform(const std::string& name) {
  const std::vector<std::string> names = platform_names();
  throw InputError(
      fmt::format("unknown platform '{}'{} (built in: {}; a file is given by a path that contains "
                  "'/' or ends in .yaml)",
                  name, base::did_you_mean(name, names), fmt::join(names, ", ")));
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

NamedPlatform parse_platform_name(const std::string& text) {
  const std::size_t colon = text.rfind(':', text.find('='));
  if (text.find('=') == std::string::npos || colon == std::string::npos || base::is_file(text))
    return {text, {}};
  NamedPlatform named{text.substr(0, colon), {}};
  for (std::size_t begin = colon + 1; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    named.overrides.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return named;
}

PlatformFile PlatformFile::named(const std::string& text, const std::filesystem::path& folder) {
  NamedPlatform named = parse_platform_name(text);
  if (is_path(named.name)) {
    const std::string path =
        folder.empty() ? named.name : (folder / named.name).lexically_normal().string();
    return {path, base::read_file(path, base::InputKind::platform), std::move(named.overrides)};
  }
  for (const base::BuiltinFile& platform : builtin_platforms())
    if (platform.name == named.name)
      return {fmt::format("{}.yaml", platform.name), std::string(platform.text),
              std::move(named.overrides)};
  unknown_platform(named.name);
}

PlatformFile::Overridden PlatformFile::read_with(const std::vector<std::string>& overrides) {
  std::vector<std::string> all = overrides_;
  all.insert(all.end(), overrides.begin(), overrides.end());
  const SplitOverrides split = split_overrides(all);
  const Document& read = document(split.base);
  Overridden overridden{read, read.settings, !all.empty()};
  for (const std::string& override : split.parameters)
    apply_override(schema_, overridden.settings, override);
  return overridden;
}

const Document& PlatformFile::document(const std::optional<BaseOverride>& base) {
  const std::string key = base ? base->base : std::string();
  const auto known = documents_.find(key);
  if (known != documents_.end()) return known->second;
  return documents_.emplace(key, read_document(schema_, file_, text_, base)).first->second;
}

ResolvedPlatform PlatformFile::resolve(const std::vector<std::string>& overrides) {
  const auto [read, settings, has_overrides] = read_with(overrides);
  ResolvedPlatform platform;
  platform.config = configure(schema_, read.name, settings);
  check_rules(schema_, settings, platform.config);
  platform.name = read.name;
  platform.description = read.description;
  for (const auto& setting : settings)
    if (setting) platform.parameters.push_back(setting->parameter);
  std::map<std::string, std::string> sources = read.sources;
  if (has_overrides) sources[kOverrideKey] = kOverrideMeaning;
  platform.sources = cited_only(sources, platform.parameters);
  return platform;
}

Settings PlatformFile::settings_with(const std::vector<std::string>& overrides) {
  return read_with(overrides).settings;
}

const Parameter* PlatformFile::find(const std::string& path) {
  const std::size_t index = schema_.find(path);
  if (index == Schema::kNone) return nullptr;
  const std::optional<Setting>& setting =
      document(split_overrides(overrides_).base).settings[index];
  return setting ? &setting->parameter : nullptr;
}

std::string canonical_text(const Schema& schema, const ResolvedPlatform& platform) {
  std::string text = fmt::format("chip {}\n", platform.name);
  for (const Parameter& parameter : platform.parameters) {
    const std::size_t index = schema.find(parameter.path);
    check(index != Schema::kNone, "a resolved parameter is not in the schema");
    const Field& field = schema.fields()[index];
    const Setting setting =
        read_value(field, parameter.value, parameter.unit, Place{parameter.path});
    text += fmt::format("{} {}", parameter.path, number_text(setting.base));
    if (field.set_band && parameter.range) {
      const double factor = field.dimension->find(parameter.unit)->factor;
      text += fmt::format(" {} {}", number_text(parameter.range->low * factor),
                          number_text(parameter.range->high * factor));
    }
    text += '\n';
  }
  return text;
}

sim::ChipConfig configure(const Schema& schema, const std::string& name, const Settings& settings) {
  sim::ChipConfig config;
  config.name = name;
  for (std::size_t i = 0; i < schema.fields().size(); ++i) {
    const Field& field = schema.fields()[i];
    const auto& setting = settings[i];
    if (!setting) continue;
    field.set(config, setting->base);
    const auto& range = setting->parameter.range;
    if (!range || !field.set_band) continue;
    const double factor = field.dimension->find(setting->parameter.unit)->factor;
    field.set_band(config, range->low * factor, range->high * factor);
  }
  config.cluster.icache.measured_size = size_of_code(config.cluster.core.code);
  config.controller.icache.measured_size = size_of_code(config.controller.core.code);
  return config;
}

}  // namespace leviosim::platform
