// A file that is never half-written: it appears under its name only when complete. It replaces
// whatever has the name; results that users ask for go through sim/outputs/output_file.h instead.
#pragma once

#include <filesystem>
#include <string_view>

namespace leviosim::outputs {

/// Writes beside `file` and renames. Throws InputError if the folder cannot be written.
void write_file_atomically(const std::filesystem::path& file, std::string_view contents);

}  // namespace leviosim::outputs
