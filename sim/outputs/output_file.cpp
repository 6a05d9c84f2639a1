#include "sim/outputs/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <fmt/core.h>

#include <cerrno>

namespace leviosim::outputs {
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

std::optional<std::string> OutputFile::publish(const Content& content) {
  const std::string name = path().filename().string();
  StagingFolder staging(path(), request().shown(), kPatience);
  FileState state;
  if (const int error = staging.write(name, content, &state))
    refuse("cannot be written: " + reason(error));
  HeldRecord record = shared_record(path().parent_path());
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
