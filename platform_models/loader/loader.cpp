#include "platform_models/loader/loader.h"

#include <algorithm>

#include "platform_models/loader/builtin.h"
#include "platform_models/loader/platform_file.h"

namespace leviosim::platform {

std::vector<std::string> platform_names() {
  std::vector<std::string> names;
  for (const base::BuiltinFile& platform : builtin_platforms()) names.emplace_back(platform.name);
  std::sort(names.begin(), names.end());  // files are sorted with their extension
  return names;
}

ResolvedPlatform resolve_platform_text(const std::string& file, const std::string& text,
                                       const std::vector<std::string>& overrides) {
  return PlatformFile(file, text).resolve(overrides);
}

ResolvedPlatform resolve_platform(const std::string& name_or_path,
                                  const std::vector<std::string>& overrides) {
  return PlatformFile::named(name_or_path).resolve(overrides);
}

sim::ChipConfig load_platform(const std::string& name_or_path,
                              const std::vector<std::string>& overrides) {
  return resolve_platform(name_or_path, overrides).config;
}

}  // namespace leviosim::platform
