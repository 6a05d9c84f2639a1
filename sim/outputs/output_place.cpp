#include "sim/outputs/output_place.h"

#include <fcntl.h>
#include <unistd.h>

#include <fmt/core.h>

#include <cerrno>
#include <cstdio>

#include "sim/base/error.h"
#include "sim/outputs/staging_folder.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

/// Of all that may be there by now, rename(2) gives a folder the place of nothing but an empty one.
int put_new(const fs::path& staged, const fs::path& target) {
  const std::optional<struct stat> status = status_of(staged);
  if (!status || !S_ISDIR(status->st_mode)) return rename_new(staged, target);
  return ::rename(staged.c_str(), target.c_str()) == 0 ? 0 : errno;
}

}  // namespace

OutputPlace::OutputPlace(OutputRequest request, const char* kind)
    : request_(std::move(request)), shown_path_(request_.path) {
  if (request_.path.empty())
    throw InputError(fmt::format("{}: is empty; expected {}",
                                 request_.option.empty() ? "output" : request_.option, kind));
  std::error_code error;
  target_ = resolved(request_.path, error);
  if (error) refuse("cannot be used: " + error.message());
}

void OutputPlace::refuse(const std::string& why) const {
  throw InputError(fmt::format("{}: {}", request_.shown(), why));
}

std::optional<std::string> OutputPlace::put(StagingFolder& staging, const fs::path& staged,
                                            const std::function<bool(const fs::path&)>& is_ours) {
  const bool replaces = request_.replace && is_ours(target_);
  const int error = replaces ? replace(staging, staged, is_ours) : put_new(staged, target_);
  if (error == 0) return std::nullopt;
  return put_aside(staged, error);
}

/// @returns 0, EEXIST if what is there is not leviosim's any more, or another error
int OutputPlace::replace(StagingFolder& staging, const fs::path& staged,
                         const std::function<bool(const fs::path&)>& is_ours) const {
  const auto exchange_back = [&] {
    const int error = exchange(staged, target_);
    if (error != 0) staging.let_go();
    return error == 0;
  };
  if (const int error = exchange(staged, target_)) return error;
  try {
    if (is_ours(staged)) return 0;
  } catch (...) {
    exchange_back();
    throw;
  }
  if (exchange_back()) return EEXIST;
  refuse(fmt::format("something was put there meanwhile, and is {} now", staged.string()));
}

/// Under the first name beside it that is free.
std::string OutputPlace::put_aside(const fs::path& staged, int error) {
  const bool is_taken =
      error == ENOTEMPTY || error == EEXIST || error == ENOTDIR || error == EISDIR;
  const std::string why = is_taken ? "something else was put there meanwhile, and is left as it is"
                                   : "cannot be put in place: " + reason(error);
  const fs::path given(request_.path);
  const fs::path user_path = given.has_filename() ? given : given.parent_path();
  int fault = EEXIST;
  for (int k = 2; fault == EEXIST || fault == ENOTEMPTY; ++k) {
    std::string shown = free_name(user_path, k).string();
    std::string message =
        fmt::format("{}: {}; the results are in {}", request_.shown(), why, shown);
    fault = rename_new(staged, free_name(target_, k));
    if (fault != 0) continue;
    shown_path_ = std::move(shown);
    return message;
  }
  refuse(is_taken ? "cannot be put in place: " + reason(fault) : why);
}

}  // namespace leviosim::outputs
