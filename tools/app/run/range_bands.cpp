#include "tools/app/run/range_bands.h"

#include <array>
#include <string_view>

#include "platform_models/loader/parameter.h"
#include "sim/base/threads.h"
#include "sim/work/op.h"
#include "tools/app/run/time_bands.h"

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

}  // namespace

bool is_of_time(const platform::Parameter& parameter) {
  for (const std::string_view section : {"energy.", "supply.", "area."})
    if (parameter.path.starts_with(section)) return false;
  return true;
}

std::vector<const platform::Parameter*> uncertain_numbers(
    const platform::ResolvedPlatform& platform) {
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
  std::vector<const platform::Parameter*> parameters = uncertain_numbers(platform.platform());
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

}  // namespace leviosim::tools
