#include "sim/outputs/new_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

/// That the file system has no files without a name. (ENOENT, EISDIR: kernels before 3.11.)
bool means_unknown(int error) {
  return error == EOPNOTSUPP || error == EINVAL || error == EISDIR || error == ENOENT;
}

}  // namespace

NewFile::~NewFile() {
  if (is_hidden_) ::unlink(hidden_.c_str());
}

/// Without a name. @returns 0, or the error
int NewFile::open() {
  if (file_) return 0;
  file_ = Descriptor(::open(hidden_.parent_path().c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666));
  return file_ ? 0 : errno;
}

int NewFile::reserve(std::uint64_t bytes) {
  const int error = open();
  if (error != 0) return means_unknown(error) ? 0 : error;
  if (::fallocate(file_.get(), 0, 0, static_cast<off_t>(bytes)) == 0) return 0;
  return errno == EOPNOTSUPP || errno == ENOSYS ? 0 : errno;
}

bool NewFile::needs_name() {
  const int error = open();
  return error != 0 && means_unknown(error);
}

int NewFile::write(std::string_view bytes) {
  if (needs_name()) {
    constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    file_ = Descriptor(::open(hidden_.c_str(), kFlags, 0666));
    is_hidden_ = static_cast<bool>(file_);
  }
  if (!file_) return errno;
  if (::ftruncate(file_.get(), 0) != 0) return errno;
  return write_all(file_.get(), bytes);
}

int NewFile::hide() {
  if (is_hidden_) return 0;
  const int error = place(hidden_);
  is_hidden_ = error == 0;
  return error;
}

int NewFile::place(const fs::path& name) {
  if (is_hidden_) {
    const int error = rename_new(hidden_, name);
    if (error == 0) is_hidden_ = false;
    return error;
  }
  const std::string link = fmt::format("/proc/self/fd/{}", file_.get());
  const int done = ::linkat(AT_FDCWD, link.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW);
  return done == 0 ? 0 : errno;
}

}  // namespace leviosim::outputs
