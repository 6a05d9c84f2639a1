// What is asked of an output, a folder or a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace leviosim::outputs {

struct OutputRequest {
  std::string option;                              ///< that names it, for messages; may be empty
  std::string path;                                ///< as the user gave it
  bool replace = false;                            ///< what leviosim wrote there before
  std::vector<std::filesystem::path> inputs = {};  ///< that stay as they are; need not exist
  /// Of a folder: replace its files also if they were changed since, as those of a cache may be.
  bool repair = false;

  /// "--out results".
  std::string shown() const { return option.empty() ? path : option + ' ' + path; }
};

}  // namespace leviosim::outputs
