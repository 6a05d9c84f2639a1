#include "tools/app/comparison/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/app/comparison/stage_difference.h"
#include "tools/app/table/terminal_table.h"

namespace leviosim::tools {
namespace {

class Comparer {
 public:
  Comparer(const RunRecord& a, const RunRecord& b) : a_(a), b_(b) {}

  ComparedQuantity of(const std::string& name, const std::string& unit, std::string_view statistic,
                      double scale = 1) const {
    return {name, unit, scaled(a_.value(statistic), scale), scaled(b_.value(statistic), scale)};
  }

  std::vector<ComparedQuantity> figures() const {
    std::vector<ComparedQuantity> list;
    const bool has_camera = a_.value("camera.arrived") || b_.value("camera.arrived");
    for (const FigureRow& f : figure_rows()) {
      if (f.title.empty()) continue;
      // Where no camera runs, frames queue as long as the flight is.
      if (!has_camera && f.statistic.starts_with("frame.latency.")) continue;
      ComparedQuantity q =
          of(std::string(f.title), std::string(f.title_unit), f.statistic, f.scale);
      if (q.a || q.b) list.push_back(std::move(q));
    }
    return list;
  }

  /// Of both runs, those of A first.
  std::vector<StageName> stages() const {
    std::vector<StageName> all = a_.stages;
    for (const StageName& stage : b_.stages)
      if (std::none_of(all.begin(), all.end(),
                       [&](const StageName& s) { return s.key == stage.key; }))
        all.push_back(stage);
    return all;
  }

  StageComparison stage(const StageName& name) const {
    const std::string path = "stages." + name.key + '.';
    StageComparison c;
    c.stage = name;
    c.calls = of("calls", "1", path + "calls");
    c.single = of("a call on one core", "cycles", path + "cycles.single.mean");
    c.parallel = of("a call on N cores", "cycles", path + "cycles.parallel.mean");
    c.share = {"share of the frame", "%", share(a_, path), share(b_, path)};
    if (name.on_controller) c.share.a = c.share.b = std::nullopt;
    compare_work(path, c);
    const StageParts* in_a = a_.stage_parts(name.name);
    const StageParts* in_b = b_.stage_parts(name.name);
    if (!a_.cycles.empty() && !b_.cycles.empty() && (in_a != nullptr || in_b != nullptr))
      split(in_a, in_b, c);
    return c;
  }

  /// A baseline has the larger parts only; the same parts of the other run then stand together.
  void split(const StageParts* in_a, const StageParts* in_b, StageComparison& c) const {
    StageParts like_b;
    StageParts like_a;
    if (in_a != nullptr && in_b != nullptr && is_folded(*in_b))
      in_a = &(like_b = folded_like(*in_a, *in_b));
    if (in_a != nullptr && in_b != nullptr && is_folded(*in_a))
      in_b = &(like_a = folded_like(*in_b, *in_a));
    c.mechanisms = split_by_mechanism(in_a, in_b, frames(a_), frames(b_));
    c.forks = split_by_fork(in_a, in_b, frames(a_), frames(b_));
    c.causes = split_by_cause(in_a, in_b, frames(a_), frames(b_));
  }

  /// The offload is a stage of the frame too.
  ComparedQuantity frame(const std::vector<StageComparison>& stages) const {
    ComparedQuantity whole = of("frame", "cycles", "frame.cycles.parallel.mean");
    for (const StageComparison& stage : stages) {
      if (!stage.mechanisms || stage.stage.on_controller) continue;
      whole.parts.push_back(*stage.mechanisms);
    }
    const StageParts* in_a = a_.stage_parts(kOffloadStage);
    const StageParts* in_b = b_.stage_parts(kOffloadStage);
    if (in_a != nullptr && in_b != nullptr)
      whole.parts.push_back(split_by_mechanism(in_a, in_b, frames(a_), frames(b_)));
    return whole;
  }

  std::vector<ComparedQuantity> blocks() const {
    std::vector<ComparedQuantity> list;
    const auto is_block = [](const Statistic& s) {
      return s.name.find(".block.") != std::string::npos && s.unit == "byte";
    };
    // What a baseline does not hold may have been there all the same.
    const bool all_in_a = holds_all(a_);
    const bool all_in_b = holds_all(b_);
    for (const Statistic& s : a_.statistics)
      if (is_block(s) && b_.value(s.name) != s.value && (all_in_b || b_.value(s.name)))
        list.push_back({block_name(s.name), "byte", s.value, b_.value(s.name)});
    for (const Statistic& s : b_.statistics)
      if (all_in_a && is_block(s) && a_.find(s.name) == nullptr)
        list.push_back({block_name(s.name), "byte", std::nullopt, s.value});
    return list;
  }

  /// mJ of a frame. @param by_domain  else by stage
  /// @returns without parts if one of the runs is a baseline, which holds none
  ComparedQuantity energy(bool by_domain) const {
    ComparedQuantity whole = of("energy of a frame", "mJ", "energy.frame");
    if ((!whole.a && !whole.b) || !holds_all(a_) || !holds_all(b_)) return whole;
    for (const RunRecord* run : {&a_, &b_}) {
      const auto total = run->value("energy.total");
      const auto frame = run->value("energy.frame");
      if (!total || !frame || *total == 0) continue;
      for (const Statistic& s : run->statistics) {
        constexpr std::string_view kDomain = ".domain.";
        const auto at = s.name.find(kDomain);
        if (s.name.rfind("energy.", 0) != 0 || at == std::string::npos || !s.value) continue;
        const std::string domain = s.name.substr(at + kDomain.size());
        if (domain.find('.') != std::string::npos) continue;  // ends of its band
        ComparedQuantity& part =
            part_of(whole, by_domain ? domain : stage_name(s.name.substr(7, at - 7)));
        *(run == &a_ ? part.a : part.b) += *s.value * *frame / *total;
      }
    }
    return whole;
  }

 private:
  /// Whether it is a run itself, not a baseline of one or a run of a history: those do not say how
  /// many operations of each kind there were.
  static bool holds_all(const RunRecord& run) {
    return std::any_of(run.statistics.begin(), run.statistics.end(), [](const Statistic& s) {
      return s.name.find(".ops.") != std::string::npos;
    });
  }
  static bool is_folded(const StageParts& stage) {
    return std::any_of(stage.parts.begin(), stage.parts.end(),
                       [](const CyclePart& part) { return part.mechanism == kOtherParts; });
  }

  static double frames(const RunRecord& run) {
    return run.value("frames.count").value_or(static_cast<double>(run.facts.frames));
  }

  static std::optional<double> share(const RunRecord& run, const std::string& path) {
    const auto calls = run.value(path + "calls");
    const auto call = run.value(path + "cycles.parallel.mean");
    const auto frame = run.value("frame.cycles.parallel.mean");
    const double number = frames(run);  // 0 for cycles measured elsewhere
    if (!calls || !call || !frame || *frame == 0 || number == 0) return std::nullopt;
    return 100 * *calls * *call / number / *frame;
  }

  void compare_work(const std::string& path, StageComparison& c) const {
    c.operations = of("operations", "1", path + "operations");
    c.same_work = c.calls.a == c.calls.b && c.operations.a == c.operations.b;
    const std::string ops = path + "ops.";
    for (const Statistic& s : a_.statistics) {
      if (s.name.rfind(ops, 0) != 0) continue;
      const auto in_b = b_.value(s.name);
      if (in_b && in_b != s.value) c.same_work = false;
    }
    for (const work::OffloadKindInfo& kind : work::kOffloadKinds) {
      const std::string calls = fmt::format("{}served.{}.calls", path, kind.name);
      const bool in_a = a_.value(calls).value_or(0) > 0;
      const bool in_b = b_.value(calls).value_or(0) > 0;
      if (in_a != in_b)
        c.offloaded.push_back(
            fmt::format("{} to {}", in_b ? "offloaded" : "no longer offloaded", kind.name));
    }
  }

  static ComparedQuantity& part_of(ComparedQuantity& whole, const std::string& name) {
    for (ComparedQuantity& part : whole.parts)
      if (part.name == name) return part;
    return whole.parts.emplace_back(ComparedQuantity{name, whole.unit, 0.0, 0.0});
  }

  std::string stage_name(const std::string& key) const {
    for (const StageName& stage : stages())
      if (stage.key == key) return stage.name;
    return key == "cluster_idle" ? "cluster idle" : key;
  }

  /// "stages.epnp_ransac.memory.block.scratch" → "EPnP RANSAC: scratch".
  std::string block_name(const std::string& statistic) const {
    constexpr std::string_view kBlock = ".block.";
    const auto at = statistic.find(kBlock);
    const std::string block = statistic.substr(at + kBlock.size());
    std::string owner = statistic.substr(0, at);
    for (const std::string_view prefix : {"stages.", "memory.l2."})
      if (owner.rfind(prefix, 0) == 0) owner = owner.substr(prefix.size());
    if (const auto dot = owner.find('.'); dot != std::string::npos) owner.resize(dot);
    return fmt::format("{}: {}", stage_name(owner), block);
  }

  const RunRecord& a_;
  const RunRecord& b_;
};

void collect_leaves(const ComparedQuantity& q, const std::string& prefix,
                    std::vector<Leaf>& leaves) {
  for (const ComparedQuantity& part : q.parts) {
    const std::string name = prefix.empty() ? part.name : prefix + ": " + part.name;
    if (part.parts.empty())
      leaves.push_back({name, part.b.value_or(0) - part.a.value_or(0)});
    else
      collect_leaves(part, name, leaves);
  }
}

constexpr const char* kUnit = "cycles";

/// What is below a thousandth of a cycle in every row of a file is no rest.
constexpr double kNoRest = 1e-6;

ComparedQuantity& part(ComparedQuantity& whole, const std::string& name) {
  const auto it = std::find_if(whole.parts.begin(), whole.parts.end(),
                               [&](const ComparedQuantity& q) { return q.name == name; });
  if (it != whole.parts.end()) return *it;
  return whole.parts.emplace_back(ComparedQuantity{name, kUnit, 0.0, 0.0});
}

/// Where a part stands in a tree: names from the top.
using Path = std::vector<std::string>;

Path mechanism_path(const CyclePart& p) {
  const std::string serial(sim::kSerialFork);
  if (p.where == sim::kSerialFork)
    return p.operation.empty() ? Path{serial, p.mechanism}
                               : Path{serial, p.mechanism + ' ' + p.operation};
  return p.operation.empty() ? Path{p.mechanism} : Path{p.mechanism, p.operation};
}

Path fork_path(const CyclePart& p) {
  return {p.where.empty() ? kOutsideForks : p.where, p.mechanism};
}

void add_parts(ComparedQuantity& whole, const StageParts* stage, double frames,
               Path (*path)(const CyclePart&), std::optional<double> ComparedQuantity::*side) {
  if (stage == nullptr || frames == 0) return;
  whole.*side = stage->cycles / frames;
  double listed = 0;
  for (const CyclePart& p : stage->parts) {
    const double cycles = p.cycles / frames;
    listed += cycles;
    ComparedQuantity* node = &whole;
    for (const std::string& name : path(p)) {
      node = &part(*node, name);
      *(node->*side) += cycles;
    }
  }
  const double rest = stage->cycles / frames - listed;
  if (std::abs(rest) > kNoRest * stage->cycles / frames) *(part(whole, "rest").*side) += rest;
}

ComparedQuantity split(const StageParts* a, const StageParts* b, double frames_a, double frames_b,
                       Path (*path)(const CyclePart&)) {
  ComparedQuantity whole{a != nullptr ? a->stage : b != nullptr ? b->stage : "", kUnit, 0.0, 0.0};
  add_parts(whole, a, frames_a, path, &ComparedQuantity::a);
  add_parts(whole, b, frames_b, path, &ComparedQuantity::b);
  // Ops that cost nothing in both runs explain nothing.
  for (ComparedQuantity& q : whole.parts)
    std::erase_if(q.parts,
                  [](const ComparedQuantity& leaf) { return *leaf.a == 0 && *leaf.b == 0; });
  std::erase_if(whole.parts, [](const ComparedQuantity& q) { return *q.a == 0 && *q.b == 0; });
  return whole;
}

const CyclePart* find(const StageParts* stage, const CyclePart& like) {
  if (stage == nullptr) return nullptr;
  const auto it = std::find_if(stage->parts.begin(), stage->parts.end(), [&](const CyclePart& p) {
    return p.mechanism == like.mechanism && p.operation == like.operation && p.where == like.where;
  });
  return it == stage->parts.end() ? nullptr : &*it;
}

/// How often the operation of a part occurs in a run, which may charge nothing for it by this
/// mechanism.
double count_of(const StageParts* stage, const CyclePart& like) {
  if (stage == nullptr || like.operation.empty()) return 0;
  for (const CyclePart& p : stage->parts)
    if (p.operation == like.operation && p.where == like.where && p.count != 0) return p.count;
  return 0;
}

/// Of one part; counts and cycles are those of a frame.
Causes causes_of(double count_a, double cycles_a, double count_b, double cycles_b) {
  const double difference = cycles_b - cycles_a;
  if (count_a == 0 && count_b == 0) return {0, 0, difference};
  const double work = count_a == 0 ? cycles_b : (count_b - count_a) / count_a * cycles_a;
  return {work, difference - work, 0};
}

}  // namespace

std::optional<double> ComparedQuantity::difference() const {
  if (!a || !b) return std::nullopt;
  return *b - *a;
}

std::optional<double> ComparedQuantity::percent() const {
  if (!a || !b || *a == 0) return std::nullopt;
  return 100 * (*b - *a) / *a;
}

Causes& Causes::operator+=(const Causes& o) {
  work += o.work;
  cost += o.cost;
  contention += o.contention;
  return *this;
}

bool RunComparison::same_work() const {
  return std::all_of(stages.begin(), stages.end(),
                     [](const StageComparison& s) { return s.same_work; });
}

RunComparison compare_runs(const RunRecord& a, const RunRecord& b, std::vector<std::string> notes) {
  const Comparer comparer(a, b);
  RunComparison c{a, b, std::move(notes), comparer.figures(), {}, {}, comparer.blocks(), {}, {}};
  for (const StageName& name : comparer.stages()) c.stages.push_back(comparer.stage(name));
  c.frame = comparer.frame(c.stages);
  c.energy_by_stage = comparer.energy(false);
  c.energy_by_domain = comparer.energy(true);
  return c;
}

std::vector<Leaf> leaves_by_difference(const ComparedQuantity& whole) {
  std::vector<Leaf> leaves;
  collect_leaves(whole, "", leaves);
  std::stable_sort(leaves.begin(), leaves.end(), [](const Leaf& x, const Leaf& y) {
    return std::abs(x.difference) > std::abs(y.difference);
  });
  return leaves;
}

ComparedQuantity split_by_mechanism(const StageParts* a, const StageParts* b, double frames_a,
                                    double frames_b) {
  return split(a, b, frames_a, frames_b, mechanism_path);
}

ComparedQuantity split_by_fork(const StageParts* a, const StageParts* b, double frames_a,
                               double frames_b) {
  return split(a, b, frames_a, frames_b, fork_path);
}

Causes split_by_cause(const StageParts* a, const StageParts* b, double frames_a, double frames_b) {
  static const StageParts kNone;
  Causes sum;
  const auto per = [](double value, double frames) { return frames == 0 ? 0 : value / frames; };
  const auto add = [&](const CyclePart* in_a, const CyclePart* in_b) {
    const CyclePart& any = in_a != nullptr ? *in_a : *in_b;
    const double cycles_a = in_a != nullptr ? in_a->cycles : 0;
    const double cycles_b = in_b != nullptr ? in_b->cycles : 0;
    sum += causes_of(per(count_of(a, any), frames_a), per(cycles_a, frames_a),
                     per(count_of(b, any), frames_b), per(cycles_b, frames_b));
  };
  for (const CyclePart& p : (a != nullptr ? *a : kNone).parts) add(&p, find(b, p));
  for (const CyclePart& p : (b != nullptr ? *b : kNone).parts)
    if (find(a, p) == nullptr) add(nullptr, &p);
  const double total = per((b != nullptr ? *b : kNone).cycles, frames_b) -
                       per((a != nullptr ? *a : kNone).cycles, frames_a);
  sum.contention += total - sum.total();
  return sum;
}

}  // namespace leviosim::tools
