#include "tools/app/run/time_bands.h"

#include <algorithm>
#include <string_view>

#include "sim/base/check.h"
#include "sim/soc/job_timer.h"

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

/// Cycles of the slowest frame and of those spread over the run, then of each stage.
class SampleTimes {
 public:
  SampleTimes(const JobSample& sample, const std::vector<std::string_view>& stages)
      : sample_(sample), stages_(stages), cycles_(2 + stages.size(), 0.0) {}

  void run(const sim::ChipConfig& chip, int workers) {
    soc::JobTimer timer(chip, workers);
    cycles_[0] = front_end(timer, sample_.slowest());
    for (const work::Job& job : sample_.spread()) cycles_[1] += front_end(timer, job);
    add_stages(timer.optimiser(sample_.iteration()));
  }
  const std::vector<double>& cycles() const { return cycles_; }

 private:
  double front_end(soc::JobTimer& timer, const work::Job& job) {
    const sim::JobTiming timing = timer.front_end(job);
    add_stages(timing);
    return static_cast<double>(timer.front_end_cycles(timing).count());
  }
  void add_stages(const sim::JobTiming& timing) {
    for (const sim::StageTiming& stage : timing.stages) {
      const auto at = std::find(stages_.begin(), stages_.end(), stage.stage) - stages_.begin();
      cycles_[2 + static_cast<std::size_t>(at)] += static_cast<double>(stage.cycles.count());
    }
  }

  const JobSample& sample_;
  const std::vector<std::string_view>& stages_;
  std::vector<double> cycles_;
};

/// Over the figure itself.
Banded relative(const Banded& figure) {
  return figure.value == 0 ? Banded{1, 1, 1} : (1 / figure.value) * figure;
}

}  // namespace

void JobSample::Longest::take(const work::Job& other, Cycles its) {
  if (its <= cycles) return;
  job = other;
  cycles = its;
}

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
    const auto cycles = [&](const sim::ChipConfig& chip) {
      soc::JobTimer timer(chip, cores);
      const auto count = timer.front_end_cycles(timer.front_end(sample.slowest())).count();
      return std::vector<double>{static_cast<double>(count)};
    };
    const Banded band = relative(range_bands(variants, cycles, 1).front());
    return {band, band, {}};
  }
  const bool single = which == TimeBandsOf::team_and_one_core;
  const std::vector<std::string_view> stages = stages_of(sample);
  const std::vector<Banded> bands = range_bands(
      variants,
      [&](const sim::ChipConfig& chip) {
        SampleTimes team(sample, stages);
        team.run(chip, cores);
        std::vector<double> cycles = team.cycles();
        if (!single) return cycles;
        SampleTimes alone(sample, stages);
        alone.run(chip, sim::Cluster::kMasterAlone);
        cycles.insert(cycles.end(), alone.cycles().begin() + 2, alone.cycles().end());
        return cycles;
      },
      threads);
  TimeBands result{relative(bands[1]), relative(bands[0]), {}};
  for (std::size_t i = 0; i < stages.size(); ++i)
    result.stages.push_back({std::string(stages[i]), relative(bands[2 + i]),
                             single ? relative(bands[2 + stages.size() + i]) : Banded{1, 1, 1}});
  return result;
}

}  // namespace leviosim::tools
