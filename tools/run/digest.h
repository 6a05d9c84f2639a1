// SHA-256 of the inputs of a run, for its manifest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "traces/dataset.h"

namespace leviosim::tools {

/// A running SHA-256 (OpenSSL's).
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view bytes);
  /// Ends the digest. @returns 64 hexadecimal digits
  std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct InputDigest {
  std::string name;  ///< relative to the data folder
  std::int64_t bytes = 0;
  std::string sha256;
};

/// @throws InputError if the file cannot be read
InputDigest digest_of_file(const std::filesystem::path& file);

/// The text files of the streams that a run reads, and its frames as one: the concatenation of
/// their image files. @throws InputError for files that cannot be read
std::vector<InputDigest> digest_inputs(const traces::Dataset& data);

}  // namespace leviosim::tools
