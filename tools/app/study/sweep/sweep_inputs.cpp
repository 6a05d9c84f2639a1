#include "tools/app/study/sweep/sweep_inputs.h"

#include <fmt/core.h>

#include <functional>
#include <set>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/study/point.h"
#include "tools/app/study/sweep/sweep_store.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

/// What open() returns, with the place in front of its complaints.
template <class Open>
auto opened_at(const platform::Place& place, const Open& open) {
  try {
    return open();
  } catch (const InputError& error) {
    place.fail(error.what());
  }
}

}  // namespace

std::filesystem::path SweepInputs::beside(const std::string& name) const {
  return (folder_ / name).lexically_normal();  // an absolute name stays what it is
}

platform::PlatformFile& SweepInputs::platform(const std::string& name,
                                              const platform::Place& place) {
  const auto known = platforms_.find(name);
  if (known != platforms_.end()) return known->second;
  return opened_at(place, [&]() -> std::reference_wrapper<platform::PlatformFile> {
    platform::PlatformFile file = platform::PlatformFile::named(name, folder_);
    file.resolve({});  // refuses what is wrong with the file itself
    return platforms_.emplace(name, std::move(file)).first->second;
  });
}

SweepInputs::Trace& SweepInputs::trace(const std::string& name, const platform::Place& place) {
  const auto known = traces_.find(name);
  if (known != traces_.end()) return known->second;
  return opened_at(place, [&]() -> std::reference_wrapper<Trace> {
    std::filesystem::path file = beside(name);
    if (base::is_folder(file)) file /= kWorkTraceFile;
    // Called as in the plan: what a point says must not depend on where the plan lies.
    return keep_trace(name, base::read_file(file, base::InputKind::work_trace));
  });
}

SweepInputs::Trace& SweepInputs::keep_trace(const std::string& name, std::string bytes) {
  const std::string digest = base::sha256_of(bytes);
  auto work = std::make_unique<traces::WorkTrace>(name, std::move(bytes), memory_);
  platform::PlatformFile chip(name + ", platform of the recording", work->info().platform_yaml);
  return traces_.emplace(name, Trace{std::move(work), digest, std::move(chip)}).first->second;
}

const SweepInputs::Data& SweepInputs::data(const std::string& name, const std::string& frames,
                                           const platform::Place& place) {
  const auto key = std::make_pair(name, frames);
  const auto known = data_.find(key);
  if (known != data_.end()) return known->second;
  return opened_at(place, [&]() -> std::reference_wrapper<const Data> {
    const std::filesystem::path folder =
        name == "synthetic" ? cached_flight(progress_) : beside(name);
    std::optional<traces::FrameRange> range;
    if (!frames.empty()) range = traces::parse_frame_range(frames);
    const traces::Dataset data = traces::open_recording(folder, {.frames = range});
    return data_.emplace(key, Data{folder.string(), work_of(data, digest_of(data)), data.camera})
        .first->second;
  });
}

namespace {

namespace fs = std::filesystem;

bool is_regular(const fs::path& file) {
  const std::optional<struct stat> status = outputs::status_of(file);
  return status && S_ISREG(status->st_mode);
}

[[noreturn]] void refuse(const SweepFolder::Request& request, const std::string& why) {
  throw InputError(fmt::format("{} {}: {}", request.option, request.path, why));
}

/// What SQLite keeps beside the data base while it is open.
bool is_of_sqlite(const std::string& name) {
  const std::string file(kSweepFile);
  return name == file + "-journal" || name == file + "-wal" || name == file + "-shm";
}

}  // namespace

SweepFolder::SweepFolder(const Request& request) {
  std::error_code error;
  path_ = outputs::resolved(request.path, error);
  if (error) refuse(request, "cannot be used: " + error.message());
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
  const std::optional<outputs::OutputRecord> record = outputs::OutputRecord::read(path_);
  if (name == kSweepFile) {
    if (!is_sweep(path_, record && record->names(kSweepFile))) foreign();
    return;
  }
  if (is_of_sqlite(name) && is_regular(path_ / kSweepFile)) return;
  if (!record || !record->describes(path_, name)) foreign();
}

void SweepFolder::empty() {
  if (is_regular(path_ / kSweepFile)) empty_sweep(path_);
}

}  // namespace leviosim::tools
