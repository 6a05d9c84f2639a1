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

bool is_empty_folder(const fs::path& path) {
  const auto names = names_in(path);
  return names && names->empty();
}

}  // namespace

OutputFolder::OutputFolder(OutputRequest wanted) : OutputPlace(std::move(wanted), "a folder") {
  if (status_of(path()))
    for (const fs::path& input : request().inputs)
      if (!input.empty() && lies_in(input, path()))
        refuse(fmt::format("holds {}, which is read; choose another folder", input.string()));
  judge();
  try {
    make_parents();
    staging_.emplace(path(), request().shown(), std::chrono::milliseconds(0));
    judge();  // another process may have finished since
    reserve(kLeastReserve);
  } catch (...) {
    remove_empty_parents();
    throw;
  }
}

/// Whether the results could be put in place now.
void OutputFolder::judge() const {
  const std::optional<struct stat> status = status_of(path());
  if (!status) return;
  if (S_ISLNK(status->st_mode)) refuse("is a symbolic link that leads nowhere");
  if (!S_ISDIR(status->st_mode)) refuse("is a file; expected a folder");
  const std::optional<struct stat> parent = status_of(path().parent_path());
  if (parent && parent->st_dev != status->st_dev)
    refuse("is the top of a file system and cannot be replaced; choose a folder in it");
  if (is_empty_folder(path())) return;
  const FolderContents there = contents_of(path(), request().repair);
  if (!there.record)
    refuse(
        fmt::format("exists and holds something other than results: {}, and no record of what "
                    "leviosim wrote there ({}); choose a new folder, or remove this one by hand",
                    there.foreign, kRecordName));
  if (!there.foreign.empty())
    refuse(
        fmt::format("holds something other than results: {}, which leviosim did not write, or "
                    "which was changed since; choose a new folder",
                    there.foreign));
  if (!request().replace)
    refuse("exists and holds results; choose a new folder, or --force to replace them");
}

void OutputFolder::make_parents() {
  std::vector<fs::path> missing;
  for (fs::path at = path().parent_path(); !at.empty() && !status_of(at); at = at.parent_path())
    missing.push_back(at);
  made_parents_.reserve(missing.size());
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
    if (::mkdir(folder->c_str(), 0777) == 0)
      made_parents_.push_back(std::move(*folder));
    else if (errno != EEXIST)
      refuse("cannot be created: " + reason(errno));
  }
}

/// Of results that were not committed.
void OutputFolder::remove_empty_parents() {
  staging_.reset();
  for (auto made = made_parents_.rbegin(); made != made_parents_.rend(); ++made)
    ::rmdir(made->c_str());
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
  // Held until the old results are gone, so that nobody takes them for those of a dead process.
  Descriptor old_folder;
  Descriptor old_record;
  FolderContents old;
  const auto is_ours = [&](const fs::path& folder) {
    old_folder =
        Descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    old_record = Descriptor(
        ::openat(old_folder.get(), kRecordName, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (!old_record || !lock(old_record.get(), kPatience)) return false;
    try {
      old = contents_of(folder, request().repair);
    } catch (const InputError&) {
      return false;
    }
    return old.is_ours();
  };
  std::optional<std::string> elsewhere = put(*staging_, staging_->path(), is_ours);
  staging_->let_go();
  if (elsewhere || !old.is_ours()) return elsewhere;
  old.remove(old_folder);
  ::unlinkat(old_folder.get(), kRecordName, 0);
  ::rmdir(staging_->path().c_str());
  return std::nullopt;
}

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kReserve = 256 << 10;

}  // namespace

OutputFile::OutputFile(OutputRequest wanted) : OutputPlace(std::move(wanted), "a file") {
  judge();
  // What will fail at the end fails now: a record that others hold, a full disk.
  if (status_of(path().parent_path() / kRecordName)) shared_record(path().parent_path());
  StagingFolder staging(path(), request().shown(), kPatience);
  if (const int error = staging.reserve(kReserve)) refuse("cannot be written: " + reason(error));
}

/// Whether the file could be put in place now.
void OutputFile::judge() const {
  const fs::path folder = path().parent_path();
  const std::string name = path().filename().string();
  const std::optional<struct stat> status = status_of(path());
  if ((status && S_ISDIR(status->st_mode)) || !fs::path(request().path).has_filename())
    refuse("is a folder; expected a file");
  std::error_code error;
  if (!fs::is_directory(folder, error)) refuse("there is no folder " + folder.string());
  if (name == kRecordName) refuse("is the record of what leviosim wrote");
  const std::optional<OutputRecord> record = OutputRecord::read(folder);
  if (!status) return;
  if (S_ISLNK(status->st_mode)) refuse("is a symbolic link that leads nowhere");
  if (!S_ISREG(status->st_mode)) refuse("exists, and is no regular file; choose a new file");
  for (const fs::path& input : request().inputs)
    if (!input.empty() && lies_in(path(), input))
      refuse(fmt::format("is read, as {}; choose another file", input.string()));
  if (!record || !record->describes(folder, name))
    refuse(
        "exists, and is not a file that leviosim wrote, or was changed since; choose a new file");
  if (!request().replace) refuse("exists; choose a new file, or --force to replace it");
}

std::optional<std::string> OutputFile::publish(std::string_view bytes) {
  const std::string name = path().filename().string();
  StagingFolder staging(path(), request().shown(), kPatience);
  if (const int error = staging.write(name, bytes)) refuse("cannot be written: " + reason(error));
  HeldRecord record = shared_record(path().parent_path());
  const FileState state = state_of_bytes(bytes);
  record.add(name, state);
  std::optional<std::string> elsewhere =
      put(staging, staging.path() / name, [&](const fs::path& file) {
        const std::optional<FileState> there = state_of_file(file);
        return there && record.record().says(name, *there);
      });
  if (elsewhere) record.add(fs::path(shown_path()).filename().string(), state);
  return elsewhere;
}

}  // namespace leviosim::outputs
