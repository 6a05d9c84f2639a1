#include "tools/app/run/run_session.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "platform_models/loader/platform_file.h"
#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "sim/energy/model.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/version.h"
#include "tools/app/record/statistics.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/record_source.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/replay_report.h"
#include "tools/app/run/simulate.h"
#include "tools/app/run/workload_options.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace fs = std::filesystem;

outputs::OutputRequest out_request(const RunOptions& options, const char* option) {
  outputs::OutputRequest request{.option = option, .path = options.out, .replace = options.force};
  request.inputs = data_inputs(options.data);
  request.inputs.emplace_back(platform::parse_platform_name(options.platform).name);
  return request;
}

std::vector<fs::path> data_inputs(const std::string& data) {
  const fs::path folder = data == "synthetic" ? flight_folder() : fs::path(data);
  return {folder, folder / "mav0"};
}

std::uint64_t expected_bytes(const RunRequest& request, bool record) {
  constexpr std::uint64_t kLineOfList = 44;  // two stamps
  constexpr std::uint64_t kRowOfFrame = 512;
  constexpr std::uint64_t kWorkOfFrame = 16 << 10;  // of large images with many features
  std::error_code error;
  const fs::path folder = fs::path(request.data);
  const std::uintmax_t list = fs::file_size(
      (fs::exists(folder / "mav0", error) ? folder / "mav0" : folder) / "cam0/data.csv", error);
  std::uint64_t frames = error ? 0 : list / kLineOfList;
  if (request.frames) frames = std::min<std::uint64_t>(frames, request.frames->end);
  return frames * (kRowOfFrame + (record ? kWorkOfFrame : 0));
}

std::string data_folder(const RunOptions& options, ProgressLine::Style progress) {
  return options.data == "synthetic" ? cached_flight(progress).string() : options.data;
}

ProgressCallback shown_on(ProgressLine& line) {
  return [&line](const Progress& p) {
    throw_if_interrupted();
    line.show(p.done, p.total,
              [&] { return frame_progress(p.done, p.total, p.simulated_ns, line.host_seconds()); });
  };
}

RunResult simulate_with_progress(const RunRequest& request, ProgressLine::Style style) {
  ProgressLine line(style);
  return simulate(request, shown_on(line));
}

RunResult simulate_with_progress(const RunRequest& request, RunSource& source,
                                 ProgressLine::Style style) {
  ProgressLine line(style);
  RunResult result = simulate_source(request, source, shown_on(line));
  result.host_seconds = line.host_seconds();
  return result;
}

Manifest manifest_of_data(const RunRequest& request) {
  Manifest manifest;
  manifest.seed = request.seed;
  for (const vio::Assignment& a : request.workload) manifest.workload.push_back(a.text());
  manifest.data = request.data;
  if (request.frames) manifest.first_frame = request.frames->begin;
  manifest.inputs = digest_inputs(traces::open_recording(request.data, {.frames = request.frames}));
  return manifest;
}

Manifest make_manifest(const RunOptions& options, const RunRequest& request,
                       const Arguments& words) {
  Manifest manifest = manifest_of_data(request);
  manifest.command_line = words;
  manifest.data = options.data;
  manifest.platform = options.platform;
  manifest.overrides = request.overrides;
  return manifest;
}

std::string work_trace_of(WorkRecording recording, const RunOptions& options,
                          const RunRequest& request, const Manifest& manifest) {
  traces::WorkTraceInfo& info = recording.info;
  info.program = fmt::format("leviosim {} {}", version(), revision());
  info.seed = request.seed;
  info.data = options.data;
  info.first_frame = static_cast<std::int64_t>(manifest.first_frame);
  info.platform = options.platform;
  if (!manifest.overrides.empty())
    info.platform += fmt::format(" with {}", fmt::join(manifest.overrides, " "));
  info.platform_yaml = platform::to_yaml(request.platform);
  for (const InputDigest& input : manifest.inputs)
    info.inputs.emplace_back(input.name, input.sha256);
  return recording.writer.finish(std::move(info));
}

RunRequest replay_request(const traces::WorkTrace& trace, const RunOptions& options) {
  for (const std::string& text : split_overrides(options.overrides).workload)
    throw InputError(fmt::format(
        "replay: the recorded work is that of a workload as it was; leave out --set {}", text));
  RunRequest request;
  request.platform = options.platform.empty()
                         ? recorded_platform(trace, options.overrides)
                         : platform::resolve_platform(options.platform, options.overrides);
  request.cores = cores_of(options, request.platform.config.cluster);
  return request;
}

Manifest replay_manifest(const traces::WorkTrace& trace, const InputDigest& digest,
                         const RunOptions& options, const Arguments& words) {
  Manifest manifest;
  manifest.command_line = words;
  manifest.seed = trace.info().seed;
  manifest.platform = options.platform;
  manifest.overrides = options.overrides;
  manifest.data = trace.info().data;
  manifest.first_frame = static_cast<std::size_t>(trace.info().first_frame);
  manifest.inputs = {digest};
  manifest.recording = recording_json(trace, digest.sha256);
  return manifest;
}

std::string heading(const RunOptions& options, const RunResult& run) {
  const std::size_t frames = run.camera ? run.camera->deliveries.size() : run.frames.size();
  std::string text = fmt::format("leviosim {}: {} on {}, {} of {}, {}x{}", version(), run.profile,
                                 run.timed ? printable(options.platform) : "the host",
                                 frames == 1 ? "1 frame" : fmt::format("{} frames", frames),
                                 printable(options.data), run.image_width, run.image_height);
  const auto [chip, workload] = split_overrides(options.overrides);
  for (const std::vector<std::string>* sets : {&chip, &workload})
    for (const std::string& set : *sets) text += ", " + printable(set);
  if (run.timed)
    text += fmt::format(", {} core{} at {:g} MHz, controller at {:g} MHz", run.cores,
                        run.cores == 1 ? "" : "s", megahertz(run.cluster_clock),
                        megahertz(run.controller_clock));
  if (run.timed && sim::knows_energy(run.chip))
    text += fmt::format(", {:g} V", run.chip.supply.voltage.count());
  if (run.camera)
    text += fmt::format(", camera at {:g} frames/s ({})", run.camera->fps,
                        info_of(run.camera->deadline).name);
  return text + "\n\n";
}

}  // namespace leviosim::tools
