// SHA-256 of the inputs of a run, for its manifest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "traces/datasets/dataset.h"

namespace leviosim::tools {

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
