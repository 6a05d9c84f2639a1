// A file that is written before it has its name, and then gets one that nothing else has. Where the
// file system can, it has no name at all until then, so that a kill leaves nothing.
#pragma once

#include <filesystem>
#include <string_view>

#include "sim/outputs/file_system.h"

namespace leviosim::outputs {

class NewFile {
 public:
  /// @param hidden  the name beside its future place that it has where it cannot be without one
  explicit NewFile(std::filesystem::path hidden) : hidden_(std::move(hidden)) {}
  /// Removes the file if it was given no other name.
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Sets disk space aside until write(). @returns 0, or the error; 0 where that is not known
  int reserve(std::uint64_t bytes);
  /// Whether the file will have the hidden name while it is written.
  bool needs_name();
  /// Once. @returns 0, or the error
  int write(std::string_view bytes);
  /// Gives it the hidden name. @returns 0, EEXIST or another error
  int hide();
  /// Gives it a name that does not exist. @returns 0, EEXIST or another error
  int place(const std::filesystem::path& name);
  /// What has the hidden name now is something else.
  void forget() { is_hidden_ = false; }

 private:
  int open();

  std::filesystem::path hidden_;
  Descriptor file_;
  bool is_hidden_ = false;
};

}  // namespace leviosim::outputs
