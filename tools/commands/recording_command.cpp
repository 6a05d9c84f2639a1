// `leviosim recording`: whether a recording is what an odometry can use: rates, gaps, pixels that
// show nothing, and what the accelerometer reads at rest.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/printable.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/progress_line.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"
#include "tools/commands/commands.h"
#include "traces/datasets/faulty_pixels.h"
#include "traces/datasets/image_source.h"
#include "traces/datasets/rest_gravity.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

struct RecordingOptions {
  std::string folder;
  std::string frames;
  std::string mask;  ///< file to write
  bool force = false;
  bool quiet = false;
  bool json = false;
};

/// What was found, and what to do about it; empty if it is well.
struct Finding {
  std::string what;
  std::string found;
  std::string advice{};
};

constexpr double kMostGravityOff = 0.01;  ///< a share
constexpr double kGravity = 9.81;         ///< [m/s²]

Finding periods(const std::string& what, const std::vector<std::int64_t>& stamps_ns) {
  if (stamps_ns.size() < 2) return {what, fmt::format("{}", stamps_ns.size())};
  std::vector<double> ms;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i)
    ms.push_back(static_cast<double>(stamps_ns[i] - stamps_ns[i - 1]) * 1e-6);
  std::sort(ms.begin(), ms.end());
  return {what, fmt::format("{}, one every {:.2f} ms ({:.2f} … {:.2f} ms)", stamps_ns.size(),
                            ms[ms.size() / 2], ms.front(), ms.back())};
}

Finding gravity(const traces::Dataset& data) {
  const std::optional<double> rest = traces::gravity_at_rest(data);
  if (!rest) return {"rest", "never for a second"};
  Finding finding{"rest", fmt::format("the accelerometer reads {:.3f} m/s²", *rest)};
  if (std::abs(*rest / kGravity - 1) > kMostGravityOff)
    finding.advice = fmt::format("imu0/sensor.yaml: accelerometer_scale: {:.4f}",
                                 data.imu_model.accel_scale * kGravity / *rest);
  return finding;
}

/// In pictures from all over the recording: the longer it moves, the surer is what does not change.
traces::PixelMask faulty_pixels(const traces::Dataset& data) {
  constexpr std::size_t kMostPictures = 40;
  const traces::ImageSize size{data.camera.width, data.camera.height};
  const traces::ImageSource images(data, size);
  traces::FaultyPixelSearch search(size);
  const std::size_t step = std::max<std::size_t>(1, images.size() / kMostPictures);
  for (std::size_t i = 0; i < images.size(); i += step) search.add(images.read_full(i));
  return search.found();
}

Finding pixels(const traces::PixelMask& faulty) {
  const auto number = std::count_if(faulty.begin(), faulty.end(), [](int p) { return p != 0; });
  Finding finding{"faulty pixels", number == 0 ? "none" : fmt::format("{} never change", number)};
  if (number > 0)
    finding.advice = "cam0/sensor.yaml: faulty_pixels: mask.png, which --mask cam0/mask.png writes";
  return finding;
}

std::vector<Finding> findings_of(const traces::Dataset& data, const traces::PixelMask& faulty) {
  std::vector<Finding> findings{periods("images", traces::stamps_of(data.frames)), pixels(faulty)};
  if (data.imu.empty()) {
    findings.push_back({"IMU", "none: a profile without IMU, such as levio-no-imu, can use it"});
    return findings;
  }
  std::vector<std::int64_t> samples_ns;
  for (const traces::ImuSample& sample : data.imu) samples_ns.push_back(sample.t_ns);
  findings.push_back(periods("IMU samples", samples_ns));
  for (const std::string& note : data.notes) findings.push_back({"gaps", note});
  findings.push_back(gravity(data));
  findings.push_back({"truth", data.ground_truth.empty()
                                   ? "none: errors and the scale cannot be checked"
                                   : fmt::format("{} poses", data.ground_truth.size())});
  return findings;
}

const Columns<Finding>& finding_columns() {
  static const Columns<Finding> columns{
      {{.title = "what", .align = kLeft, .key = "what"}, [](const Finding& f) { return f.what; }},
      {{.title = "found", .align = kLeft, .key = "found"},
       [](const Finding& f) { return f.found; }},
      {{.title = "to set", .align = kLeft, .key = "advice"},
       [](const Finding& f) { return f.advice; }}};
  return columns;
}

void run(const CLI::App& command, const RecordingOptions& options) {
  require(command, "DIR", "the folder of a recording");
  std::optional<outputs::OutputFile> mask = claimed_file(
      {.option = "--mask", .path = options.mask, .replace = options.force, .inputs = {}});
  traces::OpenOptions open;
  if (!options.frames.empty()) open.frames = traces::parse_frame_range(options.frames);
  const ProgressLine::Style style = ProgressLine::style_of_stderr(options.quiet);
  const std::string folder =
      options.folder == "synthetic" ? cached_flight(style).string() : options.folder;
  const traces::Dataset data = traces::open_recording(folder, open);
  const traces::PixelMask faulty = faulty_pixels(data);
  const std::vector<Finding> findings = findings_of(data, faulty);
  const auto advice = std::find_if(findings.begin(), findings.end(),
                                   [](const Finding& f) { return !f.advice.empty(); });
  const bool is_well = advice == findings.end();
  const Table table = table_of(finding_columns(), findings);
  const Printout shown = printout(
      options.json,
      [&] {
        return Printout(terminal_text(table))
            .ending(is_well ? "verdict: nothing speaks against it"
                            : fmt::format("verdict: {}: {}", advice->found, advice->advice),
                    {fmt::format("leviosim run --data {} --out mine", shell_word(options.folder))});
      },
      [&] { return table_document("recording", table); });
  if (faulty.empty())
    print(shown);
  else
    publish({{mask, traces::encode_png({data.camera.width, data.camera.height}, faulty), "mask"}},
            shown);
  if (!is_well) throw LimitNotMet();
}

}  // namespace

Command add_recording_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("recording", "Check a recording: rates, gaps, pixels, gravity at rest");
  const auto options = std::make_shared<RecordingOptions>();
  command->add_option("DIR", options->folder, "folder of a recording (EuRoC, TUM, KITTI)");
  TextOptions{*command}("--frames", options->frames, "A:B", "frames, B exclusive [all]");
  TextOptions{*command}("--mask", options->mask, "FILE.png",
                        "file for a mask of the faulty pixels, if there are any");
  command->add_flag("--force", options->force, "replace the mask");
  command->add_flag("--quiet", options->quiet, "no progress");
  add_examples(*command, {"leviosim recording flight"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
