#include "tools/app/run/manifest.h"

#include <fmt/format.h>

#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/version.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

Json inputs_json(const std::vector<InputDigest>& inputs) {
  Json list = Json::array();
  for (const InputDigest& input : inputs) {
    Json& entry = list.emplace_back(Json::object());
    entry["name"] = input.name;
    entry["bytes"] = input.bytes;
    entry["sha256"] = input.sha256;
  }
  return list;
}

Json platform_json(const Manifest& manifest, const RunResult& run) {
  if (!run.timed) return nullptr;
  Json platform;
  platform["name"] = manifest.platform;
  platform["overrides"] = manifest.overrides;
  platform["cores"] = run.cores;
  return platform;
}

InputDigest digest_of(std::string name, const std::vector<fs::path>& files, base::InputKind kind) {
  InputDigest digest;
  digest.name = std::move(name);
  base::Sha256 sha;
  for (const fs::path& file : files) {
    throw_if_interrupted();
    const std::string bytes = base::read_file(file, kind);
    sha.add(bytes);
    digest.bytes += static_cast<std::int64_t>(bytes.size());
  }
  digest.sha256 = sha.hex();
  return digest;
}

}  // namespace

Json manifest_json(const Manifest& manifest, const RunResult& run) {
  Json document;
  document["format"] = "leviosim manifest";
  document["version"] = 3;
  document["program"]["version"] = version();
  document["program"]["revision"] = revision();
  document["command_line"] = manifest.command_line;
  document["profile"] = run.profile;
  if (!manifest.workload.empty()) document["workload"] = manifest.workload;
  document["seed"] = manifest.seed;
  document["platform"] = platform_json(manifest, run);
  if (run.camera)
    document["camera"] = {{"frames_per_second", run.camera->fps},
                          {"deadline", info_of(run.camera->deadline).name}};
  document["image"]["width"] = run.image_width;
  document["image"]["height"] = run.image_height;
  document["data"]["folder"] = manifest.data;
  document["data"]["first_frame"] = manifest.first_frame;
  document["data"]["frames"] = run.camera ? run.camera->deliveries.size() : run.frames.size();
  document["inputs"] = inputs_json(manifest.inputs);
  if (!manifest.recording.is_null()) document["recording"] = manifest.recording;
  document["host"]["seconds"] = run.host_seconds;
  return document;
}

InputDigest digest_of_file(const fs::path& file) {
  return digest_of(file.filename().string(), {file}, base::InputKind::work_trace);
}

std::vector<InputDigest> digest_inputs(const traces::Dataset& data) {
  std::vector<InputDigest> digests;
  for (const traces::InputFiles& input : data.files)
    digests.push_back(digest_of(input.name, input.files, base::InputKind::table));
  std::vector<fs::path> images;
  for (const traces::FrameRef& frame : data.frames) images.push_back(frame.path);
  digests.push_back(
      digest_of(fmt::format("{}, {} images concatenated", data.pictures, images.size()), images,
                base::InputKind::image));
  return digests;
}

}  // namespace leviosim::tools
