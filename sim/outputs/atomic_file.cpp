#include "sim/outputs/atomic_file.h"

#include <fmt/core.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>

#include "sim/base/error.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

/// A name beside `target` that no other process uses.
fs::path sibling(const fs::path& target, std::string_view kind) {
  return target.parent_path() /
         fmt::format(".{}.{}-{}", target.filename().string(), kind, ::getpid());
}

}  // namespace

void write_file_atomically(const fs::path& file, std::string_view contents) {
  const fs::path staging = sibling(file, "partial");
  {
    std::ofstream out(staging, std::ios::binary);
    out.write(contents.data(), static_cast<std::streamsize>(contents.size()));
    out.close();
    if (!out) {
      std::error_code ignored;
      fs::remove(staging, ignored);
      throw InputError(fmt::format("{}: cannot be written", file.string()));
    }
  }
  std::error_code error;
  fs::rename(staging, file, error);
  if (!error) return;
  std::error_code ignored;
  fs::remove(staging, ignored);
  throw InputError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

}  // namespace leviosim::outputs
