// `leviosim image-statistics`: what the pictures of recordings are like, side by side.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/printout.h"
#include "tools/app/cli/progress_line.h"
#include "tools/app/images/image_statistics.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/run_options.h"
#include "tools/app/table/table_files.h"
#include "tools/commands/commands.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

struct ImageStatisticsOptions {
  std::vector<std::string> folders;
  std::string size = "160x120";
  std::string frames;
  bool json = false;
  bool quiet = false;
};

/// As it stands in the table: the last part of its path.
std::string title(const std::string& folder) {
  const std::string last = std::filesystem::path(folder).filename().string();
  return printable(last.empty() ? folder : last);
}

ImageStatistics measure(const std::string& folder, const ImageStatisticsOptions& options) {
  traces::OpenOptions open;
  if (!options.frames.empty()) open.frames = traces::parse_frame_range(options.frames);
  const traces::Dataset data = traces::open_recording(folder, open);
  const auto total = static_cast<std::int64_t>(data.frames.size());
  ProgressLine line(ProgressLine::style_of_stderr(options.quiet));
  return image_statistics(title(folder), data, parse_size(options.size), [&](std::size_t done) {
    line.show(static_cast<std::int64_t>(done), total,
              [&] { return fmt::format("{}: {} of {} frames", printable(folder), done, total); });
  });
}

std::string conclusion(const std::vector<ImageStatistics>& all) {
  if (all.size() == 1) return fmt::format("in short: {} frames", all.front().frames);
  const std::vector<std::string> names = different_quantities(all.front(), all.back());
  if (names.empty()) return "in short: all medians agree within a quarter";
  return fmt::format("in short: {} of {} medians differ by more than a quarter: {}", names.size(),
                     all.front().rows.size(), fmt::join(names, ", "));
}

void run(const CLI::App& command, const ImageStatisticsOptions& options) {
  require(command, "DIR", "a recording, or several");
  std::vector<ImageStatistics> all;
  for (const std::string& folder : options.folders) all.push_back(measure(folder, options));
  print(printout(
      options.json,
      [&] {
        return Printout(image_statistics_table(all))
            .ending(conclusion(all), {fmt::format("leviosim image-statistics {} --json",
                                                  shell_word(options.folders.front()))});
      },
      [&] { return table_document("image statistics", image_statistics_rows(all)); }));
}

}  // namespace

Command add_image_statistics_command(CLI::App& app, const Words&) {
  CLI::App* command = app.add_subcommand(
      "image-statistics", "See what the pictures of recordings are like, side by side");
  const auto options = std::make_shared<ImageStatisticsOptions>();
  command->add_option("DIR", options->folders,
                      "folders of recordings; the first one is compared with");
  const TextOptions add{*command};
  add("--size", options->size, "WxH", "of the images [160x120]");
  add("--frames", options->frames, "A:B", "frames, B exclusive [all]");
  command->add_flag("--quiet", options->quiet, "no progress");
  add_examples(*command, {"leviosim image-statistics flight rendered --frames 0:20"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
