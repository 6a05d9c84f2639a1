#include "tools/app/validation/microbench/bench.h"

#include <fmt/format.h>

#include "sim/base/csv.h"
#include "sim/base/interruption.h"
#include "sim/chip/chip.h"
#include "sim/chip/timing.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/microbench/microbench_report.h"
#include "tools/app/validation/microbench/microbench_row.h"
#include "tools/app/validation/microbench/reference_rows.h"
#include "tools/app/validation/published_files.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kStage = "benchmark";

work::MachineConfig machine_of(const sim::ChipConfig& chip, int workers,
                               const work::CodeMap* code) {
  return {.cores = workers,
          .memory = "L1",
          .capacity = chip.cluster.l1.size,
          .alignment = 4,
          .record = true,
          .code = code};
}

const std::vector<std::string> kColumns = {"group",     "name",           "cores",     "unit",
                                           "reference", "reference_high", "tolerance", "source"};
const std::vector<std::string> kGuardColumns = {"group", "name",  "cores",
                                                "unit",  "guard", "reason"};

std::string number(double value) { return fmt::format("{:.5g}", value); }

std::string reference_of(const MicrobenchRow& row) {
  if (row.reference == row.reference_high) return number(row.reference);
  return fmt::format("{} … {}", number(row.reference), number(row.reference_high));
}

/// With a mark where the reference lies outside.
std::string band_of(const MicrobenchRow& row) {
  if (!row.band) return {};
  return fmt::format("{} … {}{}", number(row.band->low), number(row.band->high),
                     row.is_inside() ? "" : " !");
}

std::string error_of(const MicrobenchRow& row) {
  return fmt::format("{:+.1f}{}", 100 * row.error(), row.met() ? "" : " !");
}

/// Empty unless the row is worse than it may be.
std::string warning_of(const MicrobenchRow& row) {
  if (row.verdict() != Verdict::Worse) return {};
  return fmt::format("warning: {}, {}, cores {}: error {:+.1f} %, beyond its {} of {:g} %\n",
                     row.group, row.name, row.cores, 100 * row.error(),
                     row.guard ? "guard" : "tolerance", 100 * row.guard.value_or(row.tolerance));
}

const Columns<MicrobenchRow>& shown_columns() {
  using R = const MicrobenchRow&;
  static const Columns<MicrobenchRow> table{
      {{"", kLeft}, [](R r) { return r.name; }},
      {{"cores"}, [](R r) { return r.cores; }},
      {{"unit", kLeft, 1}, [](R r) { return r.unit; }},
      {{"reference"}, [](R r) { return reference_of(r); }},
      {{"simulated"}, [](R r) { return number(r.simulated); }},
      {{"band", kRight, 1}, [](R r) { return band_of(r); }},
      {{"error %"}, [](R r) { return error_of(r); }},
      {{"source", kLeft, 2}, [](R r) { return r.source; }}};
  return table;
}

}  // namespace

sim::ChipConfig as_assembly(sim::ChipConfig chip, double loads_used_at_once) {
  for (sim::CoreConfig* core : {&chip.cluster.core, &chip.controller.core})
    core->load_use_fraction = loads_used_at_once;
  chip.cluster.fpu.collisions = 0;
  chip.cluster.l1.stream_conflicts = 0;
  return chip;
}

Bench::Bench(const sim::ChipConfig& chip, int cores, const work::CodeMap* code)
    : config_(chip),
      with_master_(cores > chip.cluster.workers),
      workers_(std::min(cores, chip.cluster.workers)),
      machine_(machine_of(chip, workers_, code)) {}

sim::StageTiming Bench::time(const work::Job& job) const {
  sim::Chip chip(config_, workers_);
  sim::JobTiming timing;
  const auto body = [&]() -> sim::Process { timing = co_await chip.cluster().run(job); };
  chip.kernel().spawn(std::string(kStage), body());
  chip.kernel().run();
  return timing.stages.at(0);
}

sim::StageTiming Bench::fork(const std::function<void(work::Core&)>& body) {
  return run([&](work::Machine& machine) {
    if (with_master_)
      machine.fork_with_master("stream", body);
    else
      machine.fork("stream", body);
  });
}

work::Job Bench::record(const std::function<void(work::Machine&)>& body) {
  throw_if_interrupted();
  {
    const auto stage = machine_.stage(kStage);
    body(machine_);
  }
  return machine_.take_job();
}

sim::StageTiming Bench::run(const std::function<void(work::Machine&)>& body) {
  return time(record(body));
}

double Bench::controller_seconds(const std::function<void(work::Machine&)>& body) {
  throw_if_interrupted();
  work::Machine machine({.cores = 1,
                         .memory = "L2",
                         .capacity = config_.l2.size,
                         .record = true,
                         .external = config_.controller.external.size});
  {
    const auto stage = machine.stage(kStage);
    body(machine);
  }
  const work::Job job = machine.take_job();
  sim::Chip chip(config_, workers_);
  sim::JobTiming timing;
  const auto process = [&]() -> sim::Process { timing = co_await chip.control(job); };
  chip.kernel().spawn(std::string(kStage), process());
  chip.kernel().run();
  return static_cast<double>(timing.stages.at(0).cycles.count()) /
         static_cast<double>(config_.controller.clock.count());
}

double Bench::offload_cycles() {
  sim::Chip chip(config_, workers_);
  sim::JobTiming timing;
  const work::Job empty;
  const auto body = [&]() -> sim::Process { timing = co_await chip.offload(empty); };
  chip.kernel().spawn(std::string(kStage), body());
  chip.kernel().run();
  return static_cast<double>(
      chip.controller().clock().whole_cycles(timing.end - timing.begin).count());
}

double stream_cycles(const sim::ChipConfig& chip, int cores, int slots,
                     const std::function<void(work::Core&)>& body) {
  Bench bench(chip, cores);
  const double empty = static_cast<double>(bench.fork([](work::Core&) {}).cycles.count());
  return (static_cast<double>(bench.fork(body).cycles.count()) - empty) / slots;
}

std::vector<MicrobenchRow> reference_rows(const std::string& file, std::string_view text,
                                          int tier) {
  std::vector<MicrobenchRow> rows;
  for_each_row(file, text, kColumns, [&](const base::CsvRow& row) {
    MicrobenchRow& r = rows.emplace_back();
    r.group = row.text(0);
    r.name = row.text(1);
    r.cores = static_cast<int>(row.number(2));
    r.unit = row.text(3);
    r.reference = row.number(4);
    r.reference_high = row.text(5).empty() ? r.reference : row.number(5);
    r.tolerance = row.number(6);
    r.source = row.text(7);
    r.tier = tier;
  });
  return rows;
}

void take_guards(const std::string& file, std::string_view text, std::vector<MicrobenchRow>& rows) {
  for_each_row(file, text, kGuardColumns, [&](const base::CsvRow& guard) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const MicrobenchRow& r) {
      return r.group == guard.text(0) && r.name.substr(0, r.name.find(',')) == guard.text(1) &&
             r.cores == guard.number(2) && r.unit == guard.text(3);
    });
    if (row == rows.end()) guard.fail(1, "no row of the comparison");
    row->guard = guard.number(4);
    if (!(*row->guard > row->tolerance)) guard.fail(4, "no more than the tolerance of the row");
  });
}

double mean_error(const std::vector<MicrobenchRow>& rows) {
  double sum = 0;
  for (const MicrobenchRow& row : rows) sum += std::abs(row.error());
  return rows.empty() ? 0 : sum / static_cast<double>(rows.size());
}

std::string microbench_table(std::string_view chip, const std::vector<MicrobenchRow>& rows) {
  std::string text;
  const auto met =
      std::count_if(rows.begin(), rows.end(), [](const MicrobenchRow& row) { return row.met(); });
  for (auto begin = rows.begin(); begin != rows.end();) {
    const auto end = std::find_if(
        begin, rows.end(), [&](const MicrobenchRow& row) { return row.group != begin->group; });
    text += fmt::format("{}\n{}\n", begin->group,
                        terminal_text(table_of(shown_columns(), std::span(begin, end))));
    begin = end;
  }
  text += fmt::format("{}: {} of {} rows within their tolerance, mean absolute error {:.1f} %\n",
                      chip, met, rows.size(), 100 * mean_error(rows));
  for (const MicrobenchRow& row : rows) text += warning_of(row);
  return text;
}

std::string coverage_text(const std::vector<MicrobenchRow>& rows,
                          const std::vector<double>& needed) {
  std::vector<Banded> bands;
  int inside = 0;
  for (const MicrobenchRow& row : rows) {
    if (row.band) bands.push_back(*row.band);
    inside += row.is_inside() ? 1 : 0;
  }
  const auto at = [&](double share) {
    return needed[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(needed.size() - 1)))];
  };
  std::string text = fmt::format(
      "published cycles of kernels: {} of {} lie inside the band that the platform's ranges "
      "leave;\nits median half width is {:.1f} %\n",
      inside, bands.size(), median_half_width(bands));
  if (needed.empty()) return text;
  return text +
         fmt::format(
             "isa.unmeasured_instructions with which one core takes what is published: "
             "{:.2f} to {:.2f} for\n{} kernels, median {:.2f}, the middle four fifths {:.2f} "
             "to {:.2f}\n",
             needed.front(), needed.back(), needed.size(), at(0.5), at(0.1), at(0.9));
}

std::string microbench_conclusion(const std::vector<MicrobenchRow>& rows) {
  std::string worse;
  std::size_t met = 0;
  for (const MicrobenchRow& row : rows) {
    met += row.met();
    if (worse.empty() && row.verdict() == Verdict::Worse)
      worse = fmt::format("{}, {}, cores {}: error {:+.1f} %", row.group, row.name, row.cores,
                          100 * row.error());
  }
  const std::string text = fmt::format("{} of {} rows within their tolerance", met, rows.size());
  return worse.empty() ? fmt::format("verdict: met: {}, no other beyond its guard", text)
                       : fmt::format("verdict: NOT met: {}; {}", text, worse);
}

Table microbench_rows(const std::vector<MicrobenchRow>& rows) {
  using R = MicrobenchRow;
  return table_of(
      Columns<R>{{{.key = "group"}, [](const R& r) { return r.group; }},
                 {{.key = "name"}, [](const R& r) { return r.name; }},
                 {{.key = "cores"}, [](const R& r) { return r.cores; }},
                 {{.key = "unit"}, [](const R& r) { return r.unit; }},
                 {{.key = "reference"}, [](const R& r) { return r.reference; }},
                 {{.key = "reference_high"}, [](const R& r) { return r.reference_high; }},
                 {{.key = "simulated"}, [](const R& r) { return r.simulated; }},
                 {{.key = "low"}, [](const R& r) { return r.band ? Cell(r.band->low) : Cell(); }},
                 {{.key = "high"}, [](const R& r) { return r.band ? Cell(r.band->high) : Cell(); }},
                 {{.key = "error"}, [](const R& r) { return r.error(); }},
                 {{.key = "tolerance"}, [](const R& r) { return r.tolerance; }},
                 {{.key = "guard"}, [](const R& r) { return r.guard; }},
                 {{.key = "verdict"}, [](const R& r) { return name_of(r.verdict()); }},
                 {{.key = "tier"}, [](const R& r) { return r.tier; }},
                 {{.key = "source"}, [](const R& r) { return r.source; }}},
      rows);
}

}  // namespace leviosim::tools
