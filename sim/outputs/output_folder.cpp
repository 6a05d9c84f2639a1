#include "sim/outputs/output_folder.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>

#include "sim/base/error.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

/// That every folder of results takes, and more.
constexpr std::uint64_t kLeastReserve = 256 << 10;

fs::path staging_of(const fs::path& target) {
  return target.parent_path() / fmt::format(".{}.leviosim", target.filename().string());
}

bool is_empty_folder(const fs::path& path) {
  std::error_code error;
  const fs::directory_iterator entries(path, error);
  return !error && entries == fs::directory_iterator();
}

}  // namespace

OutputFolder::OutputFolder(OutputRequest request)
    : request_(std::move(request)), shown_path_(request_.path) {
  if (request_.path.empty())
    throw InputError(fmt::format("{}: is empty; expected a folder",
                                 request_.option.empty() ? "output" : request_.option));
  std::error_code error;
  target_ = resolved(request_.path, error);
  if (error) refuse("cannot be used: " + error.message());
  check_inputs();
  judge();
  try {
    make_parents();
    staging_.emplace(staging_of(target_), request_.shown());
    judge();  // another process may have finished since
    reserve(kLeastReserve);
  } catch (...) {
    staging_.reset();
    for (auto made = made_parents_.rbegin(); made != made_parents_.rend(); ++made)
      ::rmdir(made->c_str());
    throw;
  }
}

OutputFolder::~OutputFolder() {
  staging_.reset();
  // Only those that are empty: of results that were not committed.
  for (auto made = made_parents_.rbegin(); made != made_parents_.rend(); ++made)
    ::rmdir(made->c_str());
}

void OutputFolder::refuse(const std::string& why) const {
  throw InputError(fmt::format("{}: {}", request_.shown(), why));
}

void OutputFolder::check_inputs() const {
  if (!status_of(target_)) return;
  for (const fs::path& input : request_.inputs)
    if (!input.empty() && lies_in(input, target_))
      refuse(fmt::format("holds {}, which is read; choose another folder", input.string()));
}

/// Whether the results could be put in place now.
void OutputFolder::judge() const {
  const std::optional<struct stat> status = status_of(target_);
  if (!status) return;
  if (S_ISLNK(status->st_mode)) refuse("is a symbolic link that leads nowhere");
  if (!S_ISDIR(status->st_mode)) refuse("is a file; expected a folder");
  const std::optional<struct stat> parent = status_of(target_.parent_path());
  if (parent && parent->st_dev != status->st_dev)
    refuse("is the top of a file system and cannot be replaced; choose a folder in it");
  if (is_empty_folder(target_)) return;
  const std::optional<OutputRecord> record = OutputRecord::read(target_);
  const std::string foreign =
      record.value_or(OutputRecord()).first_foreign(target_, request_.repair);
  if (!record)
    refuse(
        fmt::format("exists and holds something else than results: {}, and no record of what "
                    "leviosim wrote there ({}); choose a new folder, or remove this one by hand",
                    foreign, kRecordName));
  if (!foreign.empty())
    refuse(
        fmt::format("holds something else than results: {}, which leviosim did not write, or "
                    "which was changed since; choose a new folder",
                    foreign));
  if (!request_.replace)
    refuse("exists and holds results; choose a new folder, or --force to replace them");
}

void OutputFolder::make_parents() {
  std::vector<fs::path> missing;
  for (fs::path at = target_.parent_path(); !at.empty() && !status_of(at); at = at.parent_path())
    missing.push_back(at);
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
    if (::mkdir(folder->c_str(), 0777) == 0)
      made_parents_.push_back(*folder);
    else if (errno != EEXIST)
      refuse("cannot be created: " + reason(errno));
  }
}

void OutputFolder::reserve(std::uint64_t bytes) {
  const int error = staging_->reserve(bytes + kLeastReserve);
  if (error != 0)
    refuse(fmt::format("the {} kB that results may take cannot be set aside: {}",
                       (bytes + kLeastReserve) / 1024, reason(error)));
}

void OutputFolder::write(const std::string& name, std::string_view bytes) {
  const int error = staging_->write(name, bytes);
  if (error != 0) refuse(fmt::format("{} cannot be written: {}", name, reason(error)));
}

std::optional<std::string> OutputFolder::commit() {
  if (const int error = staging_->finish())
    refuse(fmt::format("{} cannot be written: {}", kRecordName, reason(error)));
  const int error = publish();
  staging_->let_go();
  if (error == 0) return std::nullopt;
  return publish_aside(error);
}

/// @returns 0, or why the results could not be given their name
int OutputFolder::publish() {
  const std::optional<struct stat> status = status_of(target_);
  if (request_.replace && status && S_ISDIR(status->st_mode) && !is_empty_folder(target_))
    return replace();
  // Of all that may be there by now, rename(2) replaces nothing but an empty folder.
  return ::rename(staging_->path().c_str(), target_.c_str()) == 0 ? 0 : errno;
}

bool OutputFolder::is_ours(const fs::path& folder) const {
  try {
    const std::optional<OutputRecord> record = OutputRecord::read(folder);
    return record && record->first_foreign(folder, request_.repair).empty();
  } catch (const InputError&) {
    return false;
  }
}

/// In place of old results. What was taken out of the way is looked at again before it is removed.
int OutputFolder::replace() {
  if (!is_ours(target_)) return ENOTEMPTY;
  // Held until the old results are gone, so that nobody takes them for those of a dead process.
  const Descriptor old_record(
      ::open((target_ / kRecordName).c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC));
  if (old_record) lock(old_record.get(), true);
  const fs::path& old_results = staging_->path();
  if (const int error = exchange(staging_->path(), target_)) return error;
  if (!is_ours(old_results)) {
    if (exchange(old_results, target_) == 0) return ENOTEMPTY;
    staging_->let_go();
    refuse(fmt::format("something was put there meanwhile; what was there is in {} now",
                       move_aside()));
  }
  OutputRecord::read(old_results)->remove_from(old_results);
  return 0;
}

/// Gives what lies under the hidden name the first name beside the target that is free.
/// @returns the name, as the user would say it
std::string OutputFolder::move_aside() {
  constexpr int kMostNames = 10'000;
  const fs::path given(request_.path);
  const fs::path user_path = given.has_filename() ? given : given.parent_path();
  int error = EEXIST;
  for (int k = 2; k < kMostNames && (error == EEXIST || error == ENOTEMPTY); ++k) {
    error = rename_new(staging_->path(), free_name(target_, k));
    if (error == 0) return free_name(user_path, k).string();
  }
  return staging_->path().string();
}

std::string OutputFolder::publish_aside(int error) {
  const bool is_taken = error == ENOTEMPTY || error == EEXIST || error == ENOTDIR;
  shown_path_ = move_aside();
  return fmt::format("{}: {}; the results are in {}", request_.shown(),
                     is_taken ? "something else was put there meanwhile, and is left as it is"
                              : "cannot be put in place: " + reason(error),
                     shown_path_);
}

}  // namespace leviosim::outputs
