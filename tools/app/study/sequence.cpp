#include "tools/app/study/sequence.h"

#include <fmt/core.h>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "tools/app/run/manifest.h"
#include "traces/datasets/image_preparation.h"
#include "traces/recordings/recording.h"
#include "traces/trajectories/evaluation.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

double path_over_frames(const traces::Dataset& data) {
  double length = 0;
  for (std::size_t i = 1; i < data.ground_truth.size(); ++i) {
    const traces::GroundTruthPose& a = data.ground_truth[i - 1];
    const traces::GroundTruthPose& b = data.ground_truth[i];
    if (a.t_ns < data.frames.front().t_ns || b.t_ns > data.frames.back().t_ns) continue;
    length += (b.T_world_body.translation() - a.T_world_body.translation()).norm();
  }
  return length;
}

}  // namespace

std::string folder_name(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

NamedFolder parse_named_folder(const std::string& text) {
  NamedFolder named{"", text};
  const std::size_t equals = text.find('=');
  if (equals != std::string::npos && !base::exists(text) && equals < text.find('/'))
    named = {text.substr(0, equals), text.substr(equals + 1)};
  else
    named.name = folder_name(text);
  if (named.name.empty() || named.name.find_first_of(",\"|\n\r") != std::string::npos)
    throw InputError(fmt::format(
        "--data {}: the sequence's name '{}' is empty or has a comma, quote or bar in it; expected "
        "NAME=DIR with another",
        text, named.name));
  return named;
}

/// Each file counts with its name.
std::string digest_of(const traces::Dataset& data) {
  base::Sha256 all;
  for (const InputDigest& file : digest_inputs(data))
    all.add(fmt::format("{} {}\n", file.name, file.sha256));
  return all.hex();
}

/// Frames may be equal, but not their times.
std::string work_of(const traces::Dataset& data, const std::string& digest) {
  return fmt::format("data {} {}:{}", digest, data.frames.front().t_ns, data.frames.back().t_ns);
}

Sequence open_sequence(const NamedFolder& named, const std::optional<traces::FrameRange>& frames,
                       const std::vector<traces::ImageSize>& sizes) {
  const traces::Dataset data = traces::open_recording(named.folder, {.frames = frames});
  if (data.ground_truth.empty())
    throw InputError(fmt::format("--data {}: has no ground truth", named.folder));
  std::vector<std::int64_t> stamps_ns;
  for (const traces::FrameRef& frame : data.frames) stamps_ns.push_back(frame.t_ns);
  traces::Trajectory truth = traces::to_trajectory(data.ground_truth);
  traces::require_truth_at(truth, data.truth_csv, stamps_ns);
  for (const traces::ImageSize& size : sizes) {
    try {
      traces::make_decimation(data.camera, size);
    } catch (const InputError& error) {
      throw InputError(fmt::format("--data {}: {}", named.folder, error.what()));
    }
  }
  const std::string digest = digest_of(data);
  return {named.name,           named.folder,           digest,
          data.frames.size(),   path_over_frames(data), std::move(truth),
          work_of(data, digest)};
}

}  // namespace leviosim::tools
