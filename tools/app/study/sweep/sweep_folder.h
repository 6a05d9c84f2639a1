// The folder of a sweep. Unlike other results it is added to, by several processes at a time, so it
// is no folder that appears whole (sim/outputs/output_folder.h): the file of points in it grows,
// and sweep.csv is a single file that only replaces what leviosim wrote.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/outputs/output_file.h"

namespace leviosim::tools {

class SweepFolder {
 public:
  struct Request {
    std::string option;  ///< that names the folder, for messages
    std::string path;
    std::vector<std::filesystem::path> inputs;  ///< that are read
    std::filesystem::path cache;                ///< may lie in the folder
  };
  /// Makes the folder if there is none.
  /// @throws InputError if it holds anything that no sweep wrote, which the message names, or an
  ///         input
  explicit SweepFolder(const Request& request);

  const std::filesystem::path& path() const { return path_; }
  /// To be published when all is done.
  outputs::OutputFile& csv() { return *csv_; }
  /// Begins anew: removes the points, of which others begin anew, too.
  void empty();

 private:
  void check_entry(const Request& request, const std::string& name) const;

  std::filesystem::path path_;
  std::optional<outputs::OutputFile> csv_;
};

}  // namespace leviosim::tools
