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
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/opened_file.h"

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
    InputKindInfo{InputKind::film, "a film", 512 * kMiB},
    InputKindInfo{InputKind::work_trace, "a work trace", 4096 * kMiB},
    InputKindInfo{InputKind::cached_result, "a cached result", 16 * kMiB},
    InputKindInfo{InputKind::run_file, "a file of a run folder", 64 * kMiB},
    InputKindInfo{InputKind::budget, "a budget file", 1 * kMiB},
    InputKindInfo{InputKind::baseline, "a baseline", 4 * kMiB},
    InputKindInfo{InputKind::history, "a history", 256 * kMiB},
    InputKindInfo{InputKind::points, "a file of a sweep's points", 4096 * kMiB},
};

std::string reason_of(int error) { return std::system_category().message(error); }

std::string_view name_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  if (S_ISSOCK(mode)) return "a socket";
  return "something else";
}

/// A FIFO without a writer does not hold up an opening that is not to block. @returns -errno if it
/// cannot be opened
int open_waiting_for_nobody(const std::filesystem::path& path) {
  const int opened = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  return opened < 0 ? -errno : opened;
}

}  // namespace

const InputKindInfo& info_of(InputKind kind) {
  const InputKindInfo& info = kKinds[static_cast<std::size_t>(kind)];
  check(info.kind == kind, "kinds of inputs stand in their order");
  return info;
}

OpenedFile::OpenedFile(std::filesystem::path path, InputKind kind)
    : OpenedFile(path, kind, open_waiting_for_nobody(path)) {}

OpenedFile::OpenedFile(std::filesystem::path path, InputKind kind, int descriptor)
    : path_(std::move(path)), kind_(kind), descriptor_(descriptor) {
  // Some kinds cannot be opened at all (a socket, a FIFO that nobody may read): say what they are.
  struct stat status {};
  const bool is_known =
      (descriptor_ < 0 ? ::stat(path_.c_str(), &status) : ::fstat(descriptor_, &status)) == 0;
  try {
    if (is_known && !S_ISREG(status.st_mode))
      refuse(fmt::format("is {}; expected a regular file", name_of(status.st_mode)));
    if (descriptor_ < 0 || !is_known) refuse(reason_of(descriptor < 0 ? -descriptor : errno));
    size_ = static_cast<std::uint64_t>(status.st_size);
    require_size(size_);
  } catch (...) {
    if (descriptor_ >= 0) ::close(descriptor_);
    throw;
  }
}

OpenedFile::~OpenedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

OpenedFile::OpenedFile(OpenedFile&& other) noexcept
    : path_(std::move(other.path_)),
      kind_(other.kind_),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

OpenedFile& OpenedFile::operator=(OpenedFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(kind_, other.kind_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

std::size_t OpenedFile::read_at(std::uint64_t begin, char* to, std::size_t most) const {
  constexpr std::size_t kMostAtOnce = std::size_t{1} << 26;
  std::size_t all = 0;
  while (all < most) {
    // Small files are also read while an interrupted run removes what it staged.
    if (all > 0) throw_if_interrupted();
    const ssize_t read = ::pread(descriptor_, to + all, std::min(most - all, kMostAtOnce),
                                 static_cast<off_t>(begin + all));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0)
      throw InputError(fmt::format("{}: cannot be read: {}", path_.string(), reason_of(errno)));
    if (read == 0) break;
    all += static_cast<std::size_t>(read);
  }
  return all;
}

void OpenedFile::read_piece(std::uint64_t begin, std::string& piece) const {
  if (read_at(begin, piece.data(), piece.size()) < piece.size())
    throw InputError(fmt::format("{}: has become shorter while it was read", path_.string()));
}

std::string OpenedFile::read_all() const {
  // The size is a hint only: files of /proc say 0, others grow while they are read.
  std::string bytes(size_ + 1, '\0');
  std::size_t used = 0;
  while (const std::size_t read = read_at(used, bytes.data() + used, bytes.size() - used)) {
    used += read;
    require_size(used);
    if (used == bytes.size()) bytes.resize(2 * used);
  }
  bytes.resize(used);
  return bytes;
}

void OpenedFile::require_size(std::uint64_t bytes) const {
  const InputKindInfo& kind = info_of(kind_);
  if (bytes > static_cast<std::uint64_t>(kind.most_bytes))
    throw InputError(fmt::format("{}: is larger than {} may be, which is {} MiB", path_.string(),
                                 kind.name, kind.most_bytes / kMiB));
}

void OpenedFile::refuse(std::string_view reason) const {
  throw InputError(
      fmt::format("{}: cannot be opened as {}: {}", path_.string(), info_of(kind_).name, reason));
}

std::string read_file(const std::filesystem::path& path, InputKind kind) {
  return OpenedFile(path, kind).read_all();
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
