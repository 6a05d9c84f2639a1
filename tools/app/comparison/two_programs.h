// Two builds of leviosim on the same input: what each leaves is compared as any two runs are.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace leviosim::tools {

/// `PROGRAM run ARGUMENTS --quiet --out FOLDER`, for each in a folder of its own.
class TwoPrograms {
 public:
  /// @param programs   two
  /// @param arguments  of `leviosim run`, without --out
  /// @throws InputError for other numbers of programs, and if one of them fails; Interrupted
  TwoPrograms(const std::vector<std::string>& programs, const std::vector<std::string>& arguments);
  ~TwoPrograms();
  TwoPrograms(const TwoPrograms&) = delete;
  TwoPrograms& operator=(const TwoPrograms&) = delete;

  /// Of the runs; removed with the object.
  const std::vector<std::string>& folders() const { return folders_; }

 private:
  std::filesystem::path place_;
  std::vector<std::string> folders_;
};

}  // namespace leviosim::tools
