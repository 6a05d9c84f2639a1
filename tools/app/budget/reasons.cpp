#include "tools/app/budget/reasons.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/app/budget/check.h"
#include "tools/app/budget/figures.h"
#include "tools/app/comparison/comparison.h"
#include "tools/app/comparison/comparison_words.h"
#include "tools/app/comparison/main_causes.h"

namespace leviosim::tools {
namespace {

constexpr std::size_t kMostReasons = 3;
constexpr double kLeastCauseMs = 0.005;  ///< below, 0.00 ms would be printed

double size_of(const ComparedQuantity& q) { return std::abs(q.b.value_or(0) - q.a.value_or(0)); }

/// The part that grew most; null if none did: what became less is no reason for a miss.
const ComparedQuantity* most_grown(const std::vector<ComparedQuantity>& parts) {
  const auto grown = [](const ComparedQuantity& q) { return q.b.value_or(0) - q.a.value_or(0); };
  const auto it = std::max_element(
      parts.begin(), parts.end(),
      [&](const ComparedQuantity& x, const ComparedQuantity& y) { return grown(x) < grown(y); });
  return it == parts.end() || grown(*it) <= 0 ? nullptr : &*it;
}

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
        baseline_(baseline),
        has_baseline_(baseline != nullptr),
        is_measured_(run.facts.measured || (baseline != nullptr && baseline->facts.measured)),
        nothing_(has_baseline_ ? RunRecord() : nothing_like(run)),
        comparison_(compare_runs(has_baseline_ ? *baseline : nothing_, run)) {}

  void explain(Finding& f) const {
    if (f.statistic.find("memory.") != std::string::npos)
      explain_memory(f);
    else if (f.statistic.rfind("accuracy.", 0) == 0 || f.statistic.rfind("trajectory.", 0) == 0)
      explain_trajectory(f);
    else if (has_baseline_ && is_time(f) && !is_measured_)
      explain_time(f);
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
      for (const std::string& reason : reasons(*s, kMostReasons, Toward::more))
        f.why.push_back(reason);
      return;
    }
    const double whole = s->mechanisms->b.value_or(0);
    for (const Leaf& leaf : leaves_by_difference(*s->mechanisms)) {
      if (f.why.size() == kMostReasons || whole == 0) break;
      f.why.push_back(fmt::format("{} is {:.1f} % of it", part_label(leaf.name),
                                  100 * leaf.difference / whole));
    }
  }

  /// Whether the figure is a time of frames, or a rate: what all cycles of a frame take.
  static bool is_time(const Finding& f) {
    return f.unit == "ns" || f.unit == "ms" || f.unit == "1/s" ||
           f.statistic == "frame.missed_share" || f.statistic == "verdict.time";
  }

  /// Of a run that is slower than another: what made it slower, in ms of a mean frame.
  void explain_time(Finding& f) const {
    const std::vector<MainCause> causes =
        main_causes(parts_of(*baseline_, f.stage), parts_of(run_, f.stage));
    double faster = 0;
    for (const MainCause& cause : causes) {
      if (cause.ms < 0) faster += cause.ms;
      if (cause.ms < kLeastCauseMs || f.why.size() == kMostReasons) continue;
      if (f.where.empty()) f.where = cause.stage;
      f.why.push_back(cause_text(cause));
    }
    if (f.why.empty() && faster < 0)
      f.why.push_back(fmt::format("a mean frame is {:.2f} ms faster than in {}; others are not",
                                  -faster, baseline_->name));
  }

  static TimedParts parts_of(const RunRecord& run, const std::string& stage) {
    TimedParts parts = timed_parts(run);
    if (!stage.empty())
      std::erase_if(parts.stages, [&](const StageParts& s) { return s.stage != stage; });
    return parts;
  }

  /// What of the chip differs, where no stage takes more cycles: clock and supply.
  void explain_chip(Finding& f) const {
    for (const auto& [name, what] : {std::pair{"run.cluster_clock", "clock of the cluster"},
                                     std::pair{"run.voltage", "supply"}}) {
      const Statistic* before = has_baseline_ ? baseline_->find(name) : nullptr;
      const Statistic* now = run_.find(name);
      if (before == nullptr || now == nullptr || before->value == now->value || !now->value)
        continue;
      f.why.push_back(fmt::format("{}: {} → {}", what,
                                  figure_text(before->value.value_or(0), before->unit),
                                  figure_text(*now->value, now->unit)));
    }
  }

  void explain_frame(Finding& f) const {
    const ComparedQuantity* most = most_grown(comparison_.frame.parts);
    if (most == nullptr) return explain_chip(f);
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
  const RunRecord* baseline_;  ///< may be null
  bool has_baseline_;
  bool is_measured_;
  RunRecord nothing_;
  RunComparison comparison_;
};

}  // namespace

void explain(CheckResult& result, const RunRecord& run, const RunRecord* baseline) {
  const Explainer explainer(run, baseline);
  for (Finding& finding : result.findings)
    if (!finding.met) explainer.explain(finding);
}

}  // namespace leviosim::tools
