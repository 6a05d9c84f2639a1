#include "tools/app/comparison/comparison_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/printable.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/comparison_files.h"
#include "tools/app/comparison/comparison_summary.h"
#include "tools/app/comparison/comparison_words.h"
#include "tools/app/comparison/model_errors.h"
#include "tools/app/record/measured.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostParts = 6;
constexpr std::size_t kMostBlocks = 12;
constexpr int kWidth = 80;
constexpr double kKilo = 1e3;

/// Nothing would be left of it in kilocycles with one decimal.
constexpr double kLeastShown = 0.05 * kKilo;

struct NamedFormat {
  const char* name;
  ReportFormat format;
};
constexpr std::array kFormats{
    NamedFormat{"text", ReportFormat::text}, NamedFormat{"markdown", ReportFormat::markdown},
    NamedFormat{"json", ReportFormat::json}, NamedFormat{"csv", ReportFormat::csv}};

int decimals_of(const std::string& unit) { return unit == "m" || unit == "mJ" ? 3 : 1; }

std::string kilocycles(std::optional<double> cycles) {
  return figure_text(cycles ? std::optional(*cycles / kKilo) : std::nullopt, 1);
}

/// Without a sign where nothing would be left of it.
std::string signed_kilocycles(double cycles) {
  return std::abs(cycles) < kLeastShown ? "0.0" : fmt::format("{:+.1f}", cycles / kKilo);
}

/// Renders the tables of one report.
class Writer {
 public:
  Writer(const RunComparison& c, bool markdown) : c_(c), markdown_(markdown) {}

  std::string str() {
    head();
    figures();
    stages();
    reasons_of_stages();
    blocks();
    energy("energy of a frame by stage [mJ]", c_.energy_by_stage);
    energy("energy of a frame by domain [mJ]", c_.energy_by_domain);
    return std::move(text_);
  }

 private:
  void title(const std::string& name) {
    text_ +=
        markdown_ ? fmt::format("\n### {}\n\n", markdown_text(name)) : fmt::format("\n{}\n", name);
  }
  void table(const Table& t) {
    text_ += markdown_ ? with_dots(markdown_table(t)) : terminal_text(t);
  }
  /// Blanks at the begin of a cell, which say what is part of what, are lost in Markdown.
  static std::string with_dots(std::string text) {
    constexpr std::string_view kBegin = "| ";
    for (std::size_t at = 0; at != std::string::npos && at < text.size();) {
      std::size_t cell = at + kBegin.size();
      while (text.compare(cell, 2, "  ") == 0 && text[cell + 2] != '|') {
        text.replace(cell, 2, "· ");
        cell += std::string_view("· ").size();
      }
      at = text.find('\n', cell);
      if (at != std::string::npos) ++at;
    }
    return text;
  }
  void line(const std::string& words) {
    text_ += (markdown_ ? "- " : "") +
             wrap_words(markdown_ ? markdown_text(words) : words, markdown_ ? 2 : 3, kWidth) + '\n';
  }

  std::string described(const RunRecord& run) const {
    const RunFacts& f = run.facts;
    std::string text = fmt::format("{}: {}", printable(run.name), printable(f.profile));
    for (const std::string& set : f.workload) text += ", " + printable(set);
    text += f.platform.empty() ? " on the host" : " on " + printable(f.platform);
    for (const std::string& override : f.overrides) text += ", " + printable(override);
    if (f.cores > 0) text += fmt::format(", {} cores", f.cores);
    if (!f.camera.empty()) text += ", camera at " + printable(f.camera);
    return text;
  }

  void head() {
    line("A  " + described(c_.a));
    line("B  " + described(c_.b));
    const RunFacts& f = c_.a.facts;
    line(fmt::format("frames {}:{}, seed {}, {}x{}", f.first_frame, f.first_frame + f.frames,
                     f.seed, f.image_width, f.image_height));
    for (const std::string& note : c_.notes) line("note: " + printable(note));
    line(work_line(c_));
  }

  void figures() {
    title("the run as a whole");
    Table t({{"", kLeft}, {"A"}, {"B"}, {"unit", kLeft}, {"change"}});
    for (const ComparedQuantity& q : c_.figures)
      t.add({q.name, quantity_text(q.a, q.unit, decimals_of(q.unit)),
             quantity_text(q.b, q.unit, decimals_of(q.unit)), q.unit, signed_percent(q.percent())});
    table(t);
  }

  static std::string pair(const ComparedQuantity& q, int decimals) {
    const std::string a = figure_text(q.a, decimals);
    const std::string b = figure_text(q.b, decimals);
    return a == b ? a : a + " → " + b;
  }

  void stages() {
    if (c_.stages.empty()) return;
    title("stages on N cores: kcycles of a call, share of a frame's cycles [%]");
    Table all({{"stage", kLeft}, {"calls"}, {"A"}, {"B"}, {"change"}, {"% A"}, {"% B"}});
    Table one({{"stage on one core", kLeft}, {"A"}, {"B"}, {"change"}});
    bool any_single = false;
    for (const StageComparison& s : c_.stages) {
      if (!s.parallel.a && !s.parallel.b) continue;  // it did not run
      const std::string name = shortened(s.stage.name, 20);
      all.add({name, pair(s.calls, 0), kilocycles(s.parallel.a), kilocycles(s.parallel.b),
               signed_percent(s.parallel.percent()), figure_text(s.share.a, 1),
               figure_text(s.share.b, 1)});
      if (s.single.a == s.single.b) continue;
      any_single = true;
      one.add({name, kilocycles(s.single.a), kilocycles(s.single.b),
               signed_percent(s.single.percent())});
    }
    table(all);
    text_ += '\n';
    if (any_single)
      table(one);
    else
      line("on one core, all stages take the same");
  }

  void reasons_of_stages() {
    const bool known = std::any_of(c_.stages.begin(), c_.stages.end(),
                                   [](const StageComparison& s) { return s.mechanisms; });
    if (!known) {
      title("why");
      line("where the cycles of one of the runs went is not known; replay its trace");
      return;
    }
    title("why: kcycles of a mean frame on N cores");
    Table t({{"", kLeft}, {"A"}, {"B"}, {"difference"}});
    const auto row = [&](const std::string& name, const ComparedQuantity& q) {
      t.add({name, kilocycles(q.a), kilocycles(q.b),
             signed_kilocycles(q.b.value_or(0) - q.a.value_or(0))});
    };
    bool any = false;
    for (const StageComparison& s : c_.stages) {
      if (!s.mechanisms || !is_worth_showing(*s.mechanisms)) continue;
      any = true;
      row(shortened(s.stage.name, 40), *s.mechanisms);
      add_cause(t, "other work", s.causes.work);
      add_cause(t, "other cost of an operation", s.causes.cost);
      add_cause(t, "contention and waiting", s.causes.contention);
      add_leaves(t, *s.mechanisms);
      add_places(t, *s.forks);
    }
    row("front end", c_.frame);
    table(t);
    if (!any) line("no stage differs");
  }

  static bool is_worth_showing(const ComparedQuantity& stage) {
    const double most = std::max(stage.a.value_or(0), stage.b.value_or(0));
    const std::vector<Leaf> leaves = leaves_by_difference(stage);
    return !leaves.empty() && std::abs(leaves.front().difference) > kLeastShare * most;
  }

  static void add_cause(Table& t, const char* name, double cycles) {
    if (std::abs(cycles) >= kLeastShown)
      t.add({fmt::format("  {}", name), "", "", signed_kilocycles(cycles)});
  }

  /// The largest, and the sum of the others.
  static void add_leaves(Table& t, const ComparedQuantity& whole) {
    double others = 0;
    std::size_t shown = 0;
    for (const Leaf& leaf : leaves_by_difference(whole)) {
      if (shown == kMostParts || std::abs(leaf.difference) < kLeastShown) {
        others += leaf.difference;
        continue;
      }
      ++shown;
      t.add({"    " + shortened(part_label(leaf.name), 44), "", "",
             signed_kilocycles(leaf.difference)});
    }
    if (std::abs(others) >= kLeastShown)
      t.add({"    all others", "", "", signed_kilocycles(others)});
  }

  /// Only if a fork or the serial part differs.
  static void add_places(Table& t, const ComparedQuantity& whole) {
    const auto differs = [](const ComparedQuantity& place) {
      return std::abs(place.b.value_or(0) - place.a.value_or(0)) >= kLeastShown;
    };
    if (std::none_of(whole.parts.begin(), whole.parts.end(), [&](const ComparedQuantity& place) {
          return place.name != kOutsideForks && differs(place);
        }))
      return;
    for (const ComparedQuantity& place : whole.parts)
      if (differs(place))
        t.add({place.name == kOutsideForks ? "    " + place.name
                                           : "    in " + shortened(place.name, 41),
               kilocycles(place.a), kilocycles(place.b),
               signed_kilocycles(place.b.value_or(0) - place.a.value_or(0))});
  }

  /// The largest differences; all are in JSON and CSV.
  void blocks() {
    if (c_.blocks.empty()) return;
    std::vector<ComparedQuantity> sorted = c_.blocks;
    const auto size = [](const ComparedQuantity& q) {
      return std::abs(q.b.value_or(0) - q.a.value_or(0));
    };
    std::stable_sort(
        sorted.begin(), sorted.end(),
        [&](const ComparedQuantity& x, const ComparedQuantity& y) { return size(x) > size(y); });
    title("blocks at a peak that differ [kB]");
    Table t({{"owner: block", kLeft}, {"A"}, {"B"}, {"difference"}});
    for (std::size_t i = 0; i < std::min(sorted.size(), kMostBlocks); ++i) {
      const ComparedQuantity& q = sorted[i];
      t.add({shortened(q.name, 44), kilocycles(q.a), kilocycles(q.b),
             fmt::format("{:+.1f}", (q.b.value_or(0) - q.a.value_or(0)) / kKilo)});
    }
    table(t);
    if (sorted.size() > kMostBlocks)
      line(fmt::format("… and {} more with --format json", sorted.size() - kMostBlocks));
  }

  void energy(const std::string& name, const ComparedQuantity& whole) {
    if (whole.parts.empty()) return;
    constexpr double kLeastEnergy = 5e-5;  // rows that show as they were are left out
    title(name);
    Table t({{"", kLeft}, {"A"}, {"B"}, {"difference"}, {"change"}});
    const auto row = [&](const ComparedQuantity& q) {
      t.add({shortened(q.name, 24), figure_text(q.a, 4), figure_text(q.b, 4),
             q.difference() ? fmt::format("{:+.4f}", *q.difference()) : "–",
             signed_percent(q.percent())});
    };
    for (const ComparedQuantity& part : whole.parts)
      if (std::abs(part.b.value_or(0) - part.a.value_or(0)) >= kLeastEnergy) row(part);
    row({"all", whole.unit, whole.a, whole.b});
    table(t);
  }

  const RunComparison& c_;
  bool markdown_;
  std::string text_;
};

}  // namespace

ReportFormat parse_report_format(const std::string& name) {
  std::vector<std::string> names;
  for (const NamedFormat& f : kFormats) {
    if (name == f.name) return f.format;
    names.emplace_back(f.name);
  }
  throw InputError(fmt::format("--format '{}': expected {}{}", name, fmt::join(names, ", "),
                               base::did_you_mean(name, names)));
}

std::string comparison_report(const RunComparison& comparison, ReportFormat format) {
  const bool is_measured = comparison.a.facts.measured || comparison.b.facts.measured;
  if (is_measured && (format == ReportFormat::markdown || format == ReportFormat::text))
    return measured_report(comparison, format == ReportFormat::markdown);
  switch (format) {
    case ReportFormat::json:
      return json_text(comparison_json(comparison), 2) + '\n';
    case ReportFormat::csv:
      return comparison_csv(comparison);
    case ReportFormat::markdown:
      return Writer(comparison, true).str();
    default:
      return Writer(comparison, false).str();
  }
}

std::string comparison_report(const std::vector<RunComparison>& comparisons, ReportFormat format,
                              bool all) {
  if (format == ReportFormat::json && comparisons.size() > 1) {
    Json list = Json::array();
    for (const RunComparison& c : comparisons) list.push_back(comparison_json(c));
    return json_text(list, 2) + '\n';
  }
  std::string text;
  for (const RunComparison& c : comparisons)
    text += (text.empty() ? "" : "\n") + (format == ReportFormat::text && !all
                                              ? comparison_summary(c)
                                              : comparison_report(c, format));
  return text;
}

}  // namespace leviosim::tools
