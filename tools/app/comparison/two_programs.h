// Two builds of leviosim on the same input. What each leaves is compared as any two runs are; the
// new build also times the work that the old one recorded, so that it is known what of a difference
// is other work, another cost of the same work, and another number of the chip.
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
