#include "tools/app/budget/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "platform_models/loader/yaml_entries.h"
#include "sim/base/error.h"
#include "tools/app/budget/figures.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/record/measured.h"
#include "tools/app/result/verdict.h"

namespace leviosim::tools {
namespace {

/// No limit is missed by the conversion of its unit: 30 ms are not exactly 3e7 ns.
constexpr double kRounding = 1e-12;

/// What a relative limit comes to.
std::optional<double> relative_bound(const Limit& limit, const Statistic& statistic,
                                     double baseline) {
  const double number = bound_in(limit, statistic.unit);
  return is_percent_of_baseline(limit.bound) ? baseline * (1 + number / 100) : baseline + number;
}

/// Whether the baseline ran without that stage.
bool is_new_stage(const FigureOf& figure, const RunRecord& baseline) {
  return !figure.stage.empty() &&
         std::none_of(baseline.stages.begin(), baseline.stages.end(),
                      [&](const StageName& stage) { return stage.name == figure.stage; });
}

/// What a limit is about; of a measurement, what of it was measured.
std::vector<FigureOf> figures_held(const Limit& limit, const RunRecord& run,
                                   const RunRecord* baseline) {
  std::vector<FigureOf> figures =
      run.facts.measured ? find_figures(limit, run) : figures_of(limit, run);
  if (baseline != nullptr && limit.bound.relative &&
      (run.facts.measured || baseline->facts.measured))
    std::erase_if(figures, [&](const FigureOf& figure) {
      return baseline->find(figure.statistic->name) == nullptr;
    });
  return figures;
}

/// Where a figure has no value in the run nor in the baseline.
bool is_idle(const Finding& f) { return !f.value && (!f.limit->bound.relative || !f.baseline); }

Finding hold(const Limit& limit, const FigureOf& figure, const RunRecord* baseline) {
  Finding f;
  f.limit = &limit;
  f.statistic = figure.statistic->name;
  f.stage = figure.stage;
  f.unit = figure.statistic->unit;
  f.value = figure.statistic->value;
  if (limit.bound.relative) {
    const platform::Place place = platform::place_of(limit.file, limit.line, "");
    if (baseline == nullptr) fail_without_baseline(limit);
    if (baseline->find(f.statistic) == nullptr && !is_new_stage(figure, *baseline))
      place.fail(
          fmt::format("{} has no {}; record it with this budget: leviosim budget record RUN "
                      "--budget {}",
                      baseline->name, f.statistic, limit.file));
    f.baseline = baseline->value(f.statistic);
    if (f.baseline) f.bound = relative_bound(limit, *figure.statistic, *f.baseline);
  } else {
    f.bound = bound_in(limit, f.unit);
  }
  if (f.value && f.bound) {
    const double over = limit.bound.at_most ? *f.value - *f.bound : *f.bound - *f.value;
    f.met = over <= kRounding * std::abs(*f.bound);
  }
  // Of a stage that neither run called, nothing changed.
  if (limit.bound.relative && !f.stage.empty() && is_idle(f)) f.met = true;
  return f;
}

/// Verdicts that are the worst although no limit allows it.
void add_bad_verdicts(CheckResult& result, const RunRecord& run, const Budget& budget) {
  for (const Limit& limit : budget.verdicts.limits) {
    const bool is_named = std::any_of(result.findings.begin(), result.findings.end(),
                                      [&](const Finding& f) { return f.unit == limit.figure; });
    if (is_named || run.find(fmt::format(
                        "verdict.{}", limit.figure.substr(0, limit.figure.find(' ')))) == nullptr)
      continue;
    const FigureOf figure = figures_of(limit, run).front();
    if (figure.statistic->value != severity(Grade::bad)) continue;
    Finding finding = hold(limit, figure, nullptr);
    finding.section = &budget.verdicts;
    for (const RunVerdict& verdict : run.verdicts.list)
      if (figure.statistic->name == fmt::format("verdict.{}", verdict.about))
        finding.why = verdict.reasons;
    result.findings.push_back(std::move(finding));
  }
}

constexpr std::size_t kMostReasons = 3;

double size_of(const ComparedQuantity& q) { return std::abs(q.b.value_or(0) - q.a.value_or(0)); }

/// The part that differs most; null if none does.
const ComparedQuantity* most_different(const std::vector<ComparedQuantity>& parts) {
  const auto it = std::max_element(
      parts.begin(), parts.end(),
      [](const ComparedQuantity& x, const ComparedQuantity& y) { return size_of(x) < size_of(y); });
  return it == parts.end() || size_of(*it) == 0 ? nullptr : &*it;
}

/// Compared with nothing, the difference is the run itself.
RunRecord nothing_like(const RunRecord& run) {
  RunRecord nothing;
  nothing.name = "nothing";
  nothing.facts = run.facts;
  nothing.stages = run.stages;
  for (StageParts stage : run.cycles) {
    stage.cycles = 0;
    stage.parts.clear();
    nothing.cycles.push_back(std::move(stage));
  }
  return nothing;
}

class Explainer {
 public:
  Explainer(const RunRecord& run, const RunRecord* baseline)
      : run_(run),
        has_baseline_(baseline != nullptr),
        is_measured_(run.facts.measured || (baseline != nullptr && baseline->facts.measured)),
        nothing_(has_baseline_ ? RunRecord() : nothing_like(run)),
        comparison_(compare_runs(has_baseline_ ? *baseline : nothing_, run)) {}

  void explain(Finding& f) const {
    if (f.statistic.find("memory.") != std::string::npos)
      explain_memory(f);
    else if (f.statistic.rfind("accuracy.", 0) == 0 || f.statistic.rfind("trajectory.", 0) == 0)
      explain_trajectory(f);
    else if (f.stage.empty())
      explain_frame(f);
    else
      explain_stage(f, f.stage);
    if (!f.why.empty() || !has_baseline_) return;
    f.why.emplace_back(is_measured_ ? "cycles were measured, so nothing is known of their causes"
                                    : "its cycles are those of the baseline");
  }

 private:
  const StageComparison* stage(const std::string& name) const {
    const auto it = std::find_if(comparison_.stages.begin(), comparison_.stages.end(),
                                 [&](const StageComparison& s) { return s.stage.name == name; });
    return it == comparison_.stages.end() ? nullptr : &*it;
  }

  /// The fork in which it happens, if it is known.
  static std::string place_in(const StageComparison& s) {
    const ComparedQuantity* place = s.forks ? most_different(s.forks->parts) : nullptr;
    if (place == nullptr || place->name == kOutsideForks) return s.stage.name;
    return s.stage.name + ", " + place->name;
  }

  /// What of the work differs by more than its digits show; empty if nothing does.
  static std::string work_of(const StageComparison& s) {
    constexpr double kShown = 0.005;
    std::string text;
    if (s.calls.a != s.calls.b)
      text = fmt::format("calls {:g} → {:g}", s.calls.a.value_or(0), s.calls.b.value_or(0));
    const double operations = s.operations.percent().value_or(0);
    if (std::abs(operations) >= kShown)
      text += fmt::format("{}operations {:+.2f} %", text.empty() ? "" : ", ", operations);
    return text;
  }

  void explain_stage(Finding& f, const std::string& name) const {
    const StageComparison* s = stage(name);
    if (s != nullptr) f.where = s->stage.name;
    if (s == nullptr || !s->mechanisms) return;
    f.where = place_in(*s);
    if (has_baseline_) {
      if (const std::string work = work_of(*s); !work.empty())
        f.why.push_back("the work changed: " + work);
      for (const std::string& reason : reasons(*s, kMostReasons)) f.why.push_back(reason);
      return;
    }
    const double whole = s->mechanisms->b.value_or(0);
    for (const Leaf& leaf : leaves_by_difference(*s->mechanisms)) {
      if (f.why.size() == kMostReasons || whole == 0) break;
      f.why.push_back(fmt::format("{} is {:.1f} % of it", part_label(leaf.name),
                                  100 * leaf.difference / whole));
    }
  }

  void explain_frame(Finding& f) const {
    const ComparedQuantity* most = most_different(comparison_.frame.parts);
    if (most == nullptr) return;
    explain_stage(f, most->name);
    const double difference = most->b.value_or(0) - most->a.value_or(0);
    f.why.insert(
        f.why.begin(),
        has_baseline_
            ? fmt::format("{} takes {:+.1f} kcycles of a frame", most->name, difference / 1e3)
            : fmt::format("{} takes {:.1f} kcycles of a frame, the most of all stages", most->name,
                          difference / 1e3));
  }

  void explain_trajectory(Finding& f) const {
    f.where = "trajectory";
    f.why.push_back(has_baseline_ ? work_line(comparison_)
                                  : "without a baseline, nothing to compare its work with");
  }

  /// The stage or the part of L2 that occupies most, and its blocks.
  void explain_memory(Finding& f) const {
    std::string owner = f.stage.empty() ? fullest(f.statistic.find("l2") != std::string::npos) : "";
    for (const StageName& s : run_.stages)
      if (s.name == f.stage) owner = fmt::format("stages.{}.memory.", s.key);
    std::vector<ComparedQuantity> blocks;
    for (const Statistic& s : run_.statistics) {
      if (s.name.rfind(owner + "block.", 0) != 0) continue;
      blocks.push_back({s.name.substr(owner.size() + 6), "byte", 0.0, s.value});
    }
    std::stable_sort(blocks.begin(), blocks.end(),
                     [](const ComparedQuantity& x, const ComparedQuantity& y) {
                       return size_of(x) > size_of(y);
                     });
    f.where =
        fmt::format("{}{}", name_of(owner), blocks.empty() ? "" : ", block " + blocks.front().name);
    const std::string prefix = name_of(owner) + ": ";
    if (has_baseline_)
      for (const ComparedQuantity& q : comparison_.blocks)
        if (q.name.rfind(prefix, 0) == 0 && f.why.size() < kMostReasons)
          f.why.push_back(fmt::format("{} {:+.1f} kB", q.name.substr(prefix.size()),
                                      (q.b.value_or(0) - q.a.value_or(0)) / 1e3));
    for (const ComparedQuantity& block : blocks)
      if (f.why.size() < kMostReasons)
        f.why.push_back(
            fmt::format("{} is {}", block.name, figure_text(block.b.value_or(0), "byte")));
  }

  /// "stages.epnp_ransac.memory." of the stage with the highest peak, or "memory.l2.optimiser.".
  std::string fullest(bool l2) const {
    std::string owner;
    double most = -1;
    for (const Statistic& s : run_.statistics) {
      constexpr std::string_view kPeak = "memory.parallel";
      const bool is_l2 = matches("memory.l2.*.bytes", s.name);
      const bool is_l1 = matches("stages.*.memory.parallel", s.name) && !on_controller(s.name);
      if (!(l2 ? is_l2 : is_l1) || s.value.value_or(0) <= most) continue;
      most = *s.value;
      owner = s.name.substr(0, s.name.size() - (l2 ? 5 : kPeak.size() - 7));
    }
    return owner;
  }

  bool on_controller(const std::string& statistic) const {
    return std::any_of(run_.stages.begin(), run_.stages.end(), [&](const StageName& s) {
      return s.on_controller && statistic.rfind("stages." + s.key + '.', 0) == 0;
    });
  }

  /// For people.
  std::string name_of(const std::string& owner) const {
    for (const StageName& s : run_.stages)
      if (owner == fmt::format("stages.{}.memory.", s.key)) return s.name;
    constexpr std::string_view kL2 = "memory.l2.";
    if (owner.rfind(kL2, 0) != 0) return "L1";
    return owner.substr(kL2.size(), owner.size() - kL2.size() - 1);
  }

  const RunRecord& run_;
  bool has_baseline_;
  bool is_measured_;
  RunRecord nothing_;
  RunComparison comparison_;
};

}  // namespace

std::string Finding::title() const {
  const std::string end = since.empty() ? std::string() : " since " + since;
  if (!limit->stage.empty()) return stage + ": " + limit->text + end;
  if (limit->figure.find('*') == std::string::npos) return limit->text + end;
  return statistic + limit->text.substr(limit->figure.size()) + end;
}

bool Finding::was_over() const {
  if (met || !before || !value || !bound) return false;
  const auto over = [&](double v) { return limit->bound.at_most ? v > *bound : v < *bound; };
  return over(*before) && (limit->bound.at_most ? *value <= *before : *value >= *before);
}

std::optional<double> Finding::better() const {
  if (!met || !value || !baseline || *baseline == 0 || !is_percent_of_baseline(limit->bound))
    return std::nullopt;
  const double side = limit->bound.at_most ? 1 : -1;
  const double percent = side * 100 * (*baseline - *value) / std::abs(*baseline);
  const double allowed = std::max(side * limit->bound.number, 0.0);
  return percent > allowed + kRounding ? std::optional(percent) : std::nullopt;
}

std::string Finding::distance() const {
  if (!value) return "the run has no such value";
  const std::string found = figure_text(*value, unit, limit->bound);
  if (!bound) return found + ", but the baseline has no value of it";
  const double over = *value - *bound;
  const std::string limit_text = figure_text(*bound, unit, limit->bound);
  const char* side = over > 0 ? "above" : over < 0 ? "below" : "at";
  std::string text = over == 0     ? fmt::format("{}, at the limit", found)
                     : *bound == 0 ? fmt::format("{}, {} {}", found, side, limit_text)
                                   : fmt::format("{}, {:.2f} % {} {}", found,
                                                 100 * std::abs(over / *bound), side, limit_text);
  if (baseline && *baseline != 0)
    text +=
        fmt::format("; {:+.2f} % of {} {}", 100 * (*value - *baseline) / *baseline,
                    since.empty() ? "the baseline's" : since + "'s", figure_text(*baseline, unit));
  return text;
}

std::string Finding::excess() const {
  std::string text = distance();
  if (const std::string& words = accepted.empty() ? expired : accepted; !words.empty())
    text += "; " + words;
  return was_over() ? text + "; was over before this change" : text;
}

std::size_t CheckResult::missed() const {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.fails(); }));
}

std::size_t CheckResult::warned() const {
  return static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [](const Finding& f) { return !f.met && !f.fails(); }));
}

std::size_t CheckResult::better() const {
  return static_cast<std::size_t>(
      std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.better(); }));
}

void fail_without_baseline(const Limit& limit) {
  platform::place_of(limit.file, limit.line, "")
      .fail(fmt::format("'{}' is relative to a baseline; expected --baseline", limit.text));
}

CheckResult check_budget(const RunRecord& run, const Budget& budget, const RunRecord* baseline) {
  CheckResult result{run.name, budget.file, baseline == nullptr ? "" : baseline->name, {}};
  for (const BudgetSection* section : sections_for(budget, run))
    for (const Limit& limit : section->limits) {
      const std::vector<FigureOf> figures = figures_held(limit, run, baseline);
      if (figures.empty()) result.not_measured.push_back(limit.text);
      for (const FigureOf& figure : figures) {
        Finding finding = hold(limit, figure, baseline);
        // Of several kinds of frames, some never come.
        if (figures.size() > 1 && figure.stage.empty() && is_idle(finding)) continue;
        finding.section = section;
        result.findings.push_back(std::move(finding));
      }
    }
  if (result.findings.empty())
    throw InputError(fmt::format("{}: {} measures nothing of what it limits", budget.file,
                                 run.facts.measured ? run.name : baseline->name));
  add_bad_verdicts(result, run, budget);
  for (Finding& finding : result.findings)
    for (const AcceptedMiss& miss : budget.accepted)
      if (!finding.met && finding.title() == miss.limit) {
        if (today() <= miss.until)
          finding.accepted = fmt::format("accepted until {}: {}", miss.until, miss.reason);
        else
          finding.expired = fmt::format("was accepted until {}: {}", miss.until, miss.reason);
      }
  if (result.missed() + result.warned() > 0) explain(result, run, baseline);
  return result;
}

void explain(CheckResult& result, const RunRecord& run, const RunRecord* baseline) {
  const Explainer explainer(run, baseline);
  for (Finding& finding : result.findings)
    if (!finding.met) explainer.explain(finding);
}

}  // namespace leviosim::tools
