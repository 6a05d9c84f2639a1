#include "sim/outputs/growing_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

#include "sim/base/error.h"
#include "sim/outputs/try_again.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

constexpr int kMostAttempts = 100;

/// Whether a name leads to the open file. @param now  of the file
bool has_name(int descriptor, const fs::path& path, struct stat& now) {
  struct stat there {};
  return ::fstat(descriptor, &now) == 0 && ::stat(path.c_str(), &there) == 0 &&
         is_same_file(now, there);
}

[[noreturn]] void fail(const fs::path& path, std::string_view why) {
  throw InputError(fmt::format("{}: cannot be written: {}", path.string(), why));
}

/// Where open files have names by which they can be linked; containers may lack it.
constexpr const char* kNamesOfOpenFiles = "/proc/self/fd";

/// A file beside the path that a kill leaves nothing of. @param staging  its name, where the file
/// system knows no files without one, or where they could not be linked
Descriptor open_unnamed(const fs::path& path, fs::path& staging) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const bool can_link = ::access(kNamesOfOpenFiles, X_OK) == 0;
  Descriptor out(can_link ? ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666) : -1);
  const bool is_unknown = !can_link || errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL;
  for (int k = 0; !out && is_unknown && (k == 0 || errno == EEXIST); ++k) {
    staging = folder / fmt::format(".{}.partial-{}-{}", path.filename().string(), ::getpid(), k);
    out = Descriptor(::open(staging.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  }
  return out;
}

/// Gives a new file its name when all of it is written. @returns 0, EEXIST, or another error
int make_whole(const fs::path& path, std::string_view text) {
  fs::path staging;
  Descriptor out = open_unnamed(path, staging);
  if (!out) return errno;
  int error = write_all(out.get(), text);
  if (error == 0 && staging.empty()) {
    const std::string opened = fmt::format("{}/{}", kNamesOfOpenFiles, out.get());
    if (::linkat(AT_FDCWD, opened.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) != 0)
      error = errno;
  }
  if (const int closed = out.close(); error == 0) error = closed;
  if (staging.empty()) return error;
  if (error == 0) error = rename_new(staging, path);
  if (error != 0) ::unlink(staging.c_str());
  return error;
}

/// @returns 0, EAGAIN if the file is another one by now, or another error
int write_end(const Descriptor& file, const fs::path& path, std::uint64_t size,
              const Addition& addition) {
  struct stat now {};
  if (!has_name(file.get(), path, now) || static_cast<std::uint64_t>(now.st_size) != size)
    return EAGAIN;
  const auto whole = static_cast<off_t>(addition.whole);
  if (whole != now.st_size && ::ftruncate(file.get(), whole) != 0) return errno;
  const int error = write_all(file.get(), addition.lines);
  if (error != 0 && ::ftruncate(file.get(), whole) != 0) return errno;
  return error;
}

}  // namespace

Descriptor open_locked(const fs::path& path, int flags, std::chrono::milliseconds patience,
                       int& error) {
  for (int trial = 0; trial < kMostAttempts; ++trial) {
    Descriptor file(::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666));
    error = file ? 0 : errno;
    if (!file) return file;
    if (!lock(file.get(), patience)) break;
    struct stat now {};
    if (has_name(file.get(), path, now)) return file;
  }
  error = EWOULDBLOCK;
  return {};
}

void add_lines(const fs::path& path, base::InputKind kind, std::chrono::milliseconds patience,
               const std::function<Addition(std::optional<base::OpenedFile>)>& addition) {
  int error = EAGAIN;
  for (int trial = 0; (error == EAGAIN || error == EEXIST) && trial < kMostAttempts; ++trial) {
    Descriptor file = open_locked(path, O_RDWR | O_APPEND, patience, error);
    if (!file && error == ENOENT) {
      const Addition wanted = addition(std::nullopt);
      if (wanted.lines.empty()) return;
      error = make_whole(path, wanted.lines);
      continue;
    }
    if (!file && error == EWOULDBLOCK)
      throw TryAgain(fmt::format("{}: another program adds to it; try again later", path.string()));
    if (!file) break;
    struct stat status {};
    if (::fstat(file.get(), &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink > 1)
      throw InputError(
          fmt::format("{}: has {} names (hard links), and all of them would change; expected a "
                      "file of its own, as 'cp' makes",
                      path.string(), status.st_nlink));
    base::OpenedFile there(path, kind, ::fcntl(file.get(), F_DUPFD_CLOEXEC, 0));
    const std::uint64_t size = there.size();
    const Addition wanted = addition(std::move(there));
    if (wanted.lines.empty()) return;
    error = write_end(file, path, size, wanted);
    if (const int closed = file.close(); error == 0) error = closed;
  }
  if (error == EAGAIN || error == EEXIST) fail(path, "other programs keep changing it");
  if (error != 0) fail(path, reason(error));
}

}  // namespace leviosim::outputs
