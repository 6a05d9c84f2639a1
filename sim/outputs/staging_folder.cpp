#include "sim/outputs/staging_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <fmt/core.h>

#include <cerrno>

#include "sim/base/error.h"
#include "sim/base/sha256.h"
#include "sim/outputs/try_again.h"

namespace leviosim::outputs {
namespace fs = std::filesystem;

fs::path StagingFolder::place_of(const fs::path& target) {
  return target.parent_path() / fmt::format(".{}.leviosim", target.filename().string());
}

// The first constructor is over when the body begins, so the destructor runs for what is thrown.
StagingFolder::StagingFolder(const fs::path& target, const std::string& shown,
                             std::chrono::milliseconds patience)
    : StagingFolder(place_of(target)) {
  constexpr int kMostTrials = 100;
  bool is_held = false;
  for (int trial = 0; !is_held && trial < kMostTrials; ++trial) is_held = acquire(shown, patience);
  if (!is_held) throw TryAgain(fmt::format("{}: others keep writing it", shown));
  const FolderContents left = contents_of(path_);
  if (!left.is_ours())
    throw InputError(fmt::format(
        "{}: {}, where the results are written first, holds {}, which leviosim did not write; "
        "remove it by hand",
        shown, path_.string(), left.foreign));
  left.remove(folder_);
  record_->clear();
  is_clean_ = true;
}

/// @returns false if it has to be tried again
bool StagingFolder::acquire(const std::string& shown, std::chrono::milliseconds patience) {
  if (::mkdir(path_.c_str(), 0777) != 0 && errno != EEXIST)
    fail_writing(errno, fmt::format("{}: cannot be created: {}", shown, reason(errno)));
  folder_ = Descriptor(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (!folder_ && errno == ENOENT) return false;
  if (!folder_)
    throw InputError(fmt::format(
        "{}: {} is in the way, where the results are written first: {}; remove it by hand", shown,
        path_.string(), reason(errno)));
  record_.emplace(path_, patience);
  if (record_->state() == HeldRecord::State::busy)
    throw TryAgain(fmt::format("{}: another leviosim is writing it: it holds {}", shown,
                               (path_ / kRecordName).string()));
  struct stat held {};
  const std::optional<struct stat> there = status_of(path_);
  return record_->state() == HeldRecord::State::held && ::fstat(folder_.get(), &held) == 0 &&
         there && is_same_file(held, *there);
}

StagingFolder::~StagingFolder() {
  if (let_go_) return;
  if (is_clean_) {
    if (!unfinished_.empty()) ::unlinkat(folder_.get(), unfinished_.c_str(), 0);
    record_->record().remove_files(folder_);
    for (auto name = folders_.rbegin(); name != folders_.rend(); ++name)
      ::unlinkat(folder_.get(), name->c_str(), AT_REMOVEDIR);
  }
  if (is_clean_ || (record_ && record_->state() == HeldRecord::State::held && record_->is_empty()))
    ::unlinkat(folder_.get(), kRecordName, 0);
  ::rmdir(path_.c_str());
}

namespace {

/// @param state  of what was written
/// @returns 0, or the error
int write_content(const Descriptor& file, const Content& content, FileState& state) {
  constexpr std::size_t kTogether = 64 << 10;
  base::Sha256 digest;
  std::string waiting;  // short pieces are written together
  int error = 0;
  content.hand_to([&](std::string_view piece) {
    digest.add(piece);
    state.size += piece.size();
    waiting += piece;
    if (waiting.size() < kTogether) return;
    if (error == 0) error = write_all(file.get(), waiting);
    waiting.clear();
  });
  state.sha256 = digest.hex();
  return error == 0 ? write_all(file.get(), waiting) : error;
}

}  // namespace

int StagingFolder::write(const std::string& name, const Content& content, FileState* written) {
  const std::lock_guard<std::mutex> guard(mutex_);
  reserve_ = Descriptor();
  if (::faccessat(folder_.get(), name.c_str(), F_OK, AT_SYMLINK_NOFOLLOW) == 0) return EEXIST;
  Descriptor file;
  if (const int error = begin_file(file)) return error;
  FileState state;
  if (const int error = write_content(file, content, state)) return error;
  if (const int error = file.close()) return error;
  record_->add(name, state);
  if (written != nullptr) *written = state;
  // Not before: a folder that the record does not lead to is taken for another's after a kill.
  if (const int error = make_folders(name)) return error;
  return end_file(name.c_str());
}

int StagingFolder::make_folders(const std::string& name) {
  for (std::size_t end = name.find('/'); end != std::string::npos; end = name.find('/', end + 1)) {
    const auto [folder, is_new] = folders_.insert(name.substr(0, end));
    if (is_new && ::mkdirat(folder_.get(), folder->c_str(), 0777) != 0) return errno;
  }
  return 0;
}

int StagingFolder::begin_file(Descriptor& file) {
  if (!unfinished_.empty()) ::unlinkat(folder_.get(), unfinished_.c_str(), 0);
  unfinished_ = kUnnumbered;
  file = Descriptor(::openat(folder_.get(), kUnnumbered,
                             O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  struct stat status {};
  if (!file || ::fstat(file.get(), &status) != 0) return errno;
  std::string numbered = unfinished_name(status);
  if (::renameat(folder_.get(), kUnnumbered, folder_.get(), numbered.c_str()) != 0) return errno;
  unfinished_ = std::move(numbered);
  return 0;
}

int StagingFolder::end_file(const char* name) {
  if (::renameat(folder_.get(), unfinished_.c_str(), folder_.get(), name) != 0) return errno;
  unfinished_.clear();
  return 0;
}

int StagingFolder::reserve(std::uint64_t bytes) {
  if (!reserve_) {
    if (const int error = begin_file(reserve_)) return error;
    ::unlinkat(folder_.get(), unfinished_.c_str(), 0);  // it is never seen
    unfinished_.clear();
  }
  // The call of Linux: posix_fallocate(3) writes zeros where the file system cannot.
  if (::fallocate(reserve_.get(), 0, 0, static_cast<off_t>(bytes)) == 0) return 0;
  return errno == EOPNOTSUPP || errno == ENOSYS ? 0 : errno;
}

int StagingFolder::finish() {
  reserve_ = Descriptor();
  Descriptor file;
  if (const int error = begin_file(file)) return error;
  lock(file.get(), {});
  if (const int error = write_all(file.get(), record_->record().text())) return error;
  if (const int error = end_file(kRecordName)) return error;
  record_->become(std::move(file));
  return 0;
}

}  // namespace leviosim::outputs
