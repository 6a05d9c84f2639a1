// What studies of accuracy have in common, which make native runs of many profiles, image sizes and
// seeds over sequences: options, points, the manifest.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/outputs/output_folder.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/point.h"
#include "tools/app/study/runner.h"
#include "tools/app/study/sequence.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// As typed.
struct BatchWords {
  std::vector<std::string> data;
  std::vector<std::string> profiles{"levio", "levio-no-imu", "levio-no-imu-no-epnp"};
  std::vector<std::string> sizes{"160x120"};
  std::vector<std::string> seeds{"1", "2", "3"};
  std::vector<std::string> overrides;
  std::string frames;
  std::string align = "se3";
  std::string relative = "40";
  RunnerWords runner;
  std::string out;
  bool force = false;
  bool quiet = false;
  bool json = false;
};

/// Checked, and the sequences opened.
struct BatchPlan {
  std::vector<Sequence> sequences;
  std::vector<std::string> profiles;
  std::vector<traces::ImageSize> sizes;
  std::vector<std::uint32_t> seeds;
  std::vector<vio::Assignment> workload;  ///< of every run
  std::optional<traces::FrameRange> frames;
  Measure measure;
  std::shared_ptr<outputs::OutputFolder> out;  ///< for the results
  RunnerOptions runner;
};

/// What --seed, --profile and -p of native runs were given. @throws InputError naming the option
std::vector<std::uint32_t> batch_seeds(const std::vector<std::string>& words);

std::vector<std::string> known_profiles(const std::vector<std::string>& words);

std::vector<vio::Assignment> native_workload(const std::vector<std::string>& overrides);

void add_batch_options(CLI::App& command, BatchWords& words);

/// @throws InputError naming the option
BatchPlan make_plan(const CLI::App& command, const BatchWords& words);

/// A run of the plan; its sequence must outlive it.
Point make_run(const BatchPlan& plan, const Sequence& sequence, const std::string& profile,
               const traces::ImageSize& size, std::uint32_t seed);

/// Names of the sequences, each once, in the order in which they were given.
std::vector<std::string> sequence_names(const BatchPlan& plan);

/// What every manifest of a study begins with. @param format  "leviosim batch manifest"
Json study_manifest(const std::string& format, const Words& command_line);

/// The content of manifest.json. Nothing in it depends on the host or on cache hits.
Json batch_manifest(const BatchPlan& plan, const Words& command_line);

/// A command line to try next: the first of the sequences on a chip.
std::vector<std::string> after_batch(const BatchPlan& plan);

/// "752x480".
std::string size_text(const traces::ImageSize& size);

}  // namespace leviosim::tools
