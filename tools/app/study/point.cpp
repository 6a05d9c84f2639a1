#include "tools/app/study/point.h"

#include <fmt/core.h>

#include <filesystem>

#include "platform_models/loader/platform_file.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/version.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/workload.h"
#include "traces/recordings/recording.h"
#include "traces/trajectories/evaluation.h"

namespace leviosim::tools {
namespace {

std::string workload_lines(const RunRequest& request) {
  std::string text = fmt::format("size {}x{}\nseed {}\nprofile {}\n", request.image_size.width,
                                 request.image_size.height, request.seed, request.profile);
  const vio::Profile profile = profile_of(request);
  for (const vio::Parameter& p : vio::parameters())
    text += fmt::format("{} {}\n", p.name,
                        value_text(p, p.is_of_another() ? value_of(request, p) : p.get(profile)));
  return text;
}

std::string chip_lines(const RunRequest& request, const platform::Schema& schema) {
  std::string text =
      fmt::format("cores {}\n", request.cores) + canonical_text(schema, request.platform);
  if (!request.camera) return text;
  const auto& [fps, deadline] = *request.camera;
  return text + fmt::format("camera {} {}\n", fps ? fmt::format("{}", *fps) : "as recorded",
                            info_of(deadline).name);
}

}  // namespace

std::string identity_of(const Point& point, const platform::Schema& schema) {
  std::string text = point.work + '\n';
  if (point.trace == nullptr) text += workload_lines(point.request);
  return text + (point.request.native ? "native\n" : chip_lines(point.request, schema));
}

std::string point_key(std::string_view kept, const std::string& identity) {
  return base::sha256_of(fmt::format("simulator {}\n{}\n{}", results_version(), kept, identity));
}

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

std::string folder_name(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

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
    throw InputError(fmt::format(
        "--data {}: has no ground truth", named.folder));
  std::vector<std::int64_t> stamps_ns;
  for (const traces::FrameRef& frame : data.frames) stamps_ns.push_back(frame.t_ns);
  traces::require_truth_at(data, stamps_ns);
  for (const traces::ImageSize& size : sizes) {
    try {
      traces::make_decimation(data.camera, size);
    } catch (const InputError& error) {
      throw InputError(fmt::format("--data {}: {}", named.folder, error.what()));
    }
  }
  const std::string digest = digest_of(data);
  return {named.name,           named.folder,           digest,
          data.frames.size(),   path_over_frames(data), traces::to_trajectory(data.ground_truth),
          work_of(data, digest)};
}

}  // namespace leviosim::tools
