#include "tools/app/study/systems/systems_report.h"

#include <fmt/format.h>

#include <sstream>

#include "sim/base/csv.h"
#include "tools/app/html_report/study_page.h"
#include "tools/app/study/systems/predictions.h"
#include "tools/app/study/systems/published_systems.h"
#include "tools/app/table/terminal_table.h"
#include "tools/app/validation/published_files.h"

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
std::string in_milli(const std::optional<sim::Estimate<Unit>>& e) {
  if (!e) return kNothing;
  const auto text = [](Unit value) { return digits(value.count() * kMilli); };
  return fmt::format("{} ({}–{})", text(e->value), text(e->low()), text(e->high()));
}

bool is_first(const SystemRow& row) {
  return row.published.workloads.empty() || row.workload == row.published.workloads.front();
}

std::string model_of(const SystemRow& row) {
  if (row.here) return fmt::format("{} on {}", row.workload, row.published.platform);
  return row.published.absent;
}

const std::vector<std::string> kColumns{"system",       "year",     "class",  "chip",
                                        "frames_per_s", "power_mw", "bound",  "workload",
                                        "platform",     "set",      "absent", "source"};
enum Column : std::size_t {
  kSystem,
  kYear,
  kClass,
  kChip,
  kRate,
  kPower,
  kBound,
  kWorkload,
  kPlatform,
  kSet,
  kAbsent,
  kSource
};

std::optional<double> positive(const base::CsvRow& row, Column column) {
  if (row.text(column).empty()) return std::nullopt;
  const double value = row.number(column);
  if (!(value > 0)) row.fail(column, "expected a number above 0, or nothing");
  return value;
}

std::vector<std::string> words_of(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::vector<std::string> all;
  for (std::string word; words >> word;) all.push_back(word);
  return all;
}

PublishedSystem system_from(const base::CsvRow& row) {
  PublishedSystem system;
  system.name = row.text(kSystem);
  system.year = static_cast<int>(row.number(kYear));
  system.kind = row.text(kClass);
  system.chip = row.text(kChip);
  system.frames_per_s = positive(row, kRate);
  system.power_mw = positive(row, kPower);
  const std::string bound(row.text(kBound));
  if (!bound.empty() && bound != "at most") row.fail(kBound, "expected 'at most', or nothing");
  system.is_bound = !bound.empty();
  system.workloads = words_of(row.text(kWorkload));
  system.platform = row.text(kPlatform);
  if (system.workloads.empty() != system.platform.empty())
    row.fail(kPlatform, "expected a workload and a platform, or neither");
  system.overrides = words_of(row.text(kSet));
  system.absent = row.text(kAbsent);
  if (system.workloads.empty() == system.absent.empty())
    row.fail(kAbsent, "expected a workload, or why there is none");
  system.source = row.text(kSource);
  if (system.name.empty() || system.source.empty()) row.fail("has no name or no source");
  return system;
}

}  // namespace

std::string systems_table(const std::vector<SystemRow>& rows) {
  using S = const SystemRow&;
  const auto here = [](auto of) {
    return [of](S s) { return s.here ? of(*s.here) : std::string(); };
  };
  // What was published stands once.
  const auto published = [](auto of) {
    return [of](S s) { return is_first(s) ? of(s.published) : std::string(); };
  };
  using P = const Prediction&;
  using Q = const PublishedSystem&;
  const Columns<SystemRow> table{
      {{"system", kLeft}, published([](Q q) { return fmt::format("{}, {}", q.name, q.year); })},
      {{"class", kLeft, 4}, published([](Q q) { return q.kind; })},
      {{"chip", kLeft, 3}, published([](Q q) { return q.chip; })},
      {{"frames/s"}, published([](Q q) { return number(q.frames_per_s); })},
      {{"mW"}, published([](Q q) { return number(q.power_mw, q.is_bound); })},
      {{"mJ/frame", kRight, 3}, published([](Q q) { return number(q.frame_mj(), q.is_bound); })},
      {{"here", kLeft}, [](S s) { return model_of(s); }},
      {{"frames/s", kRight, 1}, here([](P p) { return number(p.frames_per_s); })},
      {{"mW"}, here([](P p) { return in_milli(p.power); })},
      {{"mJ/frame"}, here([](P p) { return in_milli(p.frame); })},
      {{"most frames/s", kRight, 2}, here([](P p) { return number(p.most_frames_per_s); })}};
  std::string sources;
  std::string small;
  for (const SystemRow& row : rows) {
    if (is_first(row))
      sources += fmt::format("  {}: {}\n", row.published.name, row.published.source);
    if (row.here && !row.here->fits)
      small += fmt::format("{} as though it fitted: {}\n", model_of(row), row.here->memory);
    else if (row.here && row.here->memory != "fits")
      small += fmt::format("{}: {}\n", model_of(row), row.here->memory);
  }
  return terminal_text(table_of(table, rows)) +
         "published: of whole systems, as their authors define them; < is a bound\n"
         "here: what leviosim predicts for the chip alone, at that rate, with bands; most: what "
         "the computing would allow. Of a system that is not modelled, what its chip is\n" +
         small + "sources\n" + sources;
}

std::string systems_conclusion(const std::vector<SystemRow>& rows) {
  const SystemRow* least = nullptr;
  std::size_t modelled = 0;
  std::size_t systems = 0;
  for (const SystemRow& row : rows) {
    systems += is_first(row) ? 1 : 0;
    if (!row.here) continue;
    modelled += is_first(row) ? 1 : 0;
    if (row.here->frame && (least == nullptr || row.here->frame->value < least->here->frame->value))
      least = &row;
  }
  std::string text = fmt::format("in short: {} of {} systems are modelled", modelled, systems);
  if (least != nullptr)
    text +=
        fmt::format("; {} takes {} mJ per frame", model_of(*least), in_milli(least->here->frame));
  return text;
}

Table systems_rows(const std::vector<SystemRow>& rows) {
  using S = const SystemRow&;
  using P = const Prediction&;
  const auto here = [](auto of) {
    return [of](S s) { return s.here ? Cell(of(*s.here)) : Cell(); };
  };
  const auto milli = [&](auto figure) {
    return here([=](P p) {
      const auto& e = p.*figure;
      return e ? Cell(kMilli * Banded{e->value.count(), e->low().count(), e->high().count()})
               : Cell();
    });
  };
  return table_of(
      Columns<SystemRow>{
          {{.key = "system"}, [](S s) { return s.published.name; }},
          {{.key = "year"}, [](S s) { return s.published.year; }},
          {{.key = "class"}, [](S s) { return s.published.kind; }},
          {{.key = "chip"}, [](S s) { return s.published.chip; }},
          {{.key = "frames_per_s"}, [](S s) { return s.published.frames_per_s; }},
          {{.key = "power_mw"}, [](S s) { return s.published.power_mw; }},
          {{.key = "power_is_bound"}, [](S s) { return s.published.is_bound; }},
          {{.key = "frame_mj"}, [](S s) { return s.published.frame_mj(); }},
          {{.key = "source"}, [](S s) { return s.published.source; }},
          {{.key = "here"}, [](S s) { return model_of(s); }},
          {{.key = "here_frames_per_s"}, here([](P p) { return p.frames_per_s; })},
          {{.key = "here_most_frames_per_s"}, here([](P p) { return p.most_frames_per_s; })},
          {{.key = "here_power_mw", .is_banded = true}, milli(&Prediction::power)},
          {{.key = "here_frame_mj", .is_banded = true}, milli(&Prediction::frame)},
          {{.key = "here_memory"}, here([](P p) { return p.memory; })}},
      rows);
}

StudyPage systems_page(const std::vector<SystemRow>& rows) {
  struct Spot {
    std::string system;
    const char* by;
    std::optional<double> rate, power_mw, low_mw, high_mw;
  };
  std::vector<Spot> spots;
  for (const SystemRow& row : rows) {
    const PublishedSystem& p = row.published;
    if (p.frames_per_s && p.power_mw && is_first(row))
      spots.push_back({p.name,
                       p.is_bound ? "published, at most" : "published",
                       p.frames_per_s,
                       p.power_mw,
                       {},
                       {}});
    if (!row.here || !row.here->power) continue;
    const auto mw = [](Watts power) { return power.count() * kMilli; };
    const auto& power = *row.here->power;
    spots.push_back({p.name, "predicted here", row.here->frames_per_s, mw(power.value),
                     mw(power.low()), mw(power.high())});
  }
  using S = const Spot&;
  const auto milliwatts = [](const char* title, const char* key) -> Head {
    return {.title = title, .key = key, .decimals = 6, .unit = "mW"};
  };
  const Columns<Spot> columns{
      {{.title = "system", .key = "system", .is_setup = true}, [](S s) { return s.system; }},
      {{.title = "known from", .key = "by", .is_setup = true}, [](S s) { return s.by; }},
      {{.title = "frame rate",
        .key = "rate",
        .decimals = 6,
        .unit = "frames/s",
        .more_is_better = true},
       [](S s) { return s.rate; }},
      {milliwatts("power", "power"), [](S s) { return s.power_mw; }},
      {milliwatts("power, low end", "low"), [](S s) { return s.low_mw; }},
      {milliwatts("power, high end", "high"), [](S s) { return s.high_mw; }},
      {{.title = "energy per frame", .key = "energy", .decimals = 6, .unit = "mJ"},
       [](S s) { return *s.power_mw / *s.rate; }}};
  StudyPage page;
  page.title = "Power over frame rate of systems that estimate motion";
  page.summary = systems_conclusion(rows);
  page.points = table_of(columns, spots);
  page.x = "rate";
  page.y = "power";
  page.colour = "by";
  return page;
}

std::optional<double> PublishedSystem::frame_mj() const {
  if (!frames_per_s || !power_mw) return std::nullopt;
  return *power_mw / *frames_per_s;
}

std::vector<PublishedSystem> parse_systems(const std::string& file, std::string_view text) {
  std::vector<PublishedSystem> systems;
  for_each_row(file, text, kColumns,
               [&](const base::CsvRow& row) { systems.push_back(system_from(row)); });
  return systems;
}

std::vector<PublishedSystem> published_systems() {
  return parse_systems("systems.csv", reference_text("systems"));
}

}  // namespace leviosim::tools
