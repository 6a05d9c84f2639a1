// The place of an output, a file or a folder: what may lie there, and how what was staged takes its
// name. Nothing is replaced but what leviosim wrote, if the user asked for it. If the name is taken
// when everything is done, the output is left under another one.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/outputs/staging_folder.h"

namespace leviosim::outputs {

/// What is asked of an output.
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

class OutputPlace {
 public:
  /// Where the output is in the end, as the user would name it.
  const std::string& shown_path() const { return shown_path_; }
  /// Without links.
  const std::filesystem::path& path() const { return target_; }

 protected:
  /// @throws InputError for a path that cannot be found out
  OutputPlace(OutputRequest request, const char* kind);

  const OutputRequest& request() const { return request_; }
  [[noreturn]] void refuse(const std::string& why) const;
  /// Gives what was staged its name. What it replaces lies in its old place then, for the staging
  /// folder or the caller to remove.
  /// @param is_ours  whether what has a path was written by leviosim; asked again once it is out of
  ///                 the way
  /// @returns nothing, or why it has another name now, which the text tells
  /// @throws InputError, Interrupted; nothing is changed then
  std::optional<std::string> put(StagingFolder& staging, const std::filesystem::path& staged,
                                 const std::function<bool(const std::filesystem::path&)>& is_ours);

 private:
  int replace(StagingFolder& staging, const std::filesystem::path& staged,
              const std::function<bool(const std::filesystem::path&)>& is_ours) const;
  std::string put_aside(const std::filesystem::path& staged, int error);

  OutputRequest request_;
  std::string shown_path_;
  std::filesystem::path target_;
};

}  // namespace leviosim::outputs
