#include "tools/app/run/range_bands.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "platform_models/loader/value.h"
#include "sim/base/threads.h"
#include "sim/soc/job_timer.h"
#include "sim/work/op.h"

namespace leviosim::tools {
namespace {

/// Whether it says what compilers make of an operation.
bool is_of_compiler(const platform::Parameter& parameter, const sim::CoreConfig& core) {
  constexpr std::string_view kOps = ".ops.";
  const std::size_t at = parameter.path.find(kOps);
  if (at == std::string::npos) return false;
  const std::size_t begin = at + kOps.size();
  const std::size_t end = parameter.path.find('.', begin);
  const std::string name = parameter.path.substr(begin, end - begin);
  if (name.starts_with("loop_")) return true;
  if (parameter.path.substr(end) != ".issue") return false;
  for (const work::OpInfo& op : work::kOps)
    if (op.name == name) return !core[op.op].routine;
  return false;
}

double value_of(const platform::Parameter& parameter) {
  const auto value = platform::parse_number(parameter.value);
  check(value.has_value(), "a parameter with a range is no number");
  return *value;
}

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

/// Cycles of the slowest frame and of those spread over the run, then of each stage, on one chip
/// after the other: what the first of them took is used again where the others are as it is.
class SampleTimes {
 public:
  /// @param workers  as of sim::Cluster
  SampleTimes(const JobSample& sample, const sim::ChipConfig& first, int workers)
      : sample_(sample), stages_(stages_of(sample)), workers_(workers), memory_(cluster_of(first)) {
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
    const auto front_end = [&](const work::Job& job) {
      const sim::JobTiming timing = timer.front_end(job);
      add_stages(timing, cycles);
      return static_cast<double>(timer.front_end_cycles(timing).count());
    };
    cycles[0] = front_end(sample_.slowest());
    for (const work::Job& job : sample_.spread()) cycles[1] += front_end(job);
    add_stages(timer.optimiser(sample_.iteration()), cycles);
    return cycles;
  }
  void add_stages(const sim::JobTiming& timing, std::vector<double>& cycles) const {
    for (const sim::StageTiming& stage : timing.stages) {
      const auto at = std::find(stages_.begin(), stages_.end(), stage.stage) - stages_.begin();
      cycles[2 + static_cast<std::size_t>(at)] += static_cast<double>(stage.cycles.count());
    }
  }

  const JobSample& sample_;
  std::vector<std::string_view> stages_;
  int workers_;
  sim::TeamMemory memory_;
};

/// Over the figure itself.
Banded relative(const Banded& figure) {
  return figure.value == 0 ? Banded{1, 1, 1} : (1 / figure.value) * figure;
}

}  // namespace

bool is_of_time(const platform::Parameter& parameter) {
  for (const std::string_view section : {"energy.", "supply.", "area."})
    if (parameter.path.starts_with(section)) return false;
  return true;
}

std::vector<const platform::Parameter*> ranged(const platform::ResolvedPlatform& platform) {
  std::vector<const platform::Parameter*> parameters;
  for (const platform::Parameter& parameter : platform.parameters)
    if (parameter.range && is_of_time(parameter)) parameters.push_back(&parameter);
  return parameters;
}

bool is_end(const platform::Parameter& parameter, double end) { return value_of(parameter) == end; }

bool is_in_bands(const platform::Parameter& parameter, const sim::ChipConfig& chip) {
  return !is_of_compiler(parameter, chip.cluster.core);
}

std::vector<Banded> range_bands(const platform::Variants& platform, const ChipFigures& figures,
                                unsigned threads) {
  std::vector<const platform::Parameter*> parameters = ranged(platform.platform());
  std::erase_if(parameters, [&](const platform::Parameter* parameter) {
    return !is_in_bands(*parameter, platform.platform().config);
  });
  const std::vector<double> base = figures(platform.config({}));
  std::vector<BandOf> bands;
  for (const double figure : base) bands.emplace_back(figure);
  const auto run = [&](std::size_t count, const auto& job) {
    base::parallel_for(count, threads, job);
  };
  for (const auto& ends : at_ends(platform, parameters, base, figures, run))
    for (std::size_t k = 0; k < bands.size(); ++k) bands[k].add(ends.low[k], ends.high[k]);
  std::array<std::vector<double>, 2> ends;
  run(ends.size(), [&](std::size_t i) {
    sim::ChipConfig chip = platform.config({});
    for (sim::CoreConfig* core : {&chip.cluster.core, &chip.controller.core})
      core->measured_instructions = i == 0 ? kOtherCompilers.low : kOtherCompilers.high;
    ends[i] = figures(chip);
  });
  for (std::size_t k = 0; k < bands.size(); ++k) bands[k].add(ends[0][k], ends[1][k]);
  std::vector<Banded> result;
  for (const BandOf& band : bands) result.push_back(band.band());
  return result;
}

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
    soc::JobTimer first(variants.config({}), cores);
    sim::TeamMemory memory(first.cluster());
    first.remember(&memory);
    first.front_end(sample.slowest());
    const auto cycles = [&](const sim::ChipConfig& chip) {
      soc::JobTimer timer(chip, cores);
      timer.recall(&memory);
      const auto count = timer.front_end_cycles(timer.front_end(sample.slowest())).count();
      return std::vector<double>{static_cast<double>(count)};
    };
    const Banded band = relative(range_bands(variants, cycles, 1).front());
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
