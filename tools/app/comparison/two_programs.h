// Two builds of leviosim on the same input. Their runs are compared as any two runs are; the new
// build also replays the work that the old one recorded, which splits the difference into changed
// work, changed cost of the same work, and changed numbers of the chip.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace leviosim::tools {

/// `PROGRAM run ARGUMENTS --record --quiet --out FOLDER`, for each in a folder of its own.
class TwoPrograms {
 public:
  /// @param programs   two
  /// @param arguments  of `leviosim run`, without --out and --record; closed loops are not recorded
  /// @throws InputError for other numbers of programs, and if one of them fails; Interrupted
  TwoPrograms(const std::vector<std::string>& programs, const std::vector<std::string>& arguments);
  ~TwoPrograms();
  TwoPrograms(const TwoPrograms&) = delete;
  TwoPrograms& operator=(const TwoPrograms&) = delete;

  /// Of the runs; removed with the object.
  const std::vector<std::string>& folders() const { return folders_; }
  /// "of +1.34 % of a frame: …": the split. Empty where nothing was recorded, or the new build
  /// does not take the old one's files.
  std::string split() const;

 private:
  /// Cycles of a mean frame of the old build's work, on a chip, by the new one.
  std::optional<double> cycles_of_replay(const std::string& platform) const;

  std::string new_program_;
  std::filesystem::path place_;
  std::vector<std::string> folders_;
};

}  // namespace leviosim::tools
