#include "sim/base/input_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "sim/base/check.h"
#include "sim/base/error.h"

namespace leviosim::base {
namespace {

constexpr std::int64_t kMiB = std::int64_t{1} << 20;

/// Far above what is in use: a platform file has 60 KiB, a 752x480 frame 0.4 MiB, 15 minutes of IMU
/// samples at 1 kHz 100 MiB.
constexpr std::array kKinds{
    InputKindInfo{InputKind::platform, "a platform file", 1 * kMiB},
    InputKindInfo{InputKind::plan, "a plan", 1 * kMiB},
    InputKindInfo{InputKind::sensor, "a sensor.yaml", 1 * kMiB},
    InputKindInfo{InputKind::table, "a table", 256 * kMiB},
    InputKindInfo{InputKind::image, "an image", 64 * kMiB},
    InputKindInfo{InputKind::work_trace, "a work trace", 4096 * kMiB},
    InputKindInfo{InputKind::cached_result, "a cached result", 16 * kMiB},
    InputKindInfo{InputKind::run_file, "a file of a run folder", 64 * kMiB},
    InputKindInfo{InputKind::budget, "a budget file", 1 * kMiB},
    InputKindInfo{InputKind::baseline, "a baseline", 4 * kMiB},
    InputKindInfo{InputKind::history, "a history", 256 * kMiB},
};

std::string reason_of(int error) { return std::system_category().message(error); }

std::string_view name_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  if (S_ISSOCK(mode)) return "a socket";
  return "something else";
}

class OpenFile {
 public:
  OpenFile(const std::filesystem::path& path, const InputKindInfo& kind)
      : path_(path), kind_(kind), descriptor_(open_waiting_for_nobody(path)) {
    // Some kinds cannot be opened at all (a socket, a FIFO that nobody may read): say what they
    // are.
    if (descriptor_ < 0) {
      const int error = errno;
      struct stat status {};
      if (::stat(path.c_str(), &status) == 0) require_regular(status);
      refuse(reason_of(error));
    }
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  std::string read_all() {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) refuse(reason_of(errno));
    require_regular(status);
    require_size(status.st_size);
    // The size is a hint only: files of /proc say 0, others grow while they are read.
    std::string bytes(static_cast<std::size_t>(status.st_size) + 1, '\0');
    std::size_t used = 0;
    while (const std::size_t read = read_some(bytes.data() + used, bytes.size() - used)) {
      used += read;
      require_size(static_cast<std::int64_t>(used));
      if (used == bytes.size()) bytes.resize(2 * used);
    }
    bytes.resize(used);
    return bytes;
  }

 private:
  /// A FIFO without a writer does not hold up an opening that is not to block.
  static int open_waiting_for_nobody(const std::filesystem::path& path) {
    return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  }

  std::size_t read_some(char* to, std::size_t most) {
    constexpr std::size_t kMostAtOnce = std::size_t{1} << 26;
    for (;;) {
      const ssize_t read = ::read(descriptor_, to, std::min(most, kMostAtOnce));
      if (read >= 0) return static_cast<std::size_t>(read);
      if (errno != EINTR)
        throw InputError(fmt::format("{}: cannot be read: {}", path_.string(), reason_of(errno)));
    }
  }
  void require_regular(const struct stat& status) const {
    if (!S_ISREG(status.st_mode))
      refuse(fmt::format("is {}; expected a regular file", name_of(status.st_mode)));
  }
  void require_size(std::int64_t bytes) const {
    if (bytes > kind_.most_bytes)
      throw InputError(fmt::format("{}: is larger than {} may be, which is {} MiB", path_.string(),
                                   kind_.name, kind_.most_bytes / kMiB));
  }
  [[noreturn]] void refuse(std::string_view reason) const {
    throw InputError(
        fmt::format("{}: cannot be opened as {}: {}", path_.string(), kind_.name, reason));
  }

  const std::filesystem::path& path_;
  const InputKindInfo& kind_;
  int descriptor_;
};

}  // namespace

const InputKindInfo& info_of(InputKind kind) {
  const InputKindInfo& info = kKinds[static_cast<std::size_t>(kind)];
  check(info.kind == kind, "kinds of inputs stand in their order");
  return info;
}

std::string read_file(const std::filesystem::path& path, InputKind kind) {
  return OpenFile(path, info_of(kind)).read_all();
}

PathKind kind_of(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISREG(status.st_mode)) return PathKind::file;
    return S_ISDIR(status.st_mode) ? PathKind::folder : PathKind::other;
  }
  if (errno == ENOENT || errno == ENOTDIR) return PathKind::missing;
  throw InputError(fmt::format("{}: cannot be looked up: {}", path.string(), reason_of(errno)));
}

}  // namespace leviosim::base
