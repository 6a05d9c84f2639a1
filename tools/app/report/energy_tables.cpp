#include "tools/app/report/energy_tables.h"

#include <fmt/core.h>

#include <optional>
#include <vector>

#include "sim/base/csv_table.h"
#include "tools/app/report/text_table.h"
#include "tools/app/result/energy.h"
#include "tools/app/result/summary.h"

namespace leviosim::tools {
namespace {

using sim::Estimate;

/// "12.34" and "9.87–15.43".
template <class T>
void add_figure(std::vector<std::string>& cells, const std::optional<Estimate<T>>& figure,
                double unit) {
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

std::string energy_table(const RunResult& run, int width) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return {};
  TextTable table(
      {{"stage", kLeft}, {"call", kLeft, 1}, {"uJ of a call"}, {"band"}, {"mW"}, {"band"}});
  for (const EnergyRow& row : energy->rows) {
    std::vector<std::string> cells{name_of(row), row.unit};
    add_figure(cells, row.per_call(), 1e-6);
    add_figure(cells, row.power(), 1e-3);
    table.add(std::move(cells));
  }
  return fmt::format("energy at {:g} V, cluster {:g} MHz, controller {:g} MHz\n",
                     run.chip.supply.voltage.count(), megahertz(run.cluster_clock),
                     megahertz(run.controller_clock)) +
         table.str(width) +
         (any_on_controller(*energy) ? "¹ what the controller adds; the rest of the chip is in the "
                                       "rows of the cluster\n"
                                     : "") +
         "band: where the figure lies if the energies of the platform are within their ranges\n" +
         totals(*energy);
}

std::string power_table(const RunResult& run, int width) {
  const std::optional<RunEnergy> energy = energy_of(run);
  if (!energy) return {};
  std::vector<TextTable::Column> columns{{"stage", kLeft}};
  for (const sim::DomainInfo& info : sim::kDomains)
    columns.push_back({std::string(info.name), TextTable::Align::Right, 1});
  columns.push_back({"total"});
  TextTable table(std::move(columns));
  const auto add = [&](std::string name, const sim::DomainEnergies& energies, Seconds time) {
    std::vector<std::string> cells{std::move(name)};
    const auto cell = [&](const Estimate<Joules>& e) {
      return time > Seconds(0) ? fmt::format("{:.2f}", (e.value / time).count() * 1e3) : kNothing;
    };
    for (const sim::DomainInfo& info : sim::kDomains) cells.push_back(cell(energies[info.domain]));
    cells.push_back(cell(energies.total()));
    table.add(std::move(cells));
  };
  for (const EnergyRow& row : energy->rows) add(name_of(row), row.energy, row.time);
  add("all the time", energy->total(), energy->time);
  return "where the power goes while a stage runs [mW]\n" + table.str(width);
}

std::string operating_point_table(const RunResult& run, int width) {
  if (!energy_of(run) || run.camera || run.frames.empty()) return {};
  TextTable table({{"supply", kLeft},
                   {"clock"},
                   {"front end ms"},
                   {"mJ of a frame"},
                   {"band"},
                   {"frames/s", TextTable::Align::Right, 1},
                   {"mean mW"},
                   {"band"}});
  const sim::SupplyConfig& supply = run.chip.supply;
  for (const sim::OperatingPoint& point : {supply.lowest, supply.highest}) {
    const std::optional<RunEnergy> energy = energy_at(run, point);
    const Hertz faster = std::max(run.cluster_clock, run.controller_clock);
    const double slower = megahertz(faster) / megahertz(point.clock);
    std::vector<std::string> cells{
        fmt::format("{:g} V", point.voltage.count()),
        fmt::format("{:g} MHz", megahertz(point.clock)),
        fmt::format("{:.2f}", front_end_ms(run, run.cluster_clock) * slower)};
    add_figure(cells, energy->per_frame(), 1e-3);
    cells.push_back(
        fmt::format("{:.1f}", static_cast<double>(energy->frames) / energy->time.count()));
    add_figure(cells, energy->mean_power(), 1e-3);
    table.add(std::move(cells));
  }
  return "the same cycles at the ends of the supply\n" + table.str(width);
}

namespace {

using sim::AreaItem;

std::vector<AreaItem> rows_of(const sim::ChipConfig& chip) {
  std::vector<AreaItem> rows = sim::areas_of(chip);
  rows.push_back(sim::cluster_area(chip));
  rows.push_back(sim::total_area(chip));
  return rows;
}

std::string thousands(sim::SquareMicrometres area) {
  return fmt::format("{:.1f}", area.count() * 1e-3);
}

}  // namespace

std::string area_table(const sim::ChipConfig& chip, int width) {
  TextTable table({{"part", TextTable::Align::Left},
                   {"number", TextTable::Align::Right, 2},
                   {"kGE", TextTable::Align::Right, 1},
                   {"1000 um2"},
                   {"band"},
                   {"share %", TextTable::Align::Right, 3}});
  const std::vector<AreaItem> rows = rows_of(chip);
  const double whole = rows.back().area.count();
  for (const AreaItem& row : rows) {
    const std::string gates =
        row.gates > sim::KiloGates(0) ? fmt::format("{:.1f}", row.gates.count()) : "–";
    if (row.area == sim::SquareMicrometres(0)) {
      table.add({row.name, fmt::format("{:g}", row.count), "unknown", "–", "–", "–"});
      continue;
    }
    table.add({row.name, fmt::format("{:g}", row.count), gates, thousands(row.area),
               fmt::format("{}–{}", thousands(row.low), thousands(row.high)),
               fmt::format("{:.1f}", 100 * row.area.count() / whole)});
  }
  const bool all = rows.back().known;
  return fmt::format(
      "{}kGE: thousands of gate equivalents; memories that are part of the logic "
      "count as much logic as would have their area.\nPads, supplies, clock "
      "generators, analogue parts and non-volatile memory are not in it.{}\n",
      table.str(width),
      all ? "" : "\nThe sums leave out what is unknown: they are at least so large.");
}

std::string area_csv(const sim::ChipConfig& chip) {
  const auto um2 = [](const AreaItem& row, sim::SquareMicrometres area) {
    return base::fixed(
        row.area > sim::SquareMicrometres(0) ? std::optional(area.count()) : std::nullopt, 0);
  };
  const base::CsvTable<AreaItem> table{
      {"part", [](const AreaItem& row) { return row.name; }},
      {"number", [](const AreaItem& row) { return base::fixed(row.count, 0); }},
      {"kilo_gates", [](const AreaItem& row) { return base::fixed(row.gates.count(), 2); }},
      {"um2", [&](const AreaItem& row) { return um2(row, row.area); }},
      {"um2_low", [&](const AreaItem& row) { return um2(row, row.low); }},
      {"um2_high", [&](const AreaItem& row) { return um2(row, row.high); }},
      {"complete", [](const AreaItem& row) { return row.known ? "yes" : "no"; }}};
  return table.text(rows_of(chip));
}

}  // namespace leviosim::tools
