#include "tools/app/timeline/requested_timeline.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "sim/base/error.h"
#include "sim/outputs/file_system.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/timeline/perfetto_timeline.h"
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
    : name_(options.file),
      is_picture_(std::filesystem::path(name_).extension() == ".svg"),
      chosen_(is_picture_ && options.frames.empty()),
      collector_(request.platform.config, request.cores, range_of(options.frames),
                 chosen_ ? kFramesOfPicture : 0),
      file_(claimed_file(file_request(options.file, results))) {}

void RequestedTimeline::publish(const RunResult& run, bool prints_name) {
  std::string label = "timeline";
  if (chosen_ && collector_.events().range)
    label += fmt::format(" of frames {}:{} (--timeline-frames A:B for others)",
                         collector_.events().range->begin, collector_.events().range->end);
  tools::publish({{file_,
                   is_picture_ ? timeline_picture(collector_.events(), run)
                               : perfetto_timeline(collector_.events(), run),
                   label}},
                 Printout("", !prints_name));
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
