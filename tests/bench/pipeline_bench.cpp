// The whole pipeline: counting against native, and the timing model on top of counting. Every
// iteration runs all three one after the other over the same frames, so that the ratios hold on a
// machine whose speed drifts.
//
// On the real frames below LEVIOSIM_DATA where that is set, else on a synthetic flight that is made
// in a temporary folder.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <vector>

#include "platform_models/loader.h"
#include "sim/chip/chip.h"
#include "tools/run/feed.h"
#include "traces/synthetic.h"

namespace leviosim {
namespace {

constexpr int kFrames = 60;

/// The frames of the benchmark, kept in memory: reading images is no part of the comparison.
struct Recording {
  vio::Rig rig;
  std::vector<std::vector<std::uint8_t>> pixels;
  std::vector<vio::FrameInput> frames;
};

std::string data_folder() {
  if (const char* data = std::getenv("LEVIOSIM_DATA"))
    return std::string(data) + "/euroc/MH_01_easy_t05_t20";
  const auto folder = std::filesystem::temp_directory_path() / "leviosim-bench-flight";
  if (!std::filesystem::exists(folder))
    traces::write_synthetic_flight(folder, {.duration_s = 5, .texel_m = 0.01});
  return folder;
}

const Recording& recording() {
  static const Recording frames = [] {
    tools::RunRequest request;
    request.data = data_folder();
    request.native = true;
    tools::Feed feed(request);
    Recording r;
    r.rig = feed.rig();
    // The first second of a flight is at rest; the work of a moving camera is what counts.
    const int first = std::min(30, feed.size() - 1);
    for (int i = 0; i < std::min(first + kFrames, feed.size()); ++i) {
      const vio::FrameInput& input = feed.frame(i);
      if (i < first) continue;
      r.pixels.emplace_back(input.pixels, input.pixels + input.width * input.height);
      r.frames.push_back(input);
    }
    for (std::size_t i = 0; i < r.frames.size(); ++i) r.frames[i].pixels = r.pixels[i].data();
    return r;
  }();
  return frames;
}

enum class Mode { Native, Counting, Timed };

/// Seconds for all frames.
double run(Mode mode) {
  const Recording& input = recording();
  const vio::Profile profile = vio::profile_named("levio", 1);
  const bool record = mode != Mode::Native;
  work::Machine cluster(
      {.cores = 8, .memory = "L1", .alignment = profile.l1_alignment, .record = record});
  work::Machine controller(
      {.cores = 1, .memory = "L2", .capacity = Bytes(1'600'000), .record = record});
  const auto odometry = vio::make_odometry(record, profile, input.rig, cluster, controller);
  const sim::ChipConfig config = platform::load_platform("gap9");
  sim::Chip chip(config, 8);
  sim::Chip single(config, 1);
  const auto time_on = [](sim::Chip& on, const work::Job& job) {
    const auto body = [](sim::Chip& c, const work::Job& j) -> sim::Process {
      co_await c.offload(j);
    };
    on.kernel().spawn("job", body(on, job));
    on.kernel().run();
  };
  const auto begin = std::chrono::steady_clock::now();
  for (const vio::FrameInput& frame : input.frames) {
    const bool optimising = odometry->begin_optimisation();
    benchmark::DoNotOptimize(odometry->process_frame(frame));
    for (int k = 0; optimising && k < profile.optimiser_iterations; ++k) odometry->optimise();
    if (optimising) odometry->publish();
    const work::Job front = cluster.take_job();
    const work::Job back = controller.take_job();
    if (mode != Mode::Timed) continue;
    time_on(chip, front);
    time_on(chip, back);
    time_on(single, front);
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void pipeline(benchmark::State& state) {
  recording();
  std::vector<double> counting, timing, native_ms;
  for (auto _ : state) {
    const double native = run(Mode::Native);
    const double counted = run(Mode::Counting);
    const double timed = run(Mode::Timed);
    counting.push_back(counted / native);
    timing.push_back(timed / counted);
    native_ms.push_back(1e3 * native / static_cast<double>(recording().frames.size()));
  }
  state.counters["counting/native"] = median(counting);
  state.counters["timed/counting"] = median(timing);
  state.counters["native_ms_per_frame"] = median(native_ms);
}
BENCHMARK(pipeline)->Iterations(9)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace leviosim

BENCHMARK_MAIN();
