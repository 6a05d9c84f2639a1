// What studies of accuracy have in common, which make native runs of many profiles, image sizes and
// seeds over sequences: options, points, what their manifests say.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/cli/progress_line.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/point.h"
#include "tools/app/study/sequence.h"
#include "tools/app/study/study.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

/// As typed. Lists stand for the single values of RunOptions.
struct BatchOptions : StudyOptions {
  std::vector<std::string> folders;
  std::vector<std::string> profiles{"levio", "levio-no-imu", "levio-no-imu-no-epnp"};
  std::vector<std::string> sizes{"160x120"};
  std::vector<std::string> seeds{"1", "2", "3"};
  std::string align = "se3";
  std::string relative = "40";
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
  std::shared_ptr<traces::PictureMemory> pictures = std::make_shared<traces::PictureMemory>();
};

/// What --seed, --profile and -p of native runs were given. @throws InputError naming the option
std::vector<std::uint32_t> batch_seeds(const std::vector<std::string>& words);

std::vector<std::string> known_profiles(const std::vector<std::string>& words);

std::vector<vio::Assignment> native_workload(const std::vector<std::string>& overrides);

void add_batch_options(CLI::App& command, BatchOptions& options);

/// What the runs read. @throws InputError if it or --out is missing
std::vector<std::filesystem::path> batch_inputs(const char* command, const BatchOptions& options);

/// @param progress  of the synthetic flight, if it has to be made
/// @throws InputError naming the option
BatchPlan make_plan(const BatchOptions& options, ProgressLine::Style progress);

/// A run of the plan; its sequence must outlive it.
Point make_run(const BatchPlan& plan, const Sequence& sequence, const std::string& profile,
               const traces::ImageSize& size, std::uint32_t seed);

/// Names of the sequences, each once, in the order in which they were given.
std::vector<std::string> sequence_names(const BatchPlan& plan);

/// Answer::manifest.
Json batch_manifest(const BatchPlan& plan);

/// A command line to try next: the first of the sequences on a chip.
std::vector<std::string> after_batch(const BatchPlan& plan);

/// "752x480".
std::string size_text(const traces::ImageSize& size);

}  // namespace leviosim::tools
