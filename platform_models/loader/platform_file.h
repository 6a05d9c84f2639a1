// A platform file that is read once and resolved with many sets of overrides: sweeps ask for
// thousands of variants of one chip.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "platform_models/loader/document.h"
#include "platform_models/loader/loader.h"
#include "platform_models/loader/schema.h"

namespace leviosim::platform {

/// A platform in the words of a user, and what of it is to be otherwise:
/// "gap9:cluster.workers=4,cluster.clock=240MHz". A file whose name is all of that is that file.
struct NamedPlatform {
  std::string name;  ///< or path
  std::vector<std::string> overrides;
};
NamedPlatform parse_platform_name(const std::string& text);

class PlatformFile {
 public:
  /// @param name    as resolve_platform() takes it
  /// @param folder  that paths are relative to
  static PlatformFile named(const std::string& name, const std::filesystem::path& folder = {});
  /// @param file  its name for messages
  /// @param overrides  part of the platform: those of resolve() come on top
  PlatformFile(std::string file, std::string text, std::vector<std::string> overrides = {})
      : file_(std::move(file)), text_(std::move(text)), overrides_(std::move(overrides)) {}

  /// @throws InputError as resolve_platform() does
  ResolvedPlatform resolve(const std::vector<std::string>& overrides);

  /// The parameters with overrides, before the rules between them are checked.
  Settings settings_with(const std::vector<std::string>& overrides);

  /// A parameter by its path; nullptr if the file does not give it.
  const Parameter* find(const std::string& path);

  const Schema& schema() const { return schema_; }

 private:
  /// As read with the instruction set that an override names, "" for the file's own.
  const Document& document(const std::optional<BaseOverride>& base);
  /// The file with its own overrides and these, before the rules are checked.
  struct Overridden {
    const Document& document;
    Settings settings;
    bool has_overrides;
  };
  Overridden read_with(const std::vector<std::string>& overrides);

  std::string file_;
  std::string text_;
  std::vector<std::string> overrides_;
  Schema schema_;
  std::map<std::string, Document> documents_;
};

/// What the chip is, whatever its file looks like: a line per parameter in base units. Ends of a
/// range count where the chip depends on them (Field::set_band). Platforms of the same lines time
/// and time work alike.
std::string canonical_text(const Schema& schema, const ResolvedPlatform& platform);

/// Parameters → the chip that they describe.
/// @param name  of the chip
sim::ChipConfig configure(const Schema& schema, const std::string& name, const Settings& settings);

}  // namespace leviosim::platform
