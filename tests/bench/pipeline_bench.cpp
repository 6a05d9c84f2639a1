// The whole pipeline: counting against native, without and with following the code, and the timing
// model on top. All take every frame one after the other, so that the ratios hold on a machine
// whose speed drifts.
//
// On the real frames below LEVIOSIM_DATA where that is set, else on a synthetic flight that is made
// in a temporary folder.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "platform_models/loader/compiled_code.h"
#include "platform_models/loader/loader.h"
#include "sim/soc/job_timer.h"
#include "tests/bench/cpu_time.h"
#include "tools/app/run/feed.h"
#include "tools/app/run/live_source.h"
#include "traces/synthesis/synthetic.h"
#include "workload/vio/odometry/odometry.h"
#include "workload/vio/profile.h"

namespace leviosim {
namespace {

constexpr int kFrames = 270;

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

enum class Mode { Native, CountingOperations, Counting, Timed };

/// One odometry with the machines that it works on, and the time that its frames took.
class Pipeline {
 public:
  Pipeline(Mode mode, const vio::Rig& rig) : mode_(mode) {
    const bool record = mode != Mode::Native;
    const work::CodeMap* code =
        mode == Mode::CountingOperations ? nullptr : &platform::compiled_code();
    cluster_.emplace(work::MachineConfig{.cores = 8,
                                         .memory = "L1",
                                         .alignment = profile_.l1_alignment,
                                         .record = record,
                                         .offload = false,
                                         .code = code});
    controller_.emplace(work::MachineConfig{.cores = 1,
                                            .memory = "L2",
                                            .capacity = Bytes(1'600'000),
                                            .record = record,
                                            .offload = false,
                                            .code = code});
    odometry_ = vio::make_odometry(record, profile_, rig, *cluster_, *controller_);
  }

  void process(const vio::FrameInput& frame) {
    const double begin = cpu_seconds();
    const bool optimising = odometry_->begin_optimisation();
    benchmark::DoNotOptimize(odometry_->process_frame(frame));
    for (int k = 0; optimising && k < profile_.optimiser_iterations; ++k) odometry_->optimise();
    if (optimising) odometry_->publish();
    if (mode_ != Mode::Native) {
      const work::Job front = cluster_->take_job();
      const work::Job back = controller_->take_job();
      if (mode_ == Mode::Timed) {
        benchmark::DoNotOptimize(team_.front_end(front));
        benchmark::DoNotOptimize(team_.optimiser(back));
        benchmark::DoNotOptimize(single_.front_end(front));
      }
    }
    seconds_ += cpu_seconds() - begin;
  }
  double seconds() const { return seconds_; }

 private:
  Mode mode_;
  vio::Profile profile_ = vio::profile_named("levio", 1);
  std::optional<work::Machine> cluster_, controller_;
  std::unique_ptr<vio::Odometry> odometry_;
  sim::ChipConfig config_ = platform::load_platform("gap9");
  soc::JobTimer team_{config_, 8}, single_{config_, sim::Cluster::kMasterAlone};
  double seconds_ = 0;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void pipeline(benchmark::State& state) {
  recording();
  std::vector<double> operations, counting, timing, native_ms;
  for (auto _ : state) {
    const vio::Rig& rig = recording().rig;
    Pipeline native(Mode::Native, rig), operation_counting(Mode::CountingOperations, rig),
        counted(Mode::Counting, rig), timed(Mode::Timed, rig);
    for (const vio::FrameInput& frame : recording().frames)
      for (Pipeline* pipeline : {&native, &operation_counting, &counted, &timed})
        pipeline->process(frame);
    operations.push_back(operation_counting.seconds() / native.seconds());
    counting.push_back(counted.seconds() / native.seconds());
    timing.push_back(timed.seconds() / counted.seconds());
    native_ms.push_back(1e3 * native.seconds() / static_cast<double>(recording().frames.size()));
  }
  state.counters["counting_operations/native"] = median(operations);
  state.counters["counting/native"] = median(counting);
  state.counters["timed/counting"] = median(timing);
  state.counters["native_ms_per_frame"] = median(native_ms);
}
BENCHMARK(pipeline)->Iterations(5)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace leviosim

BENCHMARK_MAIN();
