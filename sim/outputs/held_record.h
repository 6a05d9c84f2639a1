// The record of a folder while lines are added to it: one process at a time.
#pragma once

#include <filesystem>

#include "sim/outputs/output_record.h"

namespace leviosim::outputs {

class HeldRecord {
 public:
  /// Waits for others; makes the file if there is none. One that belongs to somebody else, as in
  /// /tmp, is only read: what is written there is not recorded, and so never replaced.
  /// @throws InputError if that fails
  explicit HeldRecord(const std::filesystem::path& folder);

  /// Adds a line, unless it is there. @throws InputError if that fails
  void add(const std::string& path, const FileState& state);
  const OutputRecord& record() const { return record_; }

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_;
  Descriptor descriptor_;
  OutputRecord record_;
};

}  // namespace leviosim::outputs
