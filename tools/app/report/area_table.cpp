#include "tools/app/report/area_table.h"

#include <fmt/core.h>

#include <optional>
#include <vector>

#include "sim/base/csv_table.h"

namespace leviosim::tools {
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
