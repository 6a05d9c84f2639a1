#include "tools/app/study/sweep/sweep_folder.h"

#include <fmt/core.h>

#include <set>

#include "sim/base/error.h"
#include "tools/app/study/sweep/sweep_store.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

bool is_regular(const fs::path& file) {
  const std::optional<struct stat> status = outputs::status_of(file);
  return status && S_ISREG(status->st_mode);
}

[[noreturn]] void refuse(const SweepFolder::Request& request, const std::string& why) {
  throw InputError(fmt::format("{} {}: {}", request.option, request.path, why));
}

}  // namespace

SweepFolder::SweepFolder(const Request& request) {
  std::error_code error;
  path_ = outputs::resolved(request.path, error);
  if (error) refuse(request, "cannot be used: " + error.message());
  refuse_old_sweep(path_);
  const std::optional<struct stat> status = outputs::status_of(path_);
  if (status && S_ISLNK(status->st_mode)) refuse(request, "is a symbolic link that leads nowhere");
  if (status && !S_ISDIR(status->st_mode)) refuse(request, "is a file; expected a folder");
  const auto names = status ? outputs::names_in(path_) : std::set<std::string>();
  if (!names) refuse(request, "cannot be listed");
  for (const fs::path& input : request.inputs)
    if (status && outputs::lies_in(input, path_))
      refuse(request,
             fmt::format("holds {}, which is read; choose another folder", input.string()));
  for (const std::string& name : *names) check_entry(request, name);
  fs::create_directories(path_, error);
  if (error) refuse(request, "cannot be created: " + error.message());
  csv_.emplace(outputs::OutputRequest{.option = request.option,
                                      .path = (fs::path(request.path) / kSweepCsv).string(),
                                      .replace = true});
  if (!is_regular(path_ / kSweepFile)) outputs::add_to_record(path_, kSweepFile, {});
}

void SweepFolder::check_entry(const Request& request, const std::string& name) const {
  const auto foreign = [&] {
    refuse(request, fmt::format("exists and holds something other than a sweep: {}; choose a new "
                                "folder",
                                name));
  };
  if (!outputs::status_of(path_ / name)) return;  // of another process, and gone by now
  std::error_code error;
  if (fs::equivalent(path_ / name, request.cache, error)) return;
  // Its OutputFile looks at these.
  if (name == outputs::StagingFolder::place_of(path_ / kSweepCsv).filename()) return;
  if (!is_regular(path_ / name)) foreign();
  if (name == outputs::kRecordName || name == kSweepCsv) return;
  if (name == kSweepFile) {
    if (!is_sweep(path_)) foreign();
    return;
  }
  // Such as a page that was asked for here. In the folder of a run, all is of the run.
  const std::optional<outputs::OutputRecord> record = outputs::OutputRecord::read(path_);
  if (!record || !record->names(kSweepFile) || !record->describes(path_, name)) foreign();
}

void SweepFolder::empty() {
  if (!is_regular(path_ / kSweepFile)) return;
  if (::unlink((path_ / kSweepFile).c_str()) != 0)
    throw InputError(fmt::format("{}: cannot be removed: {}", (path_ / kSweepFile).string(),
                                 outputs::reason(errno)));
}

}  // namespace leviosim::tools
