#include "tools/app/run/manifest.h"

#include "tools/app/cli/version.h"

namespace leviosim::tools {
namespace {

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

}  // namespace

Json manifest_json(const Manifest& manifest, const RunResult& run) {
  Json document;
  document["format"] = "leviosim manifest";
  document["version"] = kManifestVersion;
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

}  // namespace leviosim::tools
