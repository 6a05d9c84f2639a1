#include "sim/chip/account.h"

#include <algorithm>

#include "sim/work/op.h"

namespace leviosim::sim {

std::string_view operation_name(std::size_t operation) {
  if (operation < kCodeOperation) return work::kOps[operation].name;
  if (operation == kCodeOperation) return "code";
  return work::kOffloadKinds[operation - kCodeOperation - 1].name;
}

ForkAccount& ForkAccount::operator+=(const ForkAccount& other) {
  cycles += other.cycles;
  for (std::size_t i = 0; i < kOperationCount; ++i) {
    operations[i].count += other.operations[i].count;
    operations[i].cycles += other.operations[i].cycles;
  }
  return *this;
}

ForkAccount& CycleAccount::fork(std::string_view name, double weight) {
  const auto it = std::find_if(forks.begin(), forks.end(),
                               [&](const ForkAccount& f) { return f.name == name; });
  if (it != forks.end()) return *it;
  ForkAccount& added = forks.emplace_back();
  added.name = name;
  added.weight = weight;
  return added;
}

CycleAccount& CycleAccount::operator+=(const CycleAccount& other) {
  team += other.team;
  for (const ForkAccount& of_other : other.forks) fork(of_other.name, of_other.weight) += of_other;
  return *this;
}

}  // namespace leviosim::sim
