// `leviosim flow`: the optical flow of PX4FLOW on a chip.
#include <CLI/CLI.hpp>

#include <memory>

#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/flow/flow.h"
#include "tools/app/flow/flow_report.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/run_tables.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

/// Of a run, as far as they make sense here, and those of the workload.
struct FlowOptions : RunOptions {
  std::string fps;
  std::string grid = "5";
  std::string search = "4";
  bool gyro = false;
};

flow::Options workload_of(const FlowOptions& options) {
  flow::Options workload;
  workload.grid = static_cast<int>(parse_whole("--grid", options.grid, 1, workload.side));
  workload.search =
      static_cast<int>(parse_whole("--search", options.search, 1, flow::Options::kLargestSearch));
  workload.gyro = options.gyro;
  // Of a grid of few blocks the same share: 10 of 25.
  workload.min_matches = std::max(1, workload.blocks() * 10 / 25);
  workload.validate();
  return workload;
}

RunRequest request_of(const FlowOptions& options) {
  RunRequest request;
  request.overrides = options.overrides;
  request.platform = platform::resolve_platform(options.platform, request.overrides);
  request.cores = cores_of(options, request.platform.config.cluster);
  if (!options.frames.empty()) request.frames = traces::parse_frame_range(options.frames);
  return request;
}

FlowRun run_flow(const FlowOptions& options, const RunRequest& request, ProgressLine::Style style) {
  FlowSource source(request, workload_of(options));
  FlowRun flow;
  if (!options.fps.empty()) flow.rate = parse_frame_rate(options.fps);
  flow.run = simulate_with_progress(request, source, style);
  flow.flows = source.flows();
  flow.platform = request.platform.name;
  flow.binning = source.camera().binning();
  return flow;
}

void write_folder(outputs::OutputFolder& out, const FlowRun& flow, const Manifest& manifest,
                  const std::string& platform_yaml) {
  const auto write = [&](const char* name, const std::string& text) {
    if (!text.empty()) out.write(name, text);
  };
  write("manifest.json", json_text(manifest_json(manifest, flow.run), 2) + '\n');
  write("platform.yaml", platform_yaml);
  write("flow.csv", csv_text(flow_rows(flow)));
  write("stages.csv", csv_text(stage_rows(flow.run)));
  write("memory.csv", csv_text(memory_rows(flow.run)));
  write("energy.csv", csv_text(energy_rows(flow.rate ? at_rate(flow.run, *flow.rate) : flow.run)));
  write("published.csv", csv_text(published_rows(flow)));
}

void run(const CLI::App& command, const FlowOptions& options, const Arguments& words) {
  require(command, "--platform", "the name of a chip or a platform file");
  require(command, "--data", "an ASL folder or 'synthetic'");
  require(command, "--out", "a folder for the results");
  workload_of(options);
  if (!options.fps.empty()) parse_frame_rate(options.fps);
  RunRequest request = request_of(options);
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  outputs::OutputFolder out(out_request(options));
  request.data = data_folder(options, style);
  const FlowRun flow = run_flow(options, request, style);
  const Manifest manifest = make_manifest(options, request, words);
  const Printout shown = printout(
      options.json,
      [&] {
        std::vector<std::string> parts = flow_report(flow);
        parts.front().insert(0, heading(options, flow.run));
        return Printout(std::move(parts))
            .ending(flow_conclusion(flow), {"leviosim platforms systems"});
      },
      [&] { return table_document("flow", flow_rows(flow)); });
  publish(out, shown,
          [&] { write_folder(out, flow, manifest, platform::to_yaml(request.platform)); });
}

}  // namespace

Command add_flow_command(CLI::App& app, const Arguments& words) {
  CLI::App* command =
      app.add_subcommand("flow", "Run the optical flow of PX4FLOW, a second workload, on a chip");
  const auto options = std::make_shared<FlowOptions>();
  add_chip_options(*command, *options, "");
  const TextOptions add{*command};
  add("--data", options->data, "DIR|synthetic", "ASL/EuRoC folder, or the synthetic flight");
  add("--frames", options->frames, "A:B", "frames, B exclusive [all]");
  add("--fps", options->fps, "F", "rate of the camera, for energy and power [the recorded one]");
  add("--grid", options->grid, "N", "N x N blocks [5]");
  add("--search", options->search, "PX", "search range to either side [4]");
  command->add_flag("--gyro", options->gyro, "subtract the rotation of the camera");
  command->add_flag("--quiet", options->quiet, "no progress");
  add_out_options(*command, *options);
  add_examples(*command,
               {"leviosim flow --platform gap8 -p cluster.clock=50MHz -p controller.clock=50MHz -p "
                "supply.voltage=1.0V --data flight --fps 500 --out flow"});
  add_json_option(*command, options->json);
  return {command, [=, &words] { run(*command, *options, words); }};
}

}  // namespace leviosim::tools
