#include "tools/app/flow/flow_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/base/csv.h"
#include "sim/energy/model.h"
#include "sim/energy/supply.h"
#include "tools/app/report/energy_tables.h"
#include "tools/app/report/run_summary.h"
#include "tools/app/report/tables.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/published_files.h"
#include "tools/app/validation/references.h"
#include "traces/datasets/dataset.h"

namespace leviosim::tools {
namespace {

constexpr double kPixel = 1 << 8;

std::vector<PublishedFlow> published_of(const FlowRun& flow) {
  std::vector<PublishedFlow> rows = published_flow();
  std::erase_if(rows, [&](const PublishedFlow& row) { return row.platform != flow.platform; });
  return rows;
}

std::string figure_text(const PublishedFlow& row) {
  std::string text(name_of(row.figure));
  if (row.rate) text += fmt::format(" at {:g} frames/s", *row.rate);
  return text;
}

double rate_of(const FlowRun& flow) {
  return flow.rate.value_or(1e9 / static_cast<double>(flow.run.frame_period_ns));
}

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

std::string frame_rate_table(const FlowRun& flow) {
  const std::optional<FlowCycles> cycles = flow_cycles(flow.run);
  if (!cycles) return {};
  const double hertz = static_cast<double>(flow.run.cluster_clock.count());
  Table table({{"cores"}, {"kcycles of a frame"}, {"frames/s"}, {"speed-up"}});
  table.add({"1", fmt::format("{:.2f}", cycles->single * 1e-3),
             fmt::format("{:.1f}", hertz / cycles->single), "1.00"});
  if (flow.run.cores > 1)
    table.add({fmt::format("{}", flow.run.cores), fmt::format("{:.2f}", cycles->parallel * 1e-3),
               fmt::format("{:.1f}", hertz / cycles->parallel),
               fmt::format("{:.2f}", cycles->single / cycles->parallel)});
  return fmt::format("frames that the chip could do at {:g} MHz, offload included\n",
                     megahertz(flow.run.cluster_clock)) +
         terminal_text(table);
}

std::string published_table(const FlowRun& flow) {
  const std::vector<PublishedFlow> rows = published_of(flow);
  if (rows.empty()) return {};
  Table table({{"figure", kLeft},
               {"cores"},
               {"MHz"},
               {"unit", kLeft},
               {"published"},
               {"here"},
               {"difference %"},
               {"source", kLeft}});
  for (const PublishedFlow& row : rows) {
    const std::optional<double> here = predicted(row, flow.run);
    table.add(
        {figure_text(row), fmt::format("{}", row.cores), fmt::format("{:g}", row.clock_mhz),
         row.unit, fmt::format("{:g}", row.value), here ? fmt::format("{:.4g}", *here) : kNothing,
         here ? fmt::format("{:+.1f}", 100 * (*here / row.value - 1)) : kNothing, row.source});
  }
  return "published figures (all clocks in proportion, the same cycles)\n" + terminal_text(table);
}

std::string flow_summary(const FlowRun& flow) {
  std::int64_t with_flow = 0;
  double quality = 0, textured = 0, matched = 0, length = 0;
  for (const flow::Flow& f : flow.flows) {
    textured += f.textured;
    matched += f.matched;
    if (f.quality == 0) continue;
    ++with_flow;
    quality += f.quality;
    length += std::hypot(f.x / kPixel, f.y / kPixel);
  }
  const auto pairs = static_cast<double>(std::max<std::size_t>(flow.flows.size(), 2) - 1);
  std::string text = fmt::format(
      "optical flow: {} frames, {} with a flow; of a pair of frames {:.1f} blocks have texture, "
      "{:.1f} a match\n",
      flow.flows.size(), with_flow, textured / pairs, matched / pairs);
  if (with_flow > 0)
    text += fmt::format("              mean quality {:.0f} of 255, mean length {:.2f} px\n",
                        quality / static_cast<double>(with_flow),
                        length / static_cast<double>(with_flow));
  return text;
}

std::vector<std::string> flow_report(const FlowRun& flow) {
  const RunResult timed = at_rate(flow.run, rate_of(flow));
  std::string others;
  for (const std::string& lines : {breakdown_table(timed), memory_table(timed), energy_table(timed),
                                   power_table(timed), flow_summary(flow)})
    if (!lines.empty()) others += lines + '\n';
  std::vector<std::string> parts{stage_table(timed) + '\n', frame_rate_table(flow) + '\n'};
  if (const std::string published = published_table(flow); !published.empty())
    parts.push_back(published + '\n');
  parts.push_back(others + host_line(flow.run));
  return parts;
}

std::string flow_conclusion(const FlowRun& flow) {
  const std::optional<FlowCycles> cycles = flow_cycles(flow.run);
  if (!cycles || cycles->parallel == 0) return "verdict: no frames";
  const double most = static_cast<double>(flow.run.cluster_clock.count()) / cycles->parallel;
  const bool keeps_up = most >= rate_of(flow);
  return fmt::format("verdict: {}: {} cores could do {:.0f} frames/s, the camera sends {:.0f}",
                     keeps_up ? "fits" : "too slow", flow.run.cores, most, rate_of(flow));
}

Table flow_rows(const FlowRun& flow) {
  struct Row {
    const flow::Flow& flow;
    const FrameResult& frame;
  };
  std::vector<Row> rows;
  for (std::size_t i = 0; i < flow.flows.size(); ++i)
    rows.push_back({flow.flows[i], flow.run.frames[i]});
  using R = const Row&;
  return table_of(
      Columns<Row>{{{.key = "frame"}, [](R r) { return r.frame.index; }},
                   {{.key = "t_ns"}, [](R r) { return r.frame.t_ns; }},
                   {{.key = "dx_px", .decimals = 4}, [](R r) { return r.flow.x / kPixel; }},
                   {{.key = "dy_px", .decimals = 4}, [](R r) { return r.flow.y / kPixel; }},
                   {{.key = "quality"}, [](R r) { return r.flow.quality; }},
                   {{.key = "textured"}, [](R r) { return r.flow.textured; }},
                   {{.key = "matched"}, [](R r) { return r.flow.matched; }},
                   {{.key = "parallel_cycles"}, [](R r) { return r.frame.cycles; }},
                   {{.key = "single_cycles"}, [](R r) { return r.frame.single_cycles; }}},
      rows);
}

Table published_rows(const FlowRun& flow) {
  using P = const PublishedFlow&;
  return table_of(
      Columns<PublishedFlow>{{{.key = "platform"}, [](P p) { return p.platform; }},
                             {{.key = "figure"}, [](P p) { return name_of(p.figure); }},
                             {{.key = "cores"}, [](P p) { return p.cores; }},
                             {{.key = "clock_mhz"}, [](P p) { return p.clock_mhz; }},
                             {{.key = "rate"}, [](P p) { return p.rate; }},
                             {{.key = "unit"}, [](P p) { return p.unit; }},
                             {{.key = "published"}, [](P p) { return p.value; }},
                             {{.key = "here"},
                              [&](P p) {
                                const std::optional<double> here = predicted(p, flow.run);
                                return here ? spelled(fmt::format("{:.6g}", *here)) : Cell();
                              }}},
      published_of(flow));
}

std::string_view name_of(FlowFigure figure) { return kNames[static_cast<std::size_t>(figure)]; }

std::vector<PublishedFlow> published_flow() {
  const std::vector<std::string> columns = {"platform", "figure", "cores", "clock_mhz",
                                            "rate",     "value",  "unit",  "source"};
  std::vector<PublishedFlow> all;
  for_each_row(fmt::format("{}.csv", kReferences), reference_text(kReferences), columns,
               [&](const base::CsvRow& row) {
                 PublishedFlow& published = all.emplace_back();
                 published.platform = row.text(0);
                 published.figure = figure_named(row);
                 published.cores = static_cast<int>(row.number(2));
                 published.clock_mhz = row.number(3);
                 if (!row.text(4).empty()) published.rate = row.number(4);
                 published.value = row.number(5);
                 published.unit = row.text(6);
                 published.source = row.text(7);
               });
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
