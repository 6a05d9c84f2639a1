#include "tools/app/study/feasibility/feasibility_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "tools/app/study/feasibility/feasibility.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/references.h"

namespace leviosim::tools {
namespace {

/// Time of a frame of LEVIO in its paper, on GAP9 at 370 MHz (validate/references.h).
struct Published {
  int cores;
  std::string_view reference;
  int decimals;
  std::string_view about;  ///< the paper says so in round numbers
};

constexpr std::array<Published, 2> kPublished = {
    {{8, "latency.epnp", 1, ""}, {1, "latency.single_core", 0, "≈ "}}};

constexpr std::array<std::string_view, 2> kPublishedOn = {"gap9", "gap9-370mhz"};

std::string published(const Feasibility& row) {
  if (std::find(kPublishedOn.begin(), kPublishedOn.end(), row.platform) == kPublishedOn.end())
    return {};
  for (const Published& p : kPublished)
    for (const Reference& reference : paper_references())
      if (p.cores == row.cores && p.reference == reference.name)
        return fmt::format("{}{:.{}f}", p.about, reference.value, p.decimals);
  return {};
}

std::string missing(const char* memory, const MemoryVerdict& verdict) {
  return fmt::format("{} kB short of {} at '{}'",
                     ((verdict.occupied - verdict.size).count() + 999) / 1000, memory,
                     verdict.block);
}

template <class Unit>
std::string banded(const std::optional<sim::Estimate<Unit>>& e, double scale, int decimals) {
  if (!e) return "–";
  return fmt::format("{:.{}f} ({:.{}f}–{:.{}f})", e->value.count() * scale, decimals,
                     e->low().count() * scale, decimals, e->high().count() * scale, decimals);
}

}  // namespace

std::string memory_verdict(const Feasibility& row) {
  if (!row.failure.empty()) return row.failure;
  if (row.fits()) {
    std::string text = "fits";
    if (row.in_tiles) text += ", in tiles through L1";
    if (row.external > Bytes(0))
      text += fmt::format(", {} kB in external memory", (row.external.count() + 999) / 1000);
    return text;
  }
  if (row.l1.fits()) return missing("L2", row.l2);
  if (row.l2.fits()) return missing("L1", row.l1);
  return missing("L1", row.l1) + "; " + missing("L2", row.l2);
}

std::string feasibility_table(const std::vector<Feasibility>& rows) {
  using F = const Feasibility&;
  // A star where the chip does not have the memory.
  const auto marked = [](double value, F f) {
    if (!f.failure.empty()) return std::string(kNothing);
    return fmt::format("{:.1f}{}", value, f.fits() ? "" : "*");
  };
  std::string text = terminal_text(table_of(
      Columns<Feasibility>{
          {{"chip", kLeft}, [](F f) { return f.platform; }},
          {{"cores", kRight, 1}, [](F f) { return f.cores; }},
          {{"MHz"},
           [](F f) {
             return f.failure.empty() ? fmt::format("{:g}", megahertz(f.clock)) : kNothing;
           }},
          {{"frame ms"}, [=](F f) { return marked(f.front_end_ms, f); }},
          {{"worst", kRight, 1}, [=](F f) { return marked(f.worst_ms, f); }},
          {{"published", kRight, 2}, [](F f) { return published(f); }},
          {{"optimiser ms", kRight, 2}, [=](F f) { return marked(f.optimiser_ms, f); }},
          {{"frames/s"}, [=](F f) { return marked(f.frames_per_second(), f); }},
          {{"mJ/frame"}, [](F f) { return banded(f.energy_per_frame, 1e3, 2); }},
          {{"mW", kRight, 1}, [](F f) { return banded(f.power, 1e3, 1); }},
          {{"memory", kLeft}, [](F f) { return memory_verdict(f); }}},
      rows));
  text +=
      "frame: front end, mean and worst; optimiser: per frame. A chip with one core does one after "
      "the other, others both at once\n"
      "energy and mean power, with bands, at the rate that the chip keeps up with, at most the "
      "camera's\n";
  if (std::any_of(rows.begin(), rows.end(), [](F f) { return f.failure.empty() && !f.fits(); }))
    text += "* if it had the memory: times and energy of the same work, as though all had fitted\n";
  return text;
}

std::string feasibility_conclusion(const std::vector<Feasibility>& rows) {
  const Feasibility* fastest = nullptr;
  std::size_t fit = 0;
  for (const Feasibility& row : rows) {
    if (!row.fits()) continue;
    ++fit;
    if (fastest == nullptr || row.frame_ms() < fastest->frame_ms()) fastest = &row;
  }
  if (fastest == nullptr)
    return fmt::format("verdict: does not fit: {}: {}", rows.front().platform,
                       memory_verdict(rows.front()));
  return fmt::format(
      "{} rows have the memory; the fastest of them, {} with {} {}, does {:.1f} "
      "frames/s",
      fit == rows.size() ? fmt::format("verdict: fits: all {}", fit)
                         : fmt::format("in short: {} of {}", fit, rows.size()),
      fastest->platform, fastest->cores, fastest->cores == 1 ? "core" : "cores",
      fastest->frames_per_second());
}

std::string stage_comparison(const std::vector<Feasibility>& rows) {
  std::vector<Head> columns{{"kilocycles of a call", kLeft}};
  for (const Feasibility& row : rows) columns.push_back({row.platform});
  Table table(std::move(columns));
  const auto add = [&](const std::string& name, int decimals, auto&& of) {
    std::vector<Cell> cells{name};
    for (const Feasibility& row : rows) {
      const std::string value = figure_text(of(row), decimals);
      cells.push_back(&row == &rows.front()
                          ? value
                          : fmt::format("{} (×{:.2f})", value, of(rows.front()) / of(row)));
    }
    table.add(std::move(cells));
  };
  for (std::size_t i = 0; i < rows.front().stages.size(); ++i)
    add(rows.front().stages[i].name, 1,
        [&](const Feasibility& row) { return row.stages[i].kilocycles; });
  add("frame ms", 2, [](const Feasibility& row) { return row.front_end_ms; });
  add("worst frame ms", 2, [](const Feasibility& row) { return row.worst_ms; });
  if (rows.front().energy_per_frame)
    add("mJ/frame", 3, [](const Feasibility& row) {
      return row.energy_per_frame ? row.energy_per_frame->value.count() * 1e3 : 0.0;
    });
  const auto add_memory = [&](const char* name, MemoryVerdict Feasibility::*memory) {
    constexpr double kKilo = 1e-3;
    std::vector<Cell> cells{name};
    for (const Feasibility& row : rows)
      cells.push_back(fmt::format("{:.1f} of {:.1f}",
                                  kKilo * static_cast<double>((row.*memory).occupied.count()),
                                  kKilo * static_cast<double>((row.*memory).size.count())));
    table.add(std::move(cells));
  };
  add_memory("L1 peak kB", &Feasibility::l1);
  add_memory("L2 peak kB", &Feasibility::l2);
  return terminal_text(table);
}

Table stage_comparison_rows(const std::vector<Feasibility>& rows) {
  struct Row {
    const Feasibility& chip;
    const StageTime& stage;
  };
  std::vector<Row> all;
  for (const Feasibility& chip : rows)
    for (const StageTime& stage : chip.stages) all.push_back({chip, stage});
  return table_of(
      Columns<Row>{{{.key = "platform"}, [](const Row& row) { return row.chip.platform; }},
                   {{.key = "cores"}, [](const Row& row) { return row.chip.cores; }},
                   {{.key = "stage"}, [](const Row& row) { return row.stage.name; }},
                   {{.key = "kilocycles"}, [](const Row& row) { return row.stage.kilocycles; }}},
      all);
}

Table feasibility_rows(const std::vector<Feasibility>& rows) {
  using F = const Feasibility&;
  Columns<Feasibility> columns{{{.key = "platform"}, [](F f) { return f.platform; }},
                               {{.key = "cores"}, [](F f) { return f.cores; }},
                               {{.key = "clock_hz"}, [](F f) { return f.clock; }},
                               {{.key = "front_end_ms"}, [](F f) { return f.front_end_ms; }},
                               {{.key = "worst_ms"}, [](F f) { return f.worst_ms; }},
                               {{.key = "published_ms"}, [](F f) { return published(f); }},
                               {{.key = "optimiser_ms"}, [](F f) { return f.optimiser_ms; }},
                               {{.key = "frames_per_s"}, [](F f) {
                                  return f.failure.empty() ? Cell(f.frames_per_second()) : Cell();
                                }}};
  const auto add_end = [&](const char* key, auto figure, auto end) {
    columns.push_back({{.key = key}, [=](F f) {
                         return f.*figure ? Cell(std::invoke(end, *(f.*figure)).count()) : Cell();
                       }});
  };
  using Energy = sim::Estimate<Joules>;
  using Power = sim::Estimate<Watts>;
  add_end("energy_per_frame_j", &Feasibility::energy_per_frame, &Energy::value);
  add_end("energy_low_j", &Feasibility::energy_per_frame, &Energy::low);
  add_end("energy_high_j", &Feasibility::energy_per_frame, &Energy::high);
  add_end("power_w", &Feasibility::power, &Power::value);
  add_end("power_low_w", &Feasibility::power, &Power::low);
  add_end("power_high_w", &Feasibility::power, &Power::high);
  columns.push_back({{.key = "fits"}, [](F f) { return f.fits(); }});
  const auto add_memory = [&](const std::string& name, MemoryVerdict Feasibility::*of) {
    columns.push_back({{.key = name + "_bytes"}, [=](F f) { return (f.*of).occupied; }});
    columns.push_back({{.key = name + "_size"}, [=](F f) { return (f.*of).size; }});
    columns.push_back({{.key = name + "_block"}, [=](F f) { return (f.*of).block; }});
  };
  add_memory("l1", &Feasibility::l1);
  add_memory("l2", &Feasibility::l2);
  columns.push_back({{.key = "failure"}, [](F f) { return f.failure; }});
  return table_of(columns, rows);
}

}  // namespace leviosim::tools
