// The replay engine of an interactive page: the same sources as `leviosim replay`, for WebAssembly.
// The page gives a recorded work trace, the platform of the recording and settings as -p takes
// them; the engine times the flight, or one frame of it, and answers in JSON. What it refuses ends
// the call with the same words as on the command line (throwing.cpp).
//
// Both go through simulate_source(), with the event kernel: its coroutines need WebAssembly's tail
// calls. Left out: bands of times, which take many more solutions, and the work of other numbers of
// cores, which is not in a trace.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "platform_models/loader/platform_file.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/chip/accelerator.h"
#include "sim/chip/chip.h"
#include "sim/energy/area.h"
#include "tools/app/record/cycle_parts.h"
#include "tools/app/record/statistics.h"
#include "tools/app/run/replay.h"
#include "tools/app/run/run_observer.h"
#include "tools/app/run/simulate.h"
#include "tools/app/table/json.h"
#include "tools/wasm/frame_source.h"

namespace leviosim::tools {
namespace {

extern "C" {
/// Of the page: a frame has been timed.
__attribute__((import_module("page"), import_name("frame"))) void page_frame(int frame,
                                                                             double latency_ns);
}

constexpr std::string_view kRate = "fps=";
/// Of a camera. [1/s]
constexpr double kLeastRate = 1, kMostRate = 1000;

/// Overrides of the platform as -p takes them, and the rate of the camera.
struct Settings {
  std::vector<std::string> overrides;
  std::int64_t period_ns = 0;
};

std::int64_t period_of(std::string_view rate) {
  const std::optional<double> number = platform::parse_number(rate);
  if (!number || !(*number >= kLeastRate && *number <= kMostRate))
    throw InputError(
        fmt::format("fps={}: expected a number from {} to {}", rate, kLeastRate, kMostRate));
  return std::llround(1e9 / *number);
}

/// Tells the page of each frame of a flight.
class PageObserver : public RunObserver {
 public:
  void on_front_end(const FrontEndJob& job) override {
    page_frame(job.frame, static_cast<double>(job.result.end_ns - job.result.arrival_ns));
  }
};

/// When the stages of a frame run on a chip that does nothing else.
class FrameSpans : public RunObserver {
 public:
  explicit FrameSpans(const sim::ChipConfig& chip) : timebase_(sim::timebase_of(chip)) {}
  void on_front_end(const FrontEndJob& job) override { add(job.parallel, false); }
  void on_optimiser(const OptimiserJob& job) override { add(job.timing, true); }
  /// [{"stage", "controller", "begin_ns", "end_ns"}, …]
  Json take() { return std::move(spans_); }

 private:
  void add(const sim::JobTiming& job, bool on_controller) {
    const auto ns = [&](sim::Time t) { return timebase_.whole_nanoseconds(t - sim::Time{}); };
    for (const sim::StageTiming& stage : job.stages)
      spans_.push_back({{"stage", stage.stage},
                        {"controller", on_controller},
                        {"begin_ns", ns(stage.begin)},
                        {"end_ns", ns(stage.end)}});
  }

  sim::Timebase timebase_;
  Json spans_ = Json::array();
};

/// The figures that the page shows while a slider moves.
bool is_shown(std::string_view statistic) {
  static constexpr std::string_view kShown[] = {
      "frame.", "frames.waited",  "energy.frame",   "energy.mean_power",
      "area.",  "memory.l1.peak", "memory.l2.peak", "run.frame_period"};
  return std::any_of(std::begin(kShown), std::end(kShown),
                     [&](std::string_view shown) { return statistic.starts_with(shown); });
}

Json stages_json(const RunResult& run) {
  Json stages = Json::array();
  for (const StageParts& stage : cycle_parts(run)) {
    Json parts = Json::object();
    for (const CyclePart& part : stage.parts) {
      Json& cycles = parts[part.mechanism];
      cycles = (cycles.is_null() ? 0.0 : cycles.get<double>()) + part.cycles;
    }
    stages.push_back({{"name", stage.stage},
                      {"controller", stage.on_controller},
                      {"cycles", stage.cycles},
                      {"parts", std::move(parts)}});
  }
  return stages;
}

Json outcome_json(const RunResult& run, bool all) {
  RunFigures figures = figures_of(run);
  Json statistics = Json::object();
  for (const Statistic& statistic : figures.statistics)
    if (all || is_shown(statistic.name))
      add_member(statistics, statistic.name, number_json(statistic.value));
  Json verdicts = Json::array();
  for (const RunVerdict& verdict : figures.verdicts.list)
    verdicts.push_back({{"about", verdict.about},
                        {"grade", name_of(verdict.grade)},
                        {"word", verdict.word()},
                        {"reasons", verdict.reasons}});
  return {{"statistics", std::move(statistics)},
          {"verdicts", std::move(verdicts)},
          {"stages", stages_json(run)},
          {"cores", run.cores},
          {"cluster_hz", run.cluster_clock.count()},
          {"controller_hz", run.controller_clock.count()},
          {"frames", run.frames.size()}};
}

class Engine {
 public:
  Engine(std::string trace, std::string platform)
      : trace_("the recording", std::move(trace)),
        platform_("the recorded chip", std::move(platform)),
        settings_(settings_of("")),
        chip_(platform_.resolve({})) {}

  /// Settings from now on. Answers with the area.
  Json set(std::string_view lines) {
    Settings settings = settings_of(lines);
    platform::ResolvedPlatform chip = resolved(settings);
    settings_ = std::move(settings);
    chip_ = std::move(chip);
    return {{"area_mm2", area_mm2(chip_.config)}};
  }

  /// Why each of some settings cannot run; null where it can. What fits is known after a flight.
  Json refusal(std::string_view lines) {
    const platform::ResolvedPlatform chip = resolved(settings_of(lines));
    const auto expect = [](const char* memory, Bytes needed, Bytes size) {
      if (needed > size)
        throw InputError(fmt::format("the recorded work needs {} bytes of {}, which has {}",
                                     needed.count(), memory, size.count()));
    };
    expect("L1", l1_peak_, chip.config.cluster.l1.size);
    expect("L2", l2_peak_, chip.config.l2.size);
    return nullptr;
  }

  Json flight(bool everything) {
    RunRequest request = request_of(chip_);
    request.on_one_core = everything;
    PageObserver observer;
    request.observer = &observer;
    FlightSource source(trace_, chip_.config, sim::has_accelerators(chip_.config),
                        settings_.period_ns);
    const RunResult run = simulate_source(request, source, [](const Progress&) {});
    for (const StageResult& stage : run.stages) {
      Bytes& peak = stage.on_controller ? l2_peak_ : l1_peak_;
      peak = std::max(peak, stage.memory.parallel);
    }
    return outcome_json(run, everything);
  }

  Json frame(int number) {
    FrameSpans spans(chip_.config);
    Json outcome = outcome_json(timed_frame(number, chip_, settings_, &spans), false);
    outcome["spans"] = spans.take();
    return outcome;
  }

  /// What the setting adds to another one: in area, and in energy of a frame.
  Json price(int number, std::string_view other_lines) {
    const Settings other = settings_of(other_lines);
    const platform::ResolvedPlatform chip = resolved(other);
    return {{"area_mm2", area_mm2(chip_.config) - area_mm2(chip.config)},
            {"energy_mj", energy_mj(timed_frame(number, chip_, settings_)) -
                              energy_mj(timed_frame(number, chip, other))}};
  }

 private:
  Settings settings_of(std::string_view lines) const {
    Settings settings{{}, trace_.info().frame_period_ns};
    for (const std::string& line : base::split(std::string(lines), '\n')) {
      if (line.starts_with(kRate))
        settings.period_ns = period_of(std::string_view(line).substr(kRate.size()));
      else if (!line.empty())
        settings.overrides.push_back(line);
    }
    return settings;
  }

  platform::ResolvedPlatform resolved(const Settings& settings) {
    platform::ResolvedPlatform chip = platform_.resolve(settings.overrides);
    RunRequest request;
    request.platform = chip;
    request.cores = chip.config.cluster.workers;
    if (!settings.overrides.empty()) check_cores(trace_, request);
    return chip;
  }

  RunRequest request_of(const platform::ResolvedPlatform& chip) const {
    RunRequest request;
    request.platform = chip;
    request.cores = trace_.info().cores;
    request.on_one_core = false;
    return request;
  }

  RunResult timed_frame(int number, const platform::ResolvedPlatform& chip,
                        const Settings& settings, RunObserver* observer = nullptr) {
    decode(number, chip.config);
    FrameSource source(trace_, frame_, number, chip.config, settings.period_ns);
    RunRequest request = request_of(chip);
    request.observer = observer;
    return simulate_source(request, source, [](const Progress&) {});
  }

  /// The frame stays, so that a slider that moves does not read it again.
  void decode(int number, const sim::ChipConfig& chip) {
    const Decoded wanted{number, sim::has_accelerators(chip), sim::code_of(chip)};
    if (decoded_ == wanted) return;
    decoded_.reset();
    traces::WorkFrames reader(trace_, wanted.offload, wanted.code);
    reader.skip_to(number);
    if (!reader.next(frame_))
      throw InputError(fmt::format("frame {}: the recording has {}", number, trace_.frames()));
    decoded_ = wanted;
  }

  static double area_mm2(const sim::ChipConfig& chip) {
    return sim::knows_area(chip) ? sim::total_area(chip).area.count() * 1e-6 : 0;
  }
  static double energy_mj(const RunResult& run) {
    const RunFigures figures = figures_of(run);
    return figures.value("energy.frame").value_or(0);
  }

  struct Decoded {
    int number;
    bool offload;
    std::optional<work::CompiledFor> code;
    friend bool operator==(const Decoded&, const Decoded&) = default;
  };

  traces::WorkTrace trace_;
  platform::PlatformFile platform_;
  Settings settings_;
  platform::ResolvedPlatform chip_;
  Bytes l1_peak_;
  Bytes l2_peak_;
  std::optional<Decoded> decoded_;
  traces::WorkFrame frame_;
};

std::string g_input;
std::string g_output;
std::unique_ptr<Engine> g_engine;

std::size_t answer(const Json& json) {
  g_output = json_text(json);
  return g_output.size();
}

}  // namespace
}  // namespace leviosim::tools

using leviosim::tools::answer;
using leviosim::tools::g_engine;
using leviosim::tools::g_input;
using leviosim::tools::g_output;

#define LEVIOSIM_PAGE(name) extern "C" __attribute__((export_name(#name)))

/// Room for what the next call reads.
LEVIOSIM_PAGE(input) char* input(std::size_t size) {
  g_input.resize(size);
  return g_input.data();
}
/// Of the last call.
LEVIOSIM_PAGE(output) const char* output() { return g_output.data(); }

/// The work trace with plain sections, and behind it the platform as JSON. Calls from here on
/// return the size of their answer.
LEVIOSIM_PAGE(load) std::size_t load(std::size_t trace_size) {
  std::string platform = g_input.substr(trace_size);
  g_input.resize(trace_size);
  g_engine = std::make_unique<leviosim::tools::Engine>(std::move(g_input), std::move(platform));
  g_input = {};
  return answer(nullptr);
}
LEVIOSIM_PAGE(set) std::size_t set() { return answer(g_engine->set(g_input)); }
LEVIOSIM_PAGE(refusal) std::size_t refusal() { return answer(g_engine->refusal(g_input)); }
LEVIOSIM_PAGE(frame) std::size_t frame(int number) { return answer(g_engine->frame(number)); }
LEVIOSIM_PAGE(price) std::size_t price(int number) {
  return answer(g_engine->price(number, g_input));
}
LEVIOSIM_PAGE(flight) std::size_t flight(int everything) {
  return answer(g_engine->flight(everything != 0));
}
