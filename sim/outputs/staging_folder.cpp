#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>

#include "sim/base/error.h"
#include "sim/outputs/output_folder.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

/// The record while it is written, and a file that is never seen, which holds disk space.
constexpr const char* kNewRecord = ".leviosim-files.new";
constexpr const char* kReserveFile = ".leviosim-reserve";

bool is_still_at(int descriptor, const fs::path& path) {
  struct stat held {};
  const std::optional<struct stat> there = status_of(path);
  return ::fstat(descriptor, &held) == 0 && there && is_same_file(held, *there);
}

}  // namespace

StagingFolder::StagingFolder(fs::path path, const std::string& shown) : path_(std::move(path)) {
  constexpr int kMostTrials = 100;
  for (int trial = 0; !held_ && trial < kMostTrials; ++trial) held_ = acquire(shown);
  if (!held_) throw InputError(fmt::format("{}: others keep writing it", shown));
  // The destructor does not run for what throws here.
  try {
    remove_leftovers(shown);
    if (::ftruncate(journal_.get(), 0) != 0 ||
        write_all(journal_.get(), OutputRecord::journal_header()) != 0)
      throw InputError(fmt::format("{}: cannot be written: {}", shown, reason(errno)));
  } catch (...) {
    struct stat status {};
    if (::fstat(journal_.get(), &status) == 0 && status.st_size == 0)
      OutputRecord().remove_from(path_);
    throw;
  }
}

/// @returns false if it has to be tried again
bool StagingFolder::acquire(const std::string& shown) {
  const auto fail = [&](int error) {
    throw InputError(fmt::format("{}: cannot be created: {}", shown, reason(error)));
  };
  if (::mkdir(path_.c_str(), 0777) != 0 && errno != EEXIST) fail(errno);
  const Descriptor folder(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!folder && errno == ENOENT) return false;
  if (!folder)
    throw InputError(fmt::format(
        "{}: {} is in the way, where the results are written first: {}; remove it by hand", shown,
        path_.string(), reason(errno)));
  constexpr int kFlags = O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  journal_ = Descriptor(::openat(folder.get(), kRecordName, kFlags, 0666));
  if (!journal_ && errno == ENOENT) return false;
  if (!journal_) fail(errno);
  if (!lock(journal_.get(), false)) {
    const std::optional<OutputRecord> other = OutputRecord::read(path_);
    throw InputError(fmt::format("{}: another leviosim{} is writing it", shown,
                                 other && other->process() > 0
                                     ? fmt::format(" (process {})", other->process())
                                     : std::string()));
  }
  return is_still_at(folder.get(), path_) && is_still_at(journal_.get(), path_ / kRecordName);
}

/// Of a process that died: its lock is free.
void StagingFolder::remove_leftovers(const std::string& shown) const {
  OutputRecord left = OutputRecord::read(path_).value_or(OutputRecord());
  for (const char* name : {kNewRecord, kReserveFile})
    if (left.process() > 0) left.add(name, {});
  if (const std::string foreign = left.first_foreign(path_); !foreign.empty())
    throw InputError(fmt::format(
        "{}: {}, where the results are written first, holds {}, which leviosim did not write; "
        "remove it by hand",
        shown, path_.string(), foreign));
  left.remove_files_from(path_);
}

StagingFolder::~StagingFolder() {
  if (held_) record_.remove_from(path_);
}

int StagingFolder::write(const std::string& name, std::string_view bytes) {
  const fs::path file = path_ / name;
  std::error_code error;
  {
    const std::lock_guard<std::mutex> guard(mutex_);
    reserve_ = Descriptor();
    if (const int fault = write_all(journal_.get(), OutputRecord::line(name, {}))) return fault;
    record_.add(name, {});
    fs::create_directories(file.parent_path(), error);
  }
  if (error) return error.value();
  const Descriptor out(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!out) return errno;
  if (const int fault = write_all(out.get(), bytes)) return fault;
  const FileState state = state_of_bytes(bytes);
  const std::lock_guard<std::mutex> guard(mutex_);
  record_.add(name, state);
  return write_all(journal_.get(), OutputRecord::line(name, state));
}

int StagingFolder::reserve(std::uint64_t bytes) {
  if (!reserve_) {
    const fs::path file = path_ / kReserveFile;
    reserve_ = Descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (!reserve_) return errno;
    ::unlink(file.c_str());
  }
  // The call of Linux: posix_fallocate(3) writes zeros where the file system cannot.
  if (::fallocate(reserve_.get(), 0, 0, static_cast<off_t>(bytes)) == 0) return 0;
  return errno == EOPNOTSUPP || errno == ENOSYS ? 0 : errno;
}

int StagingFolder::finish() {
  record_.drop_states_without_digest();
  const fs::path file = path_ / kNewRecord;
  Descriptor record(::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!record) return errno;
  lock(record.get(), false);
  int fault = write_all(record.get(), record_.text());
  if (fault == 0 && ::rename(file.c_str(), (path_ / kRecordName).c_str()) != 0) fault = errno;
  if (fault == 0)
    journal_ = std::move(record);  // locked, as the journal was
  else
    ::unlink(file.c_str());
  return fault;
}

}  // namespace leviosim::outputs
