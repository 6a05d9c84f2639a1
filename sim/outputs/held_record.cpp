#include "sim/outputs/held_record.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>

#include "sim/base/error.h"

namespace leviosim::outputs {

HeldRecord::HeldRecord(const std::filesystem::path& folder) : file_(folder / kRecordName) {
  for (bool is_held = false; !is_held;) {
    constexpr int kFlags = O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
    descriptor_ = Descriptor(::open(file_.c_str(), kFlags, 0666));
    if (!descriptor_ && (errno == EACCES || errno == EPERM || errno == EROFS)) break;
    if (!descriptor_) fail(errno);
    lock(descriptor_.get(), true);
    struct stat held {};
    const std::optional<struct stat> there = status_of(file_);
    is_held = ::fstat(descriptor_.get(), &held) == 0 && there && is_same_file(held, *there);
  }
  record_ = OutputRecord::read(folder).value_or(OutputRecord());
}

void HeldRecord::add(const std::string& path, const FileState& state) {
  if (!descriptor_ || record_.says(path, state)) return;
  struct stat before {};
  if (::fstat(descriptor_.get(), &before) != 0) fail(errno);
  const std::string line = OutputRecord::line(path, state);
  const int error =
      write_all(descriptor_.get(), before.st_size == 0 ? OutputRecord::header() + line : line);
  if (error != 0) {
    if (::ftruncate(descriptor_.get(), before.st_size) != 0) fail(errno);
    fail(error);
  }
  record_.add(path, state);
}

void HeldRecord::fail(int error) const {
  throw InputError(fmt::format("{}: cannot be written: {}", file_.string(), reason(error)));
}

}  // namespace leviosim::outputs
