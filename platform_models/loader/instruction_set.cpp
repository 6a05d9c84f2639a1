#include "platform_models/loader/instruction_set.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <vector>

#include "platform_models/loader/builtin.h"
#include "sim/base/input_file.h"
#include "sim/base/nearest_name.h"

namespace leviosim::platform {
namespace {

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

/// What others build on.
struct Shelf {
  std::string_view what;
  std::string_view folder;  ///< of the built-in ones, for messages
  std::span<const base::BuiltinFile> builtin;
};

TextFile find_file(const Shelf& shelf, const std::string& name, const std::string& from,
                   const Place& place) {
  if (is_path(name)) {
    const std::string path =
        (std::filesystem::path(from).parent_path() / name).lexically_normal().string();
    if (!base::exists(path)) place.fail(fmt::format("there is no file '{}'", path));
    return {path, base::read_file(path, base::InputKind::platform)};
  }
  std::vector<std::string> names;
  for (const base::BuiltinFile& file : shelf.builtin) {
    if (file.name == name)
      return {fmt::format("{}{}.yaml", shelf.folder, file.name), std::string(file.text)};
    names.emplace_back(file.name);
  }
  place.fail(fmt::format(
      "unknown {} '{}'{} (built in: {}; a file is given by a path that contains '/' or ends in "
      ".yaml)",
      shelf.what, name, base::did_you_mean(name, names), fmt::join(names, ", ")));
}

}  // namespace

bool is_path(std::string_view name) {
  return name.find('/') != std::string_view::npos || ends_with(name, ".yaml") ||
         ends_with(name, ".yml");
}

TextFile find_instruction_set(const std::string& base, const std::string& from,
                              const Place& place) {
  return find_file({"instruction set", "isa/", builtin_instruction_sets()}, base, from, place);
}

TextFile find_platform(const std::string& name, const std::string& from, const Place& place) {
  return find_file({"platform", "", builtin_platforms()}, name, from, place);
}

}  // namespace leviosim::platform
