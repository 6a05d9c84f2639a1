#include "sim/outputs/spool.h"

#include <fcntl.h>
#include <unistd.h>

#include <fmt/core.h>

#include <cerrno>
#include <cstdlib>

#include "sim/base/error.h"

namespace leviosim::outputs {
namespace {

constexpr std::size_t kPiece = 64 << 10;

/// Where the file system has no such files, one among the temporary files, whose name is removed
/// at once.
Descriptor file_without_name(const std::filesystem::path& folder) {
  Descriptor file(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (file || (errno != EOPNOTSUPP && errno != EISDIR && errno != ENOENT)) return file;
  std::error_code error;
  std::string name = std::filesystem::temp_directory_path(error) / "leviosim.XXXXXX";
  Descriptor named(::mkostemp(name.data(), O_CLOEXEC));
  if (named) ::unlink(name.c_str());
  return named;
}

}  // namespace

Spool::Spool(const std::filesystem::path& folder, std::string shown)
    : shown_(std::move(shown)), file_(file_without_name(folder)) {
  if (!file_) refuse(errno);
}

void Spool::refuse(int error) const {
  throw InputError(fmt::format("{}: cannot be written: {}", shown_, reason(error)));
}

void Spool::add(std::string_view bytes) {
  waiting_ += bytes;
  if (waiting_.size() >= kPiece) flush();
}

void Spool::flush() {
  if (const int error = write_all(file_.get(), waiting_)) refuse(error);
  waiting_.clear();
}

Content Spool::content() {
  flush();
  return Content([this](const Sink& sink) {
    std::string piece(kPiece, '\0');
    for (off_t at = 0;;) {
      const ssize_t size = ::pread(file_.get(), piece.data(), piece.size(), at);
      if (size < 0 && errno == EINTR) continue;
      if (size < 0) refuse(errno);
      if (size == 0) return;
      sink(std::string_view(piece).substr(0, static_cast<std::size_t>(size)));
      at += size;
    }
  });
}

}  // namespace leviosim::outputs
