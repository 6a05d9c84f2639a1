#include "sim/outputs/file_system.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/sha256.h"
#include "sim/outputs/try_again.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

/// As much as a work trace may have (sim/base/input_file.h), the largest of leviosim's files.
constexpr std::uint64_t kLargestFile = std::uint64_t{4} << 30;

/// For reading. Links are not followed, and pipes not waited for.
Descriptor open_regular(const fs::path& path, std::uint64_t& size) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  size = static_cast<std::uint64_t>(status.st_size);
  return file;
}

/// The next bytes. @returns how many, 0 at the end, -1 for a fault
ssize_t read_some(int descriptor, char* into, std::size_t size) {
  ssize_t got = 0;
  do got = ::read(descriptor, into, size);
  while (got < 0 && errno == EINTR);
  return got;
}

bool is_unknown(int error) { return error == EINVAL || error == ENOSYS || error == EOPNOTSUPP; }

int result_of(int returned) { return returned == 0 ? 0 : errno; }

}  // namespace

int Descriptor::close() {
  const int number = std::exchange(number_, -1);
  return number < 0 || ::close(number) == 0 ? 0 : errno;
}

std::string reason(int error) { return std::generic_category().message(error); }

std::optional<struct stat> status_of(const fs::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

bool is_same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

FileState state_of_bytes(std::string_view bytes) { return {base::sha256_of(bytes), bytes.size()}; }

std::optional<FileState> state_of_file(const fs::path& path) {
  std::uint64_t expected = 0;
  const Descriptor file = open_regular(path, expected);
  if (!file || expected > kLargestFile) return std::nullopt;
  FileState state;
  base::Sha256 digest;
  std::array<char, 1 << 16> buffer;
  while (state.size <= expected) {  // it may grow meanwhile
    throw_if_interrupted();
    const ssize_t got = read_some(file.get(), buffer.data(), buffer.size());
    if (got < 0) return std::nullopt;
    if (got == 0) break;
    digest.add({buffer.data(), static_cast<std::size_t>(got)});
    state.size += static_cast<std::uint64_t>(got);
  }
  state.sha256 = digest.hex();
  return state;
}

std::optional<std::string> try_read_file(const fs::path& path, std::uint64_t most) {
  std::uint64_t size = 0;
  return try_read_file(open_regular(path, size), most);
}

std::optional<std::string> try_read_file(const Descriptor& file, std::uint64_t most) {
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0) return std::nullopt;
  if (!S_ISREG(status.st_mode) || static_cast<std::uint64_t>(status.st_size) > most)
    return std::nullopt;
  std::string text(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t have = 0;
  while (have < text.size()) {
    const ssize_t got =
        ::pread(file.get(), text.data() + have, text.size() - have, static_cast<off_t>(have));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return std::nullopt;
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  text.resize(have);
  return text;
}

std::optional<std::set<std::string>> names_in(const fs::path& folder) {
  const std::unique_ptr<DIR, int (*)(DIR*)> open(::opendir(folder.c_str()), ::closedir);
  if (!open) return std::nullopt;
  std::set<std::string> names;
  errno = 0;
  while (const dirent* const entry = ::readdir(open.get())) names.insert(entry->d_name);
  if (errno != 0) return std::nullopt;
  names.erase(".");
  names.erase("..");
  return names;
}

int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return ENOSPC;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

bool lock(int descriptor, std::chrono::milliseconds patience) {
  constexpr std::chrono::milliseconds kBetweenTries{20};
  while (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    if (errno != EWOULDBLOCK) return true;
    throw_if_interrupted();
    if (patience <= kBetweenTries) return false;
    std::this_thread::sleep_for(kBetweenTries);
    patience -= kBetweenTries;
  }
  return true;
}

int rename_new(const fs::path& from, const fs::path& to) {
  const int error =
      result_of(::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE));
  if (!is_unknown(error)) return error;
  const std::optional<struct stat> status = status_of(from);
  if (!status) return ENOENT;
  // rename(2) gives a folder the name of nothing but an empty folder, link(2) replaces nothing.
  if (S_ISDIR(status->st_mode)) return result_of(::rename(from.c_str(), to.c_str()));
  if (::link(from.c_str(), to.c_str()) != 0) return errno;
  return result_of(::unlink(from.c_str()));
}

int exchange(const fs::path& a, const fs::path& b) {
  const int error =
      result_of(::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE));
  return is_unknown(error) ? exchange_by_steps(a, b) : error;
}

int exchange_by_steps(const fs::path& a, const fs::path& b) {
  fs::path between;
  int error = EEXIST;
  for (int k = 2; error == EEXIST || error == ENOTEMPTY; ++k) {
    between = free_name(b, k);
    error = rename_new(b, between);
  }
  if (error != 0) return error;
  error = rename_new(a, b);
  if (error != 0) {
    rename_new(between, b);
    return error;
  }
  return rename_new(between, a);
}

fs::path free_name(const fs::path& path, int k) {
  return path.parent_path() /
         fmt::format("{}-{}{}", path.stem().string(), k, path.extension().string());
}

fs::path resolved(const std::string& path, std::error_code& error) {
  const fs::path found = fs::weakly_canonical(fs::absolute(path, error), error);
  return found.has_filename() || found == found.root_path() ? found : found.parent_path();
}

bool lies_in(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  fs::path at = fs::canonical(path, error);
  if (error) return false;
  for (;;) {
    if (fs::equivalent(at, folder, error)) return true;
    if (error || at == at.root_path()) return false;
    at = at.parent_path();
  }
}

void write_file_atomically(const std::filesystem::path& file, std::string_view contents) {
  const std::string shown = file.string();
  std::filesystem::path staging;
  Descriptor out;
  for (int k = 0; !out && (k == 0 || errno == EEXIST); ++k) {
    staging = file.parent_path() /
              fmt::format(".{}.partial-{}-{}", file.filename().string(), ::getpid(), k);
    out = Descriptor(::open(staging.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  }
  int error = out ? 0 : errno;
  if (out) {
    error = write_all(out.get(), contents);
    if (const int fault = out.close(); error == 0) error = fault;
    if (error == 0 && ::rename(staging.c_str(), file.c_str()) != 0) error = errno;
    if (error != 0) ::unlink(staging.c_str());
  }
  if (error != 0)
    fail_writing(error, fmt::format("{}: cannot be written: {}", shown, reason(error)));
}

}  // namespace leviosim::outputs
