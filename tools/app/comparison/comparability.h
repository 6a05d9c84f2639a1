// Whether two runs can be compared: they must have processed the same data, frame by frame, with
// the same random draws, at the same size, by the same profile. Anything else may differ; what
// should be known about it is noted.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/app/comparison/run_record.h"

namespace leviosim::tools {

/// Differences that the user does not mind: "data,seed".
using Allowed = std::set<std::string>;

/// @throws InputError for names that are none of chip, data, frames, profile, seed, size
Allowed parse_allowed(const std::string& text);

/// @returns notes: what else differs, and what was allowed to
/// @throws InputError naming each difference that is not allowed
std::vector<std::string> check_comparable(const RunRecord& a, const RunRecord& b,
                                          const Allowed& allowed);

/// Of a run and a baseline: limits of one chip say nothing of another. Settings of the chip and the
/// number of cores are what a user tries out, and may differ.
/// @throws InputError unless "chip" is allowed
void check_same_chip(const RunRecord& a, const RunRecord& b, const Allowed& allowed);

// Two builds of leviosim on the same input. What each leaves is compared as any two runs are; the
// new build also times the work that the old one recorded, so that it is known what of a difference
// is other work, another price of the same work, and another number of the chip.

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
