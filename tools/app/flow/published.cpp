#include "tools/app/flow/published.h"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/energy/model.h"
#include "sim/energy/operating_point.h"
#include "tools/app/result/energy.h"
#include "tools/app/validation/builtin_references.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kReferences = "px4flow";
constexpr std::array<std::string_view, 3> kNames = {"frames per second", "speed-up", "power"};

FlowFigure figure_named(const base::CsvRow& row) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (row.text(1) == kNames[i]) return static_cast<FlowFigure>(i);
  row.fail(1, "unknown: expected 'frames per second', 'speed-up' or 'power'");
}

std::optional<double> power_mw(const PublishedFlow& published, const RunResult& run) {
  if (!sim::knows_energy(run.chip)) return std::nullopt;
  const double ratio = published.clock_mhz * 1e6 / static_cast<double>(run.cluster_clock.count());
  const Hertz faster = std::max(run.cluster_clock, run.controller_clock);
  const Hertz clock(std::llround(static_cast<double>(faster.count()) * ratio));
  const auto voltage = sim::lowest_voltage(run.chip.supply, clock);
  if (!voltage || !published.rate) return std::nullopt;
  const auto energy = energy_at(at_rate(run, *published.rate), {*voltage, clock});
  if (!energy || !energy->mean_power()) return std::nullopt;
  return energy->mean_power()->value.count() * 1e3;
}

}  // namespace

std::string_view name_of(FlowFigure figure) { return kNames[static_cast<std::size_t>(figure)]; }

std::vector<PublishedFlow> published_flow() {
  const std::vector<std::string> columns = {"platform", "figure", "cores", "clock_mhz",
                                            "rate",     "value",  "unit",  "source"};
  base::CsvReader reader(fmt::format("tests/validation/{}.csv", kReferences),
                         base::Separator::comma, columns, std::string(reference_text(kReferences)));
  std::vector<PublishedFlow> all;
  while (const base::CsvRow* row = reader.next()) {
    if (row->text(0) == columns[0]) continue;  // the header
    PublishedFlow published;
    published.platform = row->text(0);
    published.figure = figure_named(*row);
    published.cores = static_cast<int>(row->number(2));
    published.clock_mhz = row->number(3);
    if (!row->text(4).empty()) published.rate = row->number(4);
    published.value = row->number(5);
    published.unit = row->text(6);
    published.source = row->text(7);
    all.push_back(std::move(published));
  }
  return all;
}

std::optional<FlowCycles> flow_cycles(const RunResult& run) {
  if (run.frames.size() < 2) return std::nullopt;
  FlowCycles sum;
  for (std::size_t i = 1; i < run.frames.size(); ++i) {
    sum.single += static_cast<double>(run.frames[i].single_cycles.count());
    sum.parallel += static_cast<double>(run.frames[i].cycles.count());
  }
  const auto frames = static_cast<double>(run.frames.size() - 1);
  return FlowCycles{sum.single / frames, sum.parallel / frames};
}

RunResult at_rate(RunResult run, double frames_per_second) {
  const double period_ns = 1e9 / frames_per_second;
  run.frame_period_ns = std::llround(period_ns);
  for (std::size_t i = 0; i < run.frames.size(); ++i)
    run.frames[i].arrival_ns = std::llround(period_ns * static_cast<double>(i));
  return run;
}

std::optional<double> predicted(const PublishedFlow& published, const RunResult& run) {
  const std::optional<FlowCycles> cycles = flow_cycles(run);
  if (!cycles || published.cores != run.cores) return std::nullopt;
  switch (published.figure) {
    case FlowFigure::FrameRate:
      return published.clock_mhz * 1e6 / cycles->parallel;
    case FlowFigure::SpeedUp:
      return cycles->single / cycles->parallel;
    case FlowFigure::Power:
      break;
  }
  return power_mw(published, run);
}

}  // namespace leviosim::tools
