// Bytes that come while work goes on, and are too many to be held until it is done. They lie in a
// file without a name, of which nothing stays whatever becomes of the program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/outputs/content.h"
#include "sim/outputs/file_system.h"

namespace leviosim::outputs {

class Spool {
 public:
  /// @param folder  in whose file system the bytes lie, if that can be
  /// @param shown   of what they are for, for messages
  /// @throws InputError if there can be no file
  Spool(const std::filesystem::path& folder, std::string shown);

  /// @throws InputError if the disk is full
  void add(std::string_view bytes);
  /// All bytes so far. The spool outlives it.
  Content content();

 private:
  void flush();
  [[noreturn]] void refuse(int error) const;

  std::string shown_;
  Descriptor file_;
  std::string waiting_;  ///< bytes that are not in the file yet
};

}  // namespace leviosim::outputs
