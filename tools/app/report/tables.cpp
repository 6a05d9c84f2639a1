#include "tools/app/report/tables.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "sim/base/printable.h"
#include "sim/chip/accelerator.h"
#include "sim/energy/area.h"
#include "tools/app/report/energy_tables.h"
#include "tools/app/report/run_summary.h"
#include "tools/app/result/energy_summary.h"
#include "tools/app/result/summary.h"
#include "tools/app/table/cell.h"
#include "tools/app/table/table.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr int kWidth = 100;

std::string kilo(std::optional<double> value, int decimals) {
  return figure_text(value ? std::optional(*value / 1000.0) : std::nullopt, decimals);
}

std::string kilobytes(Bytes bytes) { return kilo(static_cast<double>(bytes.count()), 1); }

std::string on_cores(int cores) { return cores == 1 ? "1 core" : fmt::format("{} cores", cores); }

std::string milliseconds_text(std::optional<double> cycles, Hertz clock) {
  return figure_text(cycles ? std::optional(milliseconds(*cycles, clock)) : std::nullopt, 3);
}

/// Those that are small on most chips, so that they go first where the width is short.
constexpr std::array<std::string_view, 4> kSmallColumns{"divider", "L1 banks", "sync", "DMA"};

int rank_of(std::string_view column) {
  return std::find(kSmallColumns.begin(), kSmallColumns.end(), column) == kSmallColumns.end() ? 0
                                                                                              : 1;
}

/// A column of the table of breakdowns, and the mechanisms that are added to it.
struct BreakdownColumn {
  std::string_view name;
  std::vector<sim::Mechanism> parts;

  double sum(const sim::MechanismCycles& cycles) const {
    double all = 0;
    for (const sim::Mechanism part : parts) all += cycles[part];
    return all;
  }
};

/// Those that there are on the cluster, those of lone cores first.
std::vector<BreakdownColumn> breakdown_columns(const RunResult& run) {
  std::vector<sim::MechanismInfo> infos = breakdown_parts(run);
  if (!run.timed || !sim::has_accelerators(run.chip.cluster.accelerators))
    std::erase_if(infos, [](const sim::MechanismInfo& info) {
      return info.mechanism == sim::Mechanism::Accelerator;
    });
  std::sort(infos.begin(), infos.end(), [](const auto& a, const auto& b) {
    return sim::index(a.mechanism) < sim::index(b.mechanism);
  });
  std::vector<BreakdownColumn> columns;
  for (const sim::MechanismInfo& info : infos) {
    auto it = std::find_if(columns.begin(), columns.end(),
                           [&](const BreakdownColumn& c) { return c.name == info.column; });
    if (it == columns.end()) it = columns.insert(it, {info.column, {}});
    it->parts.push_back(info.mechanism);
  }
  return columns;
}

std::vector<Cell> breakdown_cells(const std::vector<BreakdownColumn>& columns,
                                  const sim::MechanismCycles& cycles) {
  if (!(cycles.total() > 0)) return std::vector<Cell>(columns.size() + 1);
  std::vector<double> sums;
  for (const BreakdownColumn& column : columns) sums.push_back(column.sum(cycles));
  std::vector<Cell> cells;
  for (const double percent : tenths_of_percent(sums)) cells.push_back(figure_text(percent, 1));
  cells.push_back(figure_text(cycles.total() * 1e-6, 1));
  return cells;
}

/// "image 19.2", "scratch ×8 36.0", and the names of what is too small for the unit.
std::vector<std::string> block_list(const std::vector<work::Block>& blocks) {
  constexpr Bytes kShownSize{50};  // the smallest that rounds to 0.1 kB
  std::vector<std::string> items;
  std::vector<std::string> small;
  for (const BlockGroup& group : grouped(blocks)) {
    std::string name = printable(group.name);
    if (group.copies > 1) name += fmt::format(" ×{}", group.copies);
    if (group.bytes < kShownSize)
      small.push_back(std::move(name));
    else
      items.push_back(fmt::format("{} {}", name, kilobytes(group.bytes)));
  }
  if (!small.empty()) small.front() = "below 0.1: " + small.front();
  items.insert(items.end(), small.begin(), small.end());
  return items;
}

/// A row of the memory table and the blocks it stands for.
struct Occupant {
  std::string name;  ///< printable
  const char* memory;
  Bytes size;  ///< of the memory
  std::optional<Bytes> single;
  std::optional<Bytes> parallel;
  const std::vector<work::Block>* blocks;
};

std::vector<Occupant> occupants(const RunResult& run) {
  std::vector<Occupant> all;
  for (const StageResult& stage : run.stages) {
    if (stage.on_controller) continue;  // its memory is L2, below
    Occupant row{printable(stage.name), "L1", run.l1_size, {}, {}, &stage.memory.blocks};
    if (stage.calls > 0) {
      row.single = stage.memory.single;
      row.parallel = stage.memory.parallel;
    }
    all.push_back(row);
  }
  for (const L2Row& part : run.l2)
    all.push_back({printable(part.name), "L2", run.l2_size, part.bytes, {}, &part.blocks});
  for (const L2Row& part : run.external)
    all.push_back(
        {printable(part.name), "external", run.external_size, part.bytes, {}, &part.blocks});
  return all;
}

std::string blocks_at_peak(const std::vector<Occupant>& rows, int width) {
  int indent = 0;
  for (const Occupant& row : rows) indent = std::max(indent, display_width(row.name) + 4);
  std::string text = "blocks alive at the peak [kB]\n";
  for (const Occupant& row : rows) {
    const std::vector<std::string> items = block_list(*row.blocks);
    const int padding = indent - 2 - display_width(row.name);
    text += fmt::format("  {}{}{}\n", row.name, std::string(static_cast<std::size_t>(padding), ' '),
                        items.empty() ? kNothing : wrap(items, " · ", indent, width));
  }
  return text;
}

struct NamedTable {
  std::string_view name;
  bool is_of_chip;  ///< and absent from native runs
  std::string (*text)(const RunResult& run, int width);
};

/// In the order in which they are printed.
constexpr std::array kTables{
    NamedTable{"stages", true, stage_table},
    NamedTable{"breakdown", true, breakdown_table},
    NamedTable{"latency", true, latency_table},
    NamedTable{"camera", true, [](const RunResult& run, int) { return camera_summary(run); }},
    NamedTable{"memory", true, memory_table},
    NamedTable{"energy", true, energy_table},
    NamedTable{"power", true, power_table},
    NamedTable{"supply", true, operating_point_table},
    NamedTable{"frames", false, [](const RunResult& run, int) { return frame_summary(run); }},
    NamedTable{"trajectory", false,
               [](const RunResult& run, int) { return trajectory_summary(run); }},
};

using sim::Estimate;

/// "12.34" and "9.87–15.43".
template <class T>
void add_figure(std::vector<Cell>& cells, const std::optional<Estimate<T>>& figure, double unit) {
  if (!figure) {
    cells.insert(cells.end(), {kNothing, kNothing});
    return;
  }
  cells.push_back(fmt::format("{:.2f}", figure->value.count() / unit));
  cells.push_back(
      fmt::format("{:.2f}–{:.2f}", figure->low().count() / unit, figure->high().count() / unit));
}

template <class T>
std::string in_words(const std::optional<Estimate<T>>& figure, double unit, const char* name) {
  if (!figure) return kNothing;
  return fmt::format("{:.2f} {} ({:.2f}–{:.2f})", figure->value.count() / unit, name,
                     figure->low().count() / unit, figure->high().count() / unit);
}

std::string name_of(const EnergyRow& row) { return row.on_controller ? row.name + " ¹" : row.name; }

bool any_on_controller(const RunEnergy& energy) {
  for (const EnergyRow& row : energy.rows)
    if (row.on_controller) return true;
  return false;
}

std::string totals(const RunEnergy& energy) {
  const double rate = static_cast<double>(energy.frames) / energy.time.count();
  const auto per_frame = energy.per_frame();
  const bool small = per_frame && per_frame->value < Joules(1e-4);
  std::string text = fmt::format(
      "per frame {}; mean power at {:.1f} frames/s {}\nwhile the front end runs {}",
      in_words(per_frame, small ? 1e-6 : 1e-3, small ? "uJ" : "mJ"), energy.frames > 0 ? rate : 0.0,
      in_words(energy.mean_power(), 1e-3, "mW"), in_words(energy.power_of_front_end(), 1e-3, "mW"));
  if (any_on_controller(energy))
    text += fmt::format("; while the optimiser runs, it adds {}",
                        in_words(energy.power_of_controller(), 1e-3, "mW"));
  return text + '\n';
}

/// Milliseconds that the front end takes for a frame, on average.
double front_end_ms(const RunResult& run, Hertz cluster_clock) {
  Cycles cycles;
  for (const FrameResult& frame : run.frames) cycles += frame.cycles;
  return milliseconds(static_cast<double>(cycles.count()), cluster_clock) /
         static_cast<double>(run.frames.size());
}

}  // namespace

std::vector<double> tenths_of_percent(const std::vector<double>& parts) {
  const double total = std::accumulate(parts.begin(), parts.end(), 0.0);
  std::vector<double> tenths(parts.size(), 0.0);
  if (!(total > 0)) return tenths;
  std::vector<std::size_t> by_remainder(parts.size());
  std::iota(by_remainder.begin(), by_remainder.end(), std::size_t{0});
  const auto exact = [&](std::size_t i) { return 1000.0 * parts[i] / total; };
  for (const std::size_t i : by_remainder) tenths[i] = std::floor(exact(i));
  std::stable_sort(by_remainder.begin(), by_remainder.end(), [&](std::size_t a, std::size_t b) {
    return exact(a) - tenths[a] > exact(b) - tenths[b];
  });
  double missing = 1000.0 - std::accumulate(tenths.begin(), tenths.end(), 0.0);
  for (std::size_t k = 0; missing > 0 && k < by_remainder.size(); ++k, --missing)
    ++tenths[by_remainder[k]];
  for (double& value : tenths) value /= 10.0;
  return tenths;
}

Table stages_of(const RunResult& run, const std::vector<const StageResult*>& stages,
                std::string_view mark_of_controller) {
  using S = const StageResult* const&;
  // Of a workload whose stages all take less than half a millisecond, microseconds.
  const bool is_small = std::all_of(stages.begin(), stages.end(), [&](S s) {
    constexpr double kSmall_ms = 0.5;
    return milliseconds(mean(s->parallel, s->calls).value_or(0), clock_of(run, *s)) < kSmall_ms;
  });
  const auto in_time = [&, is_small](S s, std::optional<double> cycles) {
    if (!cycles || !is_small) return milliseconds_text(cycles, clock_of(run, *s));
    return figure_text(1e3 * milliseconds(*cycles, clock_of(run, *s)), 2);
  };
  const std::string unit = is_small ? "µs" : "ms";
  return table_of(
      Columns<const StageResult*>{
          {{"stage", kLeft},
           [&](S s) { return s->name + std::string(s->on_controller ? mark_of_controller : ""); }},
          {{"call", kLeft, 3}, [](S s) { return s->unit; }},
          {{"calls", kRight, 2}, [](S s) { return s->calls; }},
          {{"kcycles, 1 core"}, [](S s) { return kilo(mean(s->single, s->calls), 2); }},
          {{"kcycles, " + on_cores(run.cores)},
           [](S s) { return kilo(mean(s->parallel, s->calls), 2); }},
          {{"speed-up"}, [](S s) { return figure_text(speedup(*s), 2); }},
          {{unit}, [&](S s) { return in_time(s, mean(s->parallel, s->calls)); }},
          {{"worst " + unit, kRight, 1},
           [&](S s) { return in_time(s, mean(s->worst_parallel, s->calls > 0 ? 1 : 0)); }}},
      stages);
}

std::string unmeasured_note(const RunResult& run) {
  constexpr double kWorthMentioning = 0.01;
  std::vector<std::string> shares;
  for (const StageResult& stage : run.stages)
    if (const auto share = unmeasured_share(stage); share && *share >= kWorthMentioning)
      shares.push_back(fmt::format("{:.0f} % of {}", 100 * *share, stage.name));
  if (shares.empty()) return "";
  return fmt::format(
      "not measured as compiled code, taken as counted (isa.unmeasured_instructions): {}\n",
      fmt::join(shares, ", "));
}

std::string stage_table(const RunResult& run, int width) {
  std::vector<const StageResult*> all;
  for (const StageResult& stage : run.stages) all.push_back(&stage);
  const bool any_on_controller = std::any_of(run.stages.begin(), run.stages.end(),
                                             [](const StageResult& s) { return s.on_controller; });
  return fmt::format("stages (mean of a call; times on {})\n", on_cores(run.cores)) +
         terminal_text(stages_of(run, all, " ¹"), width) +
         (run.cores == 1 ? ""
                         : "1 core: this program on the master alone (--cores 1: the program for "
                           "one core)\n") +
         (any_on_controller ? "¹ on the fabric controller, which is one core\n" : "") +
         unmeasured_note(run);
}

std::string breakdown_table(const RunResult& run, int width) {
  std::vector<Head> columns{{"stage", kLeft}};
  const std::vector<BreakdownColumn> parts = breakdown_columns(run);
  for (const BreakdownColumn& part : parts)
    columns.push_back({std::string(part.name), kRight, rank_of(part.name)});
  columns.push_back({"core-Mcycles", kRight, 2});
  Table table(std::move(columns));
  for (const StageResult& stage : run.stages) {
    if (stage.on_controller) continue;
    std::vector<Cell> cells = breakdown_cells(parts, stage.account.team);
    cells.insert(cells.begin(), stage.name);
    table.add(std::move(cells));
  }
  return fmt::format("where the core-cycles go on {} [%]\n", on_cores(run.cores)) +
         terminal_text(table, width) +
         "serial: the team idles while the master works alone; all others but useful: waiting for "
         "it\n";
}

std::string memory_table(const RunResult& run, int width) {
  using O = const Occupant&;
  const auto kb = [](std::optional<Bytes> b) { return b ? kilobytes(*b) : kNothing; };
  const auto percent = [](O o, std::optional<Bytes> b) {
    return b ? figure_text(
                   100.0 * static_cast<double>(b->count()) / static_cast<double>(o.size.count()), 2)
             : kNothing;
  };
  const Columns<Occupant> table{
      {{"peak", kLeft}, [](O o) { return o.name; }},
      {{"memory", kLeft}, [](O o) { return o.memory; }},
      {{"kB, 1 core"}, [=](O o) { return kb(o.single); }},
      {{"kB, " + on_cores(run.cores)}, [=](O o) { return kb(o.parallel); }},
      {{"%, 1 core"}, [=](O o) { return percent(o, o.single); }},
      {{"%, " + on_cores(run.cores)}, [=](O o) { return percent(o, o.parallel); }}};
  const std::vector<Occupant> rows = occupants(run);
  return fmt::format("memory (kB of 1000 bytes, % of {} kB L1 and {} kB L2)\n",
                     kilobytes(run.l1_size), kilobytes(run.l2_size)) +
         terminal_text(table_of(table, rows), width) +
         blocks_at_peak(rows, std::min(width, kWidth));
}

std::vector<std::string> table_names() {
  std::vector<std::string> names;
  for (const NamedTable& table : kTables) names.emplace_back(table.name);
  return names;
}

std::string report(const RunResult& run, const std::vector<std::string>& names, int width) {
  const auto is_wanted = [&](std::string_view name) {
    return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
  };
  std::string text;
  for (const NamedTable& table : kTables) {
    if (!is_wanted(table.name) || (table.is_of_chip && !run.timed)) continue;
    if (const std::string lines = table.text(run, width); !lines.empty())
      text += lines + (table.is_of_chip ? "\n" : "");
  }
  return text + host_line(run) + map_warning(run);
}

std::string energy_table(const RunResult& run, int width) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return {};
  Table table({{"stage", kLeft}, {"call", kLeft, 1}, {"uJ of a call"}, {"band"}, {"mW"}, {"band"}});
  for (const EnergyRow& row : energy->rows) {
    std::vector<Cell> cells{name_of(row), row.unit};
    add_figure(cells, row.per_call(), 1e-6);
    add_figure(cells, row.power(), 1e-3);
    table.add(std::move(cells));
  }
  return fmt::format("energy at {:g} V, cluster {:g} MHz, controller {:g} MHz\n",
                     run.chip.supply.voltage.count(), megahertz(run.cluster_clock),
                     megahertz(run.controller_clock)) +
         terminal_text(table, width) +
         (any_on_controller(*energy) ? "¹ what the controller adds; the rest of the chip is in the "
                                       "rows of the cluster\n"
                                     : "") +
         "band: where the figure lies if the energies of the platform are within their ranges\n" +
         totals(*energy);
}

std::string power_table(const RunResult& run, int width) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return {};
  std::vector<Head> columns{{"stage", kLeft}};
  const sim::DomainEnergies total = energy->total();
  const auto domains = sim::domains_of(total);
  for (const sim::DomainInfo& info : domains)
    columns.push_back({std::string(info.name), kRight, 1});
  columns.push_back({"total"});
  Table table(std::move(columns));
  const auto add = [&](std::string name, const sim::DomainEnergies& energies, Seconds time) {
    std::vector<Cell> cells{std::move(name)};
    const auto cell = [&](const Estimate<Joules>& e) {
      return time > Seconds(0) ? fmt::format("{:.2f}", (e.value / time).count() * 1e3) : kNothing;
    };
    for (const sim::DomainInfo& info : domains) cells.push_back(cell(energies[info.domain]));
    cells.push_back(cell(energies.total()));
    table.add(std::move(cells));
  };
  for (const EnergyRow& row : energy->rows) add(name_of(row), row.energy, row.time);
  add("all the time", total, energy->time);
  return "where the power goes while a stage runs [mW]\n" + terminal_text(table, width);
}

std::string operating_point_table(const RunResult& run, int width) {
  if (!energy_of(run) || run.camera || run.frames.empty()) return {};
  Table table({{"supply", kLeft},
               {"clock"},
               {"front end ms"},
               {"mJ of a frame"},
               {"band"},
               {"frames/s", kRight, 1},
               {"mean mW"},
               {"band"}});
  const sim::SupplyConfig& supply = run.chip.supply;
  for (const sim::OperatingPoint& point : {supply.lowest, supply.highest}) {
    const std::optional<RunEnergy> energy = energy_at(run, point);
    const Hertz faster = std::max(run.cluster_clock, run.controller_clock);
    const double slower = megahertz(faster) / megahertz(point.clock);
    std::vector<Cell> cells{fmt::format("{:g} V", point.voltage.count()),
                            fmt::format("{:g} MHz", megahertz(point.clock)),
                            fmt::format("{:.2f}", front_end_ms(run, run.cluster_clock) * slower)};
    add_figure(cells, energy->per_frame(), 1e-3);
    cells.push_back(
        fmt::format("{:.1f}", static_cast<double>(energy->frames) / energy->time.count()));
    add_figure(cells, energy->mean_power(), 1e-3);
    table.add(std::move(cells));
  }
  return "the same cycles at the ends of the supply\n" + terminal_text(table, width);
}

}  // namespace leviosim::tools
