// Finished runs on disk: one small file each, written whole or not at all, found by its key.
// A file begins with its key and a digest of the rest: what is damaged or lies under another key's
// name counts as absent, and is written anew. Several programs may use one folder at the same
// time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/app/study/batch/run_outcome.h"

namespace leviosim::tools {

class RunCache {
 public:
  /// The folder is made when something is stored.
  explicit RunCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Nothing if nothing is kept under the key.
  std::optional<std::string> find_text(const std::string& key) const;
  /// @throws InputError if it cannot be written
  void store_text(const std::string& key, const std::string& text) const;

  /// Nothing if the run is not there, or cannot be read.
  std::optional<RunOutcome> find(const std::string& key) const;
  /// @throws InputError if it cannot be written
  void store(const std::string& key, const RunOutcome& outcome) const;

 private:
  std::filesystem::path file_of(const std::string& key) const;

  std::filesystem::path folder_;
};

/// The one that commands use unless told otherwise.
std::filesystem::path default_run_cache();

}  // namespace leviosim::tools
