#include "tools/app/study/systems/systems_report.h"

#include <fmt/format.h>

#include "sim/base/csv_table.h"
#include "tools/app/report/number_text.h"
#include "tools/app/report/text_table.h"

namespace leviosim::tools {
namespace {

/// Three digits, or all before the point.
std::string digits(double value) {
  return value < 1000 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

std::string number(const std::optional<double>& value, bool is_bound = false) {
  return value ? (is_bound ? "< " : "") + digits(*value) : kNothing;
}

/// "30.2 (19.1–39.4)", in thousandths of the unit.
template <class Unit>
std::string banded(const std::optional<sim::Estimate<Unit>>& e) {
  if (!e) return kNothing;
  const auto text = [](Unit value) { return digits(value.count() * kMilli); };
  return fmt::format("{} ({}–{})", text(e->value), text(e->low()), text(e->high()));
}

std::string model_of(const SystemRow& row) {
  return row.here ? fmt::format("{} on {}", row.published.workload, row.published.platform) : "";
}

}  // namespace

std::string systems_table(const std::vector<SystemRow>& rows) {
  TextTable table({{"system", kLeft},
                   {"class", kLeft, 3},
                   {"chip", kLeft, 2},
                   {"frames/s"},
                   {"mW"},
                   {"mJ/frame"},
                   {"here", kLeft, 2},
                   {"frames/s", kRight, 1},
                   {"mW"},
                   {"mJ/frame"},
                   {"most frames/s", kRight, 2}});
  std::string sources;
  std::string small;
  for (const SystemRow& row : rows) {
    const PublishedSystem& p = row.published;
    std::vector<std::string> cells{fmt::format("{}, {}", p.name, p.year),
                                   p.kind,
                                   p.chip,
                                   number(p.frames_per_s),
                                   number(p.power_mw, p.is_bound),
                                   number(p.frame_mj(), p.is_bound),
                                   model_of(row)};
    if (row.here)
      cells.insert(cells.end(), {number(row.here->frames_per_s), banded(row.here->power),
                                 banded(row.here->frame), number(row.here->most_frames_per_s)});
    cells.resize(11);
    table.add(std::move(cells));
    sources += fmt::format("  {}: {}\n", p.name, p.source);
    if (row.here && row.here->memory != "fits")
      small += fmt::format("{} as though it fitted: {}\n", p.name, row.here->memory);
  }
  return table.str() +
         "published: of whole systems, as their authors define them; < is a bound\n"
         "here: what leviosim predicts for the chip alone, at that rate, with bands; most: what "
         "the computing would allow. Where it is empty, the system is not modelled\n" +
         small + "sources\n" + sources;
}

std::string systems_conclusion(const std::vector<SystemRow>& rows) {
  const SystemRow* least = nullptr;
  std::size_t modelled = 0;
  for (const SystemRow& row : rows) {
    if (!row.here) continue;
    ++modelled;
    if (row.here->frame && (least == nullptr || row.here->frame->value < least->here->frame->value))
      least = &row;
  }
  std::string text = fmt::format("in short: {} of {} systems are modelled", modelled, rows.size());
  if (least != nullptr)
    text += fmt::format("; {} takes {} mJ per frame", model_of(*least), banded(least->here->frame));
  return text;
}

std::string systems_csv(const std::vector<SystemRow>& rows) {
  using S = const SystemRow&;
  const auto text = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
  };
  base::CsvTable<SystemRow> table{
      {"system", [](S s) { return s.published.name; }},
      {"year", [](S s) { return s.published.year; }},
      {"class", [](S s) { return s.published.kind; }},
      {"chip", [](S s) { return s.published.chip; }},
      {"frames_per_s", [=](S s) { return text(s.published.frames_per_s); }},
      {"power_mw", [=](S s) { return text(s.published.power_mw); }},
      {"power_is_bound", [](S s) { return s.published.is_bound ? 1 : 0; }},
      {"frame_mj", [=](S s) { return text(s.published.frame_mj()); }},
      {"source", [](S s) { return s.published.source; }},
      {"here", [](S s) { return model_of(s); }}};
  const auto add = [&](const char* name, auto of) {
    table.add(name, [=](S s) { return s.here ? text(of(*s.here)) : std::string(); });
  };
  using P = const Prediction&;
  using Value = std::optional<double>;
  add("here_frames_per_s", [](P p) { return Value(p.frames_per_s); });
  add("here_most_frames_per_s", [](P p) { return Value(p.most_frames_per_s); });
  const auto add_banded = [&](const std::string& name, auto figure) {
    const auto end = [&](const std::string& suffix, auto value) {
      add((name + suffix).c_str(), [=](P p) {
        return p.*figure ? Value(value(*(p.*figure)).count() * kMilli) : std::nullopt;
      });
    };
    end("", [](const auto& e) { return e.value; });
    end("_low", [](const auto& e) { return e.low(); });
    end("_high", [](const auto& e) { return e.high(); });
  };
  add_banded("here_power_mw", &Prediction::power);
  add_banded("here_frame_mj", &Prediction::frame);
  table.add("here_memory", [](S s) { return s.here ? s.here->memory : std::string(); });
  return table.text(rows);
}

}  // namespace leviosim::tools
