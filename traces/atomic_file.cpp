#include "traces/atomic_file.h"

#include <fmt/core.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "sim/error.h"

namespace leviosim::traces {
namespace {

namespace fs = std::filesystem;

/// A name beside `target` that no other process uses.
fs::path sibling(const fs::path& target, std::string_view kind) {
  return target.parent_path() /
         fmt::format(".{}.{}-{}", target.filename().string(), kind, ::getpid());
}

/// "a/b/" and "a/b" mean the same folder.
fs::path without_trailing_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
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

StagedFolder::StagedFolder(fs::path target)
    : target_(without_trailing_slash(target)), staging_(sibling(target_, "partial")) {
  std::error_code error;
  fs::remove_all(staging_, error);
  fs::create_directories(staging_, error);
  if (error)
    throw InputError(fmt::format("{}: cannot be created: {}", target_.string(), error.message()));
}

StagedFolder::~StagedFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
}

void StagedFolder::commit() {
  const fs::path replaced = sibling(target_, "replaced");
  std::error_code error;
  const bool replaces = fs::exists(target_);
  if (replaces) fs::rename(target_, replaced, error);
  if (!error) fs::rename(staging_, target_, error);
  if (error) {
    std::error_code ignored;
    if (replaces && !fs::exists(target_)) fs::rename(replaced, target_, ignored);
    throw InputError(
        fmt::format("{}: cannot be put in place: {}", target_.string(), error.message()));
  }
  committed_ = true;
  if (replaces) fs::remove_all(replaced, error);
}

}  // namespace leviosim::traces
