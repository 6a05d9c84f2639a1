#include "tools/app/study/batch_plan.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <limits>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "sim/base/text.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/run_options.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/study/accuracy_study.h"

namespace leviosim::tools {
namespace {

/// The same input twice would only look like more runs.
template <class T>
std::vector<T> without_repetitions(const std::string& option, std::vector<T> values,
                                   const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (std::find(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i), words[i]) !=
        words.begin() + static_cast<std::ptrdiff_t>(i))
      throw InputError(fmt::format("{} '{}': is given twice", option, words[i]));
  return values;
}

std::vector<traces::ImageSize> parse_sizes(const std::vector<std::string>& words) {
  std::vector<traces::ImageSize> sizes;
  for (const std::string& word : words) sizes.push_back(parse_size(word));
  return without_repetitions("--size", sizes, words);
}

/// Digests of what is read are kept with the folder's name for the messages.
std::vector<Sequence> open_all(const BatchOptions& options, const BatchPlan& plan,
                               ProgressLine::Style progress) {
  std::vector<Sequence> sequences;
  for (const std::string& word : options.folders) {
    throw_if_interrupted();
    NamedFolder named = parse_named_folder(word);
    if (named.folder == "synthetic") named.folder = cached_flight(progress).string();
    sequences.push_back(open_sequence(named, plan.frames, plan.sizes));
    for (std::size_t i = 0; i + 1 < sequences.size(); ++i)
      if (sequences[i].inputs == sequences.back().inputs)
        throw InputError(
            fmt::format("--data {}: holds the same flight as {}", word, sequences[i].folder));
  }
  return sequences;
}

}  // namespace

std::vector<std::uint32_t> batch_seeds(const std::vector<std::string>& words) {
  std::vector<std::uint32_t> seeds;
  for (const std::string& word : words)
    seeds.push_back(static_cast<std::uint32_t>(
        parse_whole("--seed", word, 0, std::numeric_limits<std::uint32_t>::max())));
  return without_repetitions("--seed", seeds, words);
}

std::vector<std::string> known_profiles(const std::vector<std::string>& words) {
  for (const std::string& word : words) vio::expect_profile(word);
  return without_repetitions("--profile", words, words);
}

std::vector<vio::Assignment> native_workload(const std::vector<std::string>& overrides) {
  const SplitOverrides split = split_overrides(overrides);
  if (!split.chip.empty())
    throw InputError(
        fmt::format("-p {}: runs here are native, without a chip; expected a parameter of the "
                    "workload, such as workload.window=6 (leviosim workload lists them)",
                    split.chip.front()));
  return parse_workload_overrides(split.workload);
}

void add_batch_options(CLI::App& command, BatchOptions& options) {
  const TextOptions add{command};
  add("--data", options.folders, "[NAME=]DIR",
      "ASL/EuRoC folder of a sequence; repeatable. Folders of one name are pooled");
  add("--profile", options.profiles, "NAME,...",
      "of the workload [levio,levio-no-imu,levio-no-imu-no-epnp]", true);
  add("--size", options.sizes, "WxH,...", "image sizes [160x120]", true);
  add("--seed", options.seeds, "N,...", "of the workload's random draws [1,2,3]", true);
  add("-p,--set", options.overrides, "PATH=VALUE",
      "parameter of the workload in every run (leviosim workload); repeatable");
  add("--frames", options.frames, "A:B", "frames, B exclusive [all]");
  add("--align", options.align, "KIND", "se3, sim3, posyaw or none [se3]");
  add("--relative", options.relative, "M", "length of sub-trajectories in metres [40]");
  command.add_flag("--quiet", options.quiet, "no progress");
}

std::vector<std::filesystem::path> batch_inputs(const char* command, const BatchOptions& options) {
  expect_given(command, "--data", options.folders.empty(), "an ASL folder; repeatable");
  expect_given(command, "--out", options.out.empty(), "a folder for the results");
  std::vector<std::filesystem::path> inputs;
  for (const std::string& word : options.folders)
    for (const std::filesystem::path& input : data_inputs(parse_named_folder(word).folder))
      inputs.push_back(input);
  return inputs;
}

BatchPlan make_plan(const BatchOptions& options, ProgressLine::Style progress) {
  BatchPlan plan;
  plan.profiles = known_profiles(options.profiles);
  plan.sizes = parse_sizes(options.sizes);
  plan.seeds = batch_seeds(options.seeds);
  plan.workload = native_workload(options.overrides);
  if (!options.frames.empty()) plan.frames = traces::parse_frame_range(options.frames);
  plan.measure = {traces::parse_alignment(options.align),
                  parse_positive("--relative", options.relative)};
  plan.sequences = open_all(options, plan, progress);
  return plan;
}

Point make_run(const BatchPlan& plan, const Sequence& sequence, const std::string& profile,
               const traces::ImageSize& size, std::uint32_t seed) {
  Point run{.request = {}, .work = sequence.work, .sequence = &sequence};
  run.request.data = sequence.folder;
  run.request.profile = profile;
  run.request.frames = plan.frames;
  run.request.image_size = size;
  run.request.native = true;
  run.request.seed = seed;
  run.request.workload = plan.workload;
  run.request.pictures = plan.pictures;
  return run;
}

std::vector<std::string> sequence_names(const BatchPlan& plan) {
  std::vector<std::string> names;
  for (const Sequence& s : plan.sequences)
    if (std::find(names.begin(), names.end(), s.name) == names.end()) names.push_back(s.name);
  return names;
}

Json batch_manifest(const BatchPlan& plan) {
  Json document;
  document["profiles"] = plan.profiles;
  for (const traces::ImageSize& size : plan.sizes) document["sizes"].push_back(size_text(size));
  document["seeds"] = plan.seeds;
  document["workload"] = Json::array();
  for (const vio::Assignment& a : plan.workload) document["workload"].push_back(a.text());
  document["measure"] = measure_text(plan.measure);
  for (const Sequence& s : plan.sequences)
    document["sequences"].push_back({{"name", s.name},
                                     {"folder", s.folder},
                                     {"frames", s.frames},
                                     {"path_m", rounded(s.path_m)},
                                     {"inputs_sha256", s.inputs}});
  return document;
}

std::vector<std::string> after_batch(const BatchPlan& plan) {
  return {fmt::format("leviosim run --profile {} --data {} --record --out mine",
                      plan.profiles.front(), shell_word(plan.sequences.front().folder))};
}

std::string size_text(const traces::ImageSize& size) {
  return fmt::format("{}x{}", size.width, size.height);
}

}  // namespace leviosim::tools
