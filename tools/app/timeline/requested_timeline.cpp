#include "tools/app/timeline/requested_timeline.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "sim/base/error.h"
#include "sim/outputs/file_system.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/timeline/timeline_picture.h"

namespace leviosim::tools {
namespace {

constexpr int kFramesOfPicture = 2;  // as many as a picture of usual width shows

std::optional<traces::FrameRange> range_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  try {
    return traces::parse_frame_range(text);
  } catch (const InputError& error) {
    throw InputError(fmt::format("--timeline-frames: {}", error.what()));
  }
}

bool is_picture(const std::string& file) {
  return std::filesystem::path(file).extension() == ".svg";
}

/// A folder of results appears as a whole; a file in it would be lost or in its way.
void refuse_within(const outputs::OutputRequest& results, const std::string& file) {
  std::error_code error;
  const std::filesystem::path folder = outputs::resolved(results.path, error);
  const std::filesystem::path path = outputs::resolved(file, error);
  if (*path.lexically_relative(folder).begin() != "..")
    throw InputError(
        fmt::format("--timeline {}: lies in the folder of {}; choose a place beside it", file,
                    results.shown()));
}

/// What opens such files would not open this one.
void refuse_other_formats(const std::string& file) {
  const std::filesystem::path extension = std::filesystem::path(file).extension();
  for (const char* other : {".json", ".html", ".htm", ".csv", ".png", ".pdf"})
    if (extension == other)
      throw InputError(fmt::format(
          "--timeline {}: expected a name that ends in .svg, a picture, or in .pftrace, for "
          "ui.perfetto.dev",
          file));
}

outputs::OutputRequest file_request(const std::string& file,
                                    const outputs::OutputRequest& results) {
  refuse_other_formats(file);
  refuse_within(results, file);
  return {
      .option = "--timeline", .path = file, .replace = results.replace, .inputs = results.inputs};
}

}  // namespace

void add_timeline_options(CLI::App& command, TimelineOptions& options) {
  const TextOptions add{command};
  add("--timeline", options.file, "FILE",
      "timeline to write: .pftrace for ui.perfetto.dev, which opens the file locally; .svg as a "
      "picture");
  add("--timeline-frames", options.frames, "A:B",
      "frames of the timeline as frames.csv numbers them, B exclusive [all; of a "
      "picture two in the middle]");
}

RequestedTimeline::RequestedTimeline(const TimelineOptions& options,
                                     const outputs::OutputRequest& results,
                                     const RunRequest& request)
    : chosen_(is_picture(options.file) && options.frames.empty()),
      file_(claimed_file(file_request(options.file, results))) {
  const sim::ChipConfig& chip = request.platform.config;
  const std::optional<traces::FrameRange> range = range_of(options.frames);
  if (is_picture(options.file)) {
    picture_.emplace(chip, request.cores, range, chosen_ ? kFramesOfPicture : 0);
    return;
  }
  spool_ = std::make_unique<outputs::Spool>(file_->spool());
  timeline_.emplace(
      chip,
      PerfettoTimeline::Options{
          .cores = request.cores, .is_closed = request.camera.has_value(), .range = range},
      [spool = spool_.get()](std::string_view bytes) { spool->add(bytes); });
}

RunObserver& RequestedTimeline::observer() {
  if (picture_) return *picture_;
  return *timeline_;
}

void RequestedTimeline::publish(const RunResult& run, bool prints_name) {
  std::string label = "timeline";
  const Printout nothing("", !prints_name);
  if (timeline_) {
    timeline_->finish(run);
    tools::publish({{file_, spool_->content(), label}}, nothing);
    return;
  }
  if (chosen_ && picture_->events().range)
    label += fmt::format(" of frames {}:{} (--timeline-frames A:B for others)",
                         picture_->events().range->begin, picture_->events().range->end);
  const std::string svg = timeline_picture(picture_->events(), run);
  tools::publish({{file_, svg, label}}, nothing);
}

std::optional<RequestedTimeline> requested_timeline(const TimelineOptions& options,
                                                    const outputs::OutputRequest& results,
                                                    const RunRequest& request) {
  if (options.file.empty()) {
    if (!options.frames.empty())
      throw InputError("--timeline-frames is for a timeline; expected --timeline as well");
    return std::nullopt;
  }
  if (request.native)
    throw InputError("run: --native computes without a chip; leave out --timeline");
  return std::optional<RequestedTimeline>(std::in_place, options, results, request);
}

}  // namespace leviosim::tools
