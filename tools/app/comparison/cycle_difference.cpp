#include "tools/app/comparison/cycle_difference.h"

#include <algorithm>
#include <cmath>

namespace leviosim::tools {
namespace {

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
