// Records of finished points on disk (record/record.h, Level::figures), those of all studies
// together: one small file each, written whole or not at all, found by its key. A file begins with
// its key and a digest of the rest: what is damaged or lies under another key's name counts as
// absent, and is written anew. Several programs may use one folder at the same time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/app/record/record.h"

namespace leviosim::tools {

class OutcomeCache {
 public:
  /// The folder is made when something is stored.
  explicit OutcomeCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Nothing if the point is not there, or cannot be read.
  std::optional<RunRecord> find(const std::string& key) const;
  /// @throws InputError if it cannot be written
  void store(const std::string& key, const RunRecord& outcome) const;

 private:
  std::optional<std::string> find_text(const std::string& key) const;
  std::filesystem::path file_of(const std::string& key) const;

  std::filesystem::path folder_;
};

}  // namespace leviosim::tools
