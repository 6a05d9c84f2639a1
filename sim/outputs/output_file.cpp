#include "sim/outputs/output_file.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>

#include "sim/base/error.h"
#include "sim/outputs/held_record.h"

namespace leviosim::outputs {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kReserve = 256 << 10;

}  // namespace

OutputFile::OutputFile(OutputRequest request)
    : request_(std::move(request)), shown_path_(request_.path) {
  if (request_.path.empty()) throw InputError(request_.option + ": is empty; expected a file");
  std::error_code error;
  target_ = resolved(request_.path, error);
  if (error) refuse("cannot be written: " + error.message());
  {
    // Another process may be replacing the file; its steps must not be seen.
    std::optional<HeldRecord> held;
    if (status_of(target_.parent_path() / kRecordName)) held.emplace(target_.parent_path());
    judge();
    remove_leftover();
  }
  file_ = std::make_unique<NewFile>(hidden());
  if (const int fault = file_->reserve(kReserve)) refuse("cannot be written: " + reason(fault));
}

void OutputFile::refuse(const std::string& why) const {
  throw InputError(fmt::format("{}: {}", request_.shown(), why));
}

/// Whether the file could be put in place now.
void OutputFile::judge() const {
  const fs::path folder = target_.parent_path();
  const std::optional<struct stat> status = status_of(target_);
  if ((status && S_ISDIR(status->st_mode)) || !fs::path(request_.path).has_filename())
    refuse("is a folder; expected a file");
  std::error_code error;
  if (!fs::is_directory(folder, error)) refuse("there is no folder " + folder.string());
  if (target_.filename() == kRecordName) refuse("is the record of what leviosim wrote");
  const std::optional<OutputRecord> record = OutputRecord::read(folder);
  if (!status) return;
  if (S_ISLNK(status->st_mode)) refuse("is a symbolic link that leads nowhere");
  if (!S_ISREG(status->st_mode)) refuse("exists, and is no regular file; choose a new file");
  for (const fs::path& input : request_.inputs)
    if (!input.empty() && lies_in(target_, input))
      refuse(fmt::format("is read, as {}; choose another file", input.string()));
  if (!record || !record->describes(folder, target_.filename().string()))
    refuse(
        "exists, and is not a file that leviosim wrote, or was changed since; choose a new file");
  if (!request_.replace) refuse("exists; choose a new file, or --force to replace it");
}

fs::path OutputFile::hidden() const {
  return target_.parent_path() / fmt::format(".{}.leviosim", target_.filename().string());
}

/// A process that died while it replaced the file has left one under the hidden name.
void OutputFile::remove_leftover() const {
  const fs::path folder = target_.parent_path();
  const fs::path file = hidden();
  if (!status_of(file)) return;
  const std::optional<OutputRecord> record = OutputRecord::read(folder);
  if (!record || !record->describes(folder, file.filename().string()))
    refuse(fmt::format("{} is in the way, which leviosim did not write; remove it by hand",
                       file.string()));
  ::unlink(file.c_str());
}

std::optional<std::string> OutputFile::publish(std::string_view bytes) {
  const FileState state = state_of_bytes(bytes);
  HeldRecord record(target_.parent_path());
  if (file_->needs_name()) record.add(hidden().filename().string(), state);
  if (const int error = file_->write(bytes)) refuse("cannot be written: " + reason(error));
  record.add(target_.filename().string(), state);
  int error = file_->place(target_);
  if (error == EEXIST && request_.replace) {
    record.add(hidden().filename().string(), state);
    error = replace(record);
  }
  if (error == EEXIST) return publish_aside(record, state);
  if (error != 0) refuse("cannot be put in place: " + reason(error));
  return std::nullopt;
}

/// In place of the file of before, which is looked at again once it is out of the way.
/// @returns 0, EEXIST if that is not leviosim's, or another error
int OutputFile::replace(HeldRecord& record) {
  const std::string name = target_.filename().string();
  const std::optional<FileState> old = state_of_file(target_);
  if (!old || !record.record().says(name, *old)) return EEXIST;
  record.add(hidden().filename().string(), *old);
  if (const int error = file_->hide()) return error;
  if (const int error = exchange(hidden(), target_)) return error;
  if (state_of_file(hidden()) == old) return 0;  // it is removed with file_
  const int error = exchange(hidden(), target_);
  if (error == 0) return EEXIST;
  file_->forget();
  refuse(fmt::format("something was put there meanwhile, and is {} now", hidden().string()));
}

/// Under the first name beside it that is free.
std::string OutputFile::publish_aside(HeldRecord& record, const FileState& state) {
  int error = EEXIST;
  for (int k = 2; error == EEXIST; ++k) {
    const fs::path name = free_name(target_, k);
    if (status_of(name)) continue;
    record.add(name.filename().string(), state);
    error = file_->place(name);
    shown_path_ = free_name(request_.path, k).string();
  }
  if (error != 0) refuse("cannot be put in place: " + reason(error));
  return fmt::format(
      "{}: something else was put there meanwhile, and is left as it is; the file is {}",
      request_.shown(), shown_path_);
}

void add_to_record(const fs::path& folder, const std::string& name, const FileState& state) {
  HeldRecord(folder).add(name, state);
}

}  // namespace leviosim::outputs
