#include "tools/app/study/sweep/sweep_inputs.h"

#include <fmt/core.h>

#include <functional>

#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/study/sequence.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_key.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

using Kind = SweepKey::Kind;

using platform::Place;

}  // namespace

std::filesystem::path SweepInputs::beside(const std::string& name) const {
  return (folder_ / name).lexically_normal();  // an absolute name stays what it is
}

platform::PlatformFile& SweepInputs::platform(const std::string& name,
                                              const platform::Place& place) {
  const auto known = platforms_.find(name);
  if (known != platforms_.end()) return known->second;
  return read_at(place, [&]() -> std::reference_wrapper<platform::PlatformFile> {
    platform::PlatformFile file = platform::PlatformFile::named(name, folder_);
    file.resolve({});  // refuses what is wrong with the file itself
    return platforms_.emplace(name, std::move(file)).first->second;
  });
}

SweepInputs::Trace& SweepInputs::trace(const std::string& name, const platform::Place& place) {
  const auto known = traces_.find(name);
  if (known != traces_.end()) return known->second;
  return read_at(place, [&]() -> std::reference_wrapper<Trace> {
    std::filesystem::path file = beside(name);
    if (base::is_folder(file)) file /= kWorkTraceFile;
    // Called as in the plan: what a point says must not depend on where the plan lies.
    return keep_trace(name, traces::work_trace_bytes(file, memory_));
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
  return read_at(place, [&]() -> std::reference_wrapper<const Data> {
    const std::filesystem::path folder =
        name == "synthetic" ? cached_flight(progress_) : beside(name);
    std::optional<traces::FrameRange> range;
    if (!frames.empty()) range = traces::parse_frame_range(frames);
    const traces::Dataset data = traces::open_recording(folder, {.frames = range});
    return data_.emplace(key, Data{folder.string(), work_of(data, digest_of(data)), data.camera})
        .first->second;
  });
}

}  // namespace leviosim::tools
