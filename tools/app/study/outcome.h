// What is kept of a point that was computed: figures, or why there are none. The same whether it
// has just been computed or was found in the cache.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

struct Figure {
  std::string name;
  std::string unit;
  std::string description;
  double value = 0;
};

struct Outcome {
  std::string failure;  ///< why the point cannot be run to its end, such as too little L1
  std::vector<Figure> figures;
  std::string protocol{};  ///< of errors of trajectories among the figures
};

/// As JSON with every bit of the numbers.
std::string to_text(const Outcome& outcome);
/// Nothing for what to_text() never wrote, such as a file that was cut off.
std::optional<Outcome> parse_outcome(std::string_view text);

// Outcomes of finished points on disk, those of all studies together: one small file each, written
// whole or not at all, found by its key. A file begins with its key and a digest of the rest: what
// is damaged or lies under another key's name counts as absent, and is written anew. Several
// programs may use one folder at the same time.

class OutcomeCache {
 public:
  /// The folder is made when something is stored.
  explicit OutcomeCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Nothing if the point is not there, or cannot be read.
  std::optional<Outcome> find(const std::string& key) const;
  /// @throws InputError if it cannot be written
  void store(const std::string& key, const Outcome& outcome) const;

 private:
  std::optional<std::string> find_text(const std::string& key) const;
  std::filesystem::path file_of(const std::string& key) const;

  std::filesystem::path folder_;
};

/// The one that commands use unless told otherwise.
std::filesystem::path default_outcome_cache();

}  // namespace leviosim::tools
