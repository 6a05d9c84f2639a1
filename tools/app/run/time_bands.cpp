#include "tools/app/run/time_bands.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include "sim/soc/job_timer.h"
#include "tools/app/run/range_bands.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostFrames = 6;

/// The stages of all jobs, by name.
std::vector<std::string_view> stages_of(const JobSample& sample) {
  std::vector<std::string_view> names;
  const auto add = [&](const work::Job& job) {
    for (const work::StageRun& stage : job.stages)
      if (std::find(names.begin(), names.end(), stage.stage) == names.end())
        names.push_back(stage.stage);
  };
  for (const work::Job& job : sample.spread()) add(job);
  add(sample.slowest());
  add(sample.iteration());
  return names;
}

/// Most forks of one name, and serial pieces, that are timed of a stage of a frame.
constexpr std::size_t kMostAlike = 3;

/// What steps are alike by: "" for serial work; nothing for what is kept whatever comes.
std::optional<std::string_view> likeness(const work::Step& step) {
  if (std::holds_alternative<work::Serial>(step)) return "";
  if (const auto* fork = std::get_if<work::Fork>(&step)) return fork->name;
  return {};
}

/// A job of which steps that are alike, such as the hypotheses of a RANSAC, are left out: those
/// that are kept stand for several. What is beside data that flow stays as it is.
class Excerpt {
 public:
  explicit Excerpt(const work::Job& job) {
    for (const work::StageRun& stage : job.stages)
      has_background(stage) ? keep(stage) : keep_some(stage);
  }

  const work::Job& job() const { return job_; }
  /// How often each of its stages counts.
  const std::vector<double>& weights() const { return weights_; }

 private:
  static bool has_background(const work::StageRun& stage) {
    return std::any_of(stage.steps.begin(), stage.steps.end(), [](const work::Step& step) {
      const auto* transfer = std::get_if<work::Transfer>(&step);
      return std::holds_alternative<work::TransferWait>(step) ||
             (transfer != nullptr && transfer->background);
    });
  }

  void keep(const work::StageRun& stage) {
    job_.stages.push_back({stage.stage, stage.steps, {}});
    weights_.push_back(1);
  }

  void keep_some(const work::StageRun& stage) {
    std::map<std::string_view, std::vector<std::size_t>> alike;
    for (std::size_t i = 0; i < stage.steps.size(); ++i)
      if (const auto name = likeness(stage.steps[i])) alike[*name].push_back(i);
    std::vector<double> weights(stage.steps.size(), 1.0);
    for (const auto& [name, places] : alike) {
      const std::size_t kept = std::min(kMostAlike, places.size());
      for (const std::size_t i : places) weights[i] = 0;
      for (std::size_t k = 0; k < kept; ++k)  // each in the middle of those that it stands for
        weights[places[(2 * k + 1) * places.size() / (2 * kept)]] =
            static_cast<double>(places.size()) / static_cast<double>(kept);
    }
    for (std::size_t i = 0; i < stage.steps.size(); ++i)
      if (weights[i] > 0) keep_one(stage, i, weights[i]);
  }

  /// A fork behind another costs less: where one was left out, one without work is in its place.
  void keep_one(const work::StageRun& stage, std::size_t step, double weight) {
    const auto* fork = std::get_if<work::Fork>(&stage.steps[step]);
    const bool behind_fork = step > 0 && std::holds_alternative<work::Fork>(stage.steps[step - 1]);
    const bool is_behind =
        !job_.stages.empty() && std::holds_alternative<work::Fork>(job_.stages.back().steps.back());
    if (fork != nullptr && step > 0 && behind_fork != is_behind)
      push(stage.stage,
           behind_fork
               ? work::Step(work::Fork{fork->name, std::vector<work::Segment>(fork->shares.size()),
                                       fork->master_takes_part})
               : work::Step(work::Serial{}),
           0);
    push(stage.stage, stage.steps[step], weight);
  }

  void push(std::string_view stage, work::Step step, double weight) {
    job_.stages.push_back({stage, {std::move(step)}, {}});
    weights_.push_back(weight);
  }

  work::Job job_;
  std::vector<double> weights_;
};

/// Cycles of the slowest frame and of those spread over the run, then of each stage, on one chip
/// after the other: what the first of them took is used again where the others are as it is.
class SampleTimes {
 public:
  /// @param workers  as of sim::Cluster
  SampleTimes(const JobSample& sample, const sim::ChipConfig& first, int workers)
      : stages_(stages_of(sample)),
        slowest_(sample.slowest()),
        spread_(sample.spread().begin(), sample.spread().end()),
        iteration_(sample.iteration()),
        workers_(workers),
        memory_(cluster_of(first)) {
    soc::JobTimer timer(first, workers);
    timer.remember(&memory_);
    cycles(timer);
  }

  std::vector<double> on(const sim::ChipConfig& chip) const {
    soc::JobTimer timer(chip, workers_);
    timer.recall(&memory_);
    return cycles(timer);
  }
  const std::vector<std::string_view>& stages() const { return stages_; }

 private:
  sim::ClusterConfig cluster_of(const sim::ChipConfig& chip) const {
    return soc::JobTimer(chip, workers_).cluster();
  }

  std::vector<double> cycles(soc::JobTimer& timer) const {
    std::vector<double> cycles(2 + stages_.size(), 0.0);
    cycles[0] = front_end(timer, slowest_, cycles);
    for (const Excerpt& job : spread_) cycles[1] += front_end(timer, job, cycles);
    for (const sim::StageTiming& stage : timer.optimiser(iteration_).stages)
      of_stage(stage.stage, cycles) += static_cast<double>(stage.cycles.count());
    return cycles;
  }

  double front_end(soc::JobTimer& timer, const Excerpt& excerpt,
                   std::vector<double>& cycles) const {
    const sim::JobTiming timing = timer.front_end(excerpt.job());
    auto frame = static_cast<double>(timer.front_end_cycles(timing).count());
    for (std::size_t i = 0; i < timing.stages.size(); ++i) {
      const auto once = static_cast<double>(timing.stages[i].cycles.count());
      const double weight = excerpt.weights()[i];
      of_stage(timing.stages[i].stage, cycles) += weight * once;
      frame += (weight - 1) * once;
    }
    return frame;
  }

  double& of_stage(std::string_view stage, std::vector<double>& cycles) const {
    const auto at = std::find(stages_.begin(), stages_.end(), stage) - stages_.begin();
    return cycles[2 + static_cast<std::size_t>(at)];
  }

  std::vector<std::string_view> stages_;
  Excerpt slowest_;
  std::vector<Excerpt> spread_;
  const work::Job& iteration_;
  int workers_;
  sim::TeamMemory memory_;
};

/// Over the figure itself, which is exactly 1: a band changes no digit of a time.
Banded relative(const Banded& figure) {
  if (figure.value == 0) return {1, 1, 1};
  return {1, figure.low / figure.value, figure.high / figure.value};
}

}  // namespace

void JobSample::add_frame(const work::Job& job, Cycles cycles) {
  slowest_.take(job, cycles);
  if (++frames_ % stride_ != 0) return;
  spread_.push_back(job);
  if (spread_.size() < kMostFrames) return;
  stride_ *= 2;  // every other one of those that there are has a number that stride divides
  for (std::size_t i = 0; 2 * i + 1 < spread_.size(); ++i)
    spread_[i] = std::move(spread_[2 * i + 1]);
  spread_.resize(spread_.size() / 2);
}

void JobSample::add_iteration(const work::Job& job, const sim::JobTiming& timing) {
  Cycles cycles;
  for (const sim::StageTiming& stage : timing.stages) cycles += stage.cycles;
  iteration_.take(job, cycles);
}

TimeBands time_bands(const platform::ResolvedPlatform& platform, int cores, const JobSample& sample,
                     TimeBandsOf which, unsigned threads) {
  check(!sample.empty() && which != TimeBandsOf::nothing, "bands are of a run with frames");
  const platform::Variants variants(platform);
  if (which == TimeBandsOf::slowest_frame) {
    JobSample slowest;
    slowest.add_frame(sample.slowest(), Cycles(1));
    const SampleTimes times(slowest, variants.config({}), cores);
    const Banded band =
        relative(range_bands(
                     variants, [&](const sim::ChipConfig& chip) { return times.on(chip); }, 1)
                     .front());
    return {band, band, {}};
  }
  const sim::ChipConfig first = variants.config({});
  const SampleTimes team(sample, first, cores);
  std::optional<SampleTimes> alone;
  if (which == TimeBandsOf::team_and_one_core)
    alone.emplace(sample, first, sim::Cluster::kMasterAlone);
  const std::vector<Banded> bands = range_bands(
      variants,
      [&](const sim::ChipConfig& chip) {
        std::vector<double> cycles = team.on(chip);
        if (alone) {
          const std::vector<double> of_stages = alone->on(chip);
          cycles.insert(cycles.end(), of_stages.begin() + 2, of_stages.end());
        }
        return cycles;
      },
      threads);
  const std::vector<std::string_view>& stages = team.stages();
  TimeBands result{relative(bands[1]), relative(bands[0]), {}};
  for (std::size_t i = 0; i < stages.size(); ++i)
    result.stages.push_back({std::string(stages[i]), relative(bands[2 + i]),
                             alone ? relative(bands[2 + stages.size() + i]) : Banded{1, 1, 1}});
  return result;
}

}  // namespace leviosim::tools
