#include "sim/outputs/output_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <fmt/core.h>

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

Spool OutputFolder::spool(const std::string& name) const {
  return Spool(staging_->path(), fmt::format("{}: {}", request().shown(), name));
}

void OutputFolder::write(const std::string& name, const Content& content) {
  const int error = staging_->write(name, content);
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

}  // namespace leviosim::outputs
