#include "tools/app/report/area_table.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "sim/energy/area.h"
#include "tools/app/table/cell.h"
#include "tools/app/table/table.h"
#include "tools/app/table/terminal_table.h"

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
  Table table({{"part", kLeft},
               {"number", kRight, 2},
               {"kGE", kRight, 1},
               {"1000 um2"},
               {"band"},
               {"share %", kRight, 3}});
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
      terminal_text(table, width),
      all ? "" : "\nThe sums leave out what is unknown: they are at least so large.");
}

Table area_rows(const sim::ChipConfig& chip) {
  using A = const AreaItem&;
  const auto um2 = [](A row, sim::SquareMicrometres area) {
    return row.area > sim::SquareMicrometres(0) ? Cell(area.count()) : Cell();
  };
  return table_of(
      Columns<AreaItem>{
          {{.key = "part"}, [](A row) { return row.name; }},
          {{.key = "number", .decimals = 0}, [](A row) { return row.count; }},
          {{.key = "kilo_gates", .decimals = 2}, [](A row) { return row.gates.count(); }},
          {{.key = "um2", .decimals = 0}, [&](A row) { return um2(row, row.area); }},
          {{.key = "um2_low", .decimals = 0}, [&](A row) { return um2(row, row.low); }},
          {{.key = "um2_high", .decimals = 0}, [&](A row) { return um2(row, row.high); }},
          {{.key = "complete"}, [](A row) { return row.known ? "yes" : "no"; }}},
      rows_of(chip));
}

}  // namespace leviosim::tools
