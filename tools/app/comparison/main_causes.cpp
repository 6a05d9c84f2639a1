#include "tools/app/comparison/main_causes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "sim/chip/account.h"

namespace leviosim::tools {
namespace {

/// Mechanisms that wait for the same, or stand in the same column of losses, are one cause.
std::string name_of_mechanism(std::string_view mechanism) {
  const auto info_of = [](const auto& holds) {
    return std::find_if(sim::kMechanisms.begin(), sim::kMechanisms.end(), holds);
  };
  const auto info = info_of([&](const sim::MechanismInfo& i) { return i.key == mechanism; });
  if (info == sim::kMechanisms.end()) return std::string(mechanism);
  const auto first = info_of([&](const sim::MechanismInfo& i) {
    return i.wait == info->wait && i.column == info->column && i.column != "useful";
  });
  const auto others = std::count_if(
      sim::kMechanisms.begin(), sim::kMechanisms.end(),
      [&](const sim::MechanismInfo& i) { return !i.wait.empty() && i.wait == info->wait; });
  if (others > 1) return fmt::format("waiting for {}", info->wait);
  return std::string((first == sim::kMechanisms.end() ? info : first)->meaning);
}

/// Whether cores spend it on their own shares of a fork, so that more cores have less of it each.
bool is_of_a_core(std::string_view mechanism) {
  return std::any_of(
      sim::kMechanisms.begin(), sim::kMechanisms.end(), [&](const sim::MechanismInfo& info) {
        return info.key == mechanism && sim::index(info.mechanism) < sim::kCoreMechanismCount;
      });
}

bool is_kernel(std::string_view operation) {
  return std::any_of(work::kOffloadKinds.begin(), work::kOffloadKinds.end(),
                     [&](const work::OffloadKindInfo& kind) { return kind.name == operation; });
}

std::set<std::string> kernels_at(const StageParts& stage, const std::string& where) {
  std::set<std::string> kernels;
  for (const CyclePart& part : stage.parts)
    if (part.where == where && part.count > 0 && is_kernel(part.operation))
      kernels.insert(part.operation);
  return kernels;
}

/// Cycles of a mean frame by cause and stage.
class CauseSum {
 public:
  CauseSum(const TimedParts& a, const TimedParts& b) : a_(a), b_(b) {
    const double seconds_per_cycle = 1.0 / static_cast<double>(b.clock.count());
    ms_ = 1e3 * seconds_per_cycle;
    clock_ms_ = 1e3 * (seconds_per_cycle - 1.0 / static_cast<double>(a.clock.count()));
    static const StageParts kNone;
    for (const StageParts& stage : a.stages)
      if (!stage.on_controller) add(stage.stage, stage, find(b, stage.stage, kNone));
    for (const StageParts& stage : b.stages)
      if (!stage.on_controller && &find(a, stage.stage, kNone) == &kNone)
        add(stage.stage, kNone, stage);
  }

  std::vector<MainCause> list() const {
    std::vector<MainCause> causes;
    for (const auto& [what, stages] : causes_) {
      MainCause cause{what, 0, {}, 0};
      for (const auto& [stage, ms] : stages) {
        cause.ms += ms;
        if (std::abs(ms) > std::abs(cause.stage_ms)) cause.stage = stage, cause.stage_ms = ms;
      }
      if (cause.ms != 0) causes.push_back(std::move(cause));
    }
    std::stable_sort(causes.begin(), causes.end(), [](const MainCause& x, const MainCause& y) {
      return std::abs(x.ms) > std::abs(y.ms);
    });
    return causes;
  }

 private:
  using Key = std::tuple<std::string, std::string, std::string>;

  static const StageParts& find(const TimedParts& run, const std::string& stage,
                                const StageParts& otherwise) {
    for (const StageParts& s : run.stages)
      if (s.stage == stage) return s;
    return otherwise;
  }

  void put(const std::string& what, const std::string& stage, double ms) {
    if (ms != 0) causes_[what][stage] += ms;
  }

  /// "eigen3, eigen9": those of one set that the other lacks.
  static std::string those_beside(const std::set<std::string>& kernels,
                                  const std::set<std::string>& others) {
    std::vector<std::string> names;
    std::set_difference(kernels.begin(), kernels.end(), others.begin(), others.end(),
                        std::back_inserter(names));
    return fmt::format("{}", fmt::join(names, ", "));
  }

  /// What a difference at a place is called: that of its mechanism, unless work moved.
  std::string cause_of(const std::string& where, const std::string& mechanism,
                       const StageParts& in_a, const StageParts& in_b) const {
    if (!where.empty()) {
      const std::set<std::string> before = kernels_at(in_a, where);
      const std::set<std::string> after = kernels_at(in_b, where);
      if (const std::string more = those_beside(after, before); !more.empty())
        return "offloaded to " + more;
      if (const std::string fewer = those_beside(before, after); !fewer.empty())
        return "no longer offloaded to " + fewer;
    }
    return name_of_mechanism(mechanism);
  }

  void add(const std::string& stage, const StageParts& in_a, const StageParts& in_b) {
    std::map<Key, std::pair<double, double>> cycles;
    const auto gather = [&](const StageParts& parts, double frames, auto side) {
      if (frames == 0) return;
      double rest = parts.cycles / frames;
      for (const CyclePart& p : parts.parts) {
        side(cycles[{p.where, p.mechanism, p.operation}]) += p.cycles / frames;
        rest -= p.cycles / frames;
      }
      side(cycles[{"", "rounding", ""}]) += rest;
    };
    gather(in_a, a_.frames, [](auto& pair) -> double& { return pair.first; });
    gather(in_b, b_.frames, [](auto& pair) -> double& { return pair.second; });
    const double other_cores = static_cast<double>(a_.cores) / b_.cores;
    for (const auto& [key, pair] : cycles) {
      const auto& [where, mechanism, operation] = key;
      const bool is_divided =
          !where.empty() && where != sim::kSerialFork && is_of_a_core(mechanism);
      const double divided = is_divided ? pair.first * (other_cores - 1) : 0;
      put("another clock", stage, pair.first * clock_ms_);
      put(b_.cores > a_.cores ? "divided among more cores" : "divided among fewer cores", stage,
          divided * ms_);
      put(cause_of(where, mechanism, in_a, in_b), stage,
          (pair.second - pair.first - divided) * ms_);
    }
  }

  const TimedParts& a_;
  const TimedParts& b_;
  double ms_ = 0;
  double clock_ms_ = 0;
  std::map<std::string, std::map<std::string, double>> causes_;
};

}  // namespace

TimedParts timed_parts(const RunRecord& run) {
  return {run.cycles, run.facts.cores,
          run.value("frames.count").value_or(static_cast<double>(run.facts.frames)),
          Hertz(std::llround(run.value("run.cluster_clock").value_or(1)))};
}

std::vector<MainCause> worth_naming(std::vector<MainCause> causes) {
  constexpr std::size_t kMost = 5;
  constexpr double kLeastPart = 0.02;
  constexpr double kLeast_ms = 0.005;
  double most = 0;
  for (const MainCause& cause : causes) most = std::max(most, std::abs(cause.ms));
  std::erase_if(causes, [&](const MainCause& cause) {
    return std::abs(cause.ms) < std::max(kLeastPart * most, kLeast_ms);
  });
  if (causes.size() > kMost) causes.resize(kMost);
  return causes;
}

std::string cause_text(const MainCause& cause) {
  std::string text = fmt::format("{} {:+.2f} ms", cause.what, cause.ms);
  if (cause.stage.empty()) return text;
  const bool is_part = std::abs(cause.stage_ms) < std::abs(cause.ms);
  return text + (is_part ? ", most in " : " in ") + cause.stage;
}

std::vector<std::string> unused_accelerators(const RunFigures& run) {
  constexpr std::string_view kAll = "accelerators.";
  std::vector<std::string> unused;
  for (const Statistic& s : run.statistics) {
    if (!s.name.starts_with(kAll)) continue;
    const std::size_t dot = s.name.find('.', kAll.size());
    const std::string where = s.name.substr(kAll.size(), dot - kAll.size());
    const std::string kernel = s.name.substr(dot + 1, s.name.rfind('.') - dot - 1);
    const bool serves =
        std::any_of(run.stages.begin(), run.stages.end(), [&](const StageName& stage) {
          return stage.on_controller == (where == "controller") &&
                 run.value(fmt::format("stages.{}.served.{}.calls", stage.key, kernel))
                         .value_or(0) > 0;
        });
    if (!serves) unused.push_back(fmt::format("{} ({})", kernel, where));
  }
  return unused;
}

std::string unused_text(const std::vector<std::string>& in_a,
                        const std::vector<std::string>& in_b) {
  std::vector<std::string> unused;
  for (const std::string& unit : in_b)
    if (std::find(in_a.begin(), in_a.end(), unit) == in_a.end()) unused.push_back(unit);
  if (unused.empty()) return {};
  return fmt::format("nothing of this run uses {}, because its work has no region for it there",
                     fmt::join(unused, ", "));
}

std::vector<MainCause> main_causes(const TimedParts& a, const TimedParts& b) {
  return CauseSum(a, b).list();
}

}  // namespace leviosim::tools
