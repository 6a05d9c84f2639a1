#include "tools/app/record/cycle_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/chip/account.h"

namespace leviosim::tools {
namespace {

/// As the file has it, so that a run and its folder say the same.
double rounded_part(double value) { return std::round(value * 1e3) / 1e3; }

template <class Keep>
StageParts folded_unless(const StageParts& stage, Keep&& keep) {
  StageParts result{stage.stage, stage.on_controller, stage.cycles, {}};
  CyclePart other{"", std::string(kOtherParts), "", 0, 0};
  for (const CyclePart& part : stage.parts) {
    if (part.mechanism != kOtherParts && keep(part))
      result.parts.push_back(part);
    else
      other.cycles += part.cycles;
  }
  other.cycles = rounded_part(other.cycles);
  if (other.cycles != 0) result.parts.push_back(other);
  return result;
}

/// @param share  cycles of the stage in a cycle of the fork's account
void add_fork(std::vector<CyclePart>& parts, const sim::ForkAccount& fork, double share) {
  const auto add = [&](std::string_view mechanism, std::string_view operation, double cycles,
                       double count) {
    cycles = rounded_part(cycles * share);
    if (cycles != 0 || count != 0)
      parts.push_back({fork.name, std::string(mechanism), std::string(operation), cycles, count});
  };
  for (std::size_t i = 0; i < sim::kOperationCount; ++i) {
    const sim::OperationAccount& operation = fork.operations[i];
    const bool costs = operation.cycles.total() != 0;
    for (const sim::MechanismInfo& info : sim::kMechanisms) {
      if (sim::index(info.mechanism) >= sim::kLoneMechanismCount) continue;
      const double cycles = operation.cycles[info.mechanism];
      if (costs ? cycles != 0 : info.mechanism == sim::Mechanism::Issue)
        add(info.key, sim::operation_name(i), cycles, operation.count);
    }
  }
  for (const sim::MechanismInfo& info : sim::kMechanisms)
    if (sim::index(info.mechanism) >= sim::kLoneMechanismCount)
      add(info.key, "", fork.cycles[info.mechanism], 0);
}

/// A stage in total, or a part of it.
struct CycleRow {
  const StageParts& stage;
  CyclePart part;
};

}  // namespace

std::string_view describe_mechanism(std::string_view key) {
  if (key == kOtherParts) return "small parts of a baseline";
  for (const sim::MechanismInfo& info : sim::kMechanisms)
    if (info.key == key) return info.meaning;
  return {};
}

std::vector<StageParts> cycle_parts(const RunResult& run) {
  std::vector<StageParts> result;
  for (const StageResult& stage : run.stages) {
    if (stage.calls == 0) continue;
    StageParts& parts = result.emplace_back(StageParts{
        stage.name, stage.on_controller, static_cast<double>(stage.parallel.count()), {}});
    for (const sim::ForkAccount& fork : stage.account.forks)
      add_fork(parts.parts, fork, fork.weight / (stage.on_controller ? 1 : run.cores));
  }
  if (const auto cycles = static_cast<double>(run.offload.count()); cycles != 0)
    result.push_back({kOffloadStage, false, cycles, {{"", "offload", "", cycles, 0}}});
  return result;
}

StageParts folded(const StageParts& stage, double least_share) {
  return folded_unless(stage, [&](const CyclePart& part) {
    return std::abs(part.cycles) >= least_share * stage.cycles;
  });
}

StageParts folded_like(const StageParts& stage, const StageParts& other) {
  return folded_unless(stage, [&](const CyclePart& part) {
    return std::any_of(other.parts.begin(), other.parts.end(), [&](const CyclePart& p) {
      return p.where == part.where && p.mechanism == part.mechanism &&
             p.operation == part.operation;
    });
  });
}

Table cycle_rows(const std::vector<StageParts>& stages) {
  using R = CycleRow;
  static const Columns<R> columns{
      {{.key = "stage"}, [](const R& r) { return r.stage.stage; }},
      {{.key = "runs_on"},
       [](const R& r) { return r.stage.on_controller ? "controller" : "cluster"; }},
      {{.key = "where"}, [](const R& r) { return r.part.where; }},
      {{.key = "mechanism"}, [](const R& r) { return r.part.mechanism; }},
      {{.key = "operation"}, [](const R& r) { return r.part.operation; }},
      {{.key = "cycles", .decimals = 3}, [](const R& r) { return r.part.cycles; }},
      {{.key = "count", .decimals = 0}, [](const R& r) { return r.part.count; }},
  };
  std::vector<R> rows;
  for (const StageParts& stage : stages) {
    rows.push_back({stage, {"", "total", "", stage.cycles, 0}});
    for (const CyclePart& part : stage.parts) rows.push_back({stage, part});
  }
  return table_of(columns, rows);
}

}  // namespace leviosim::tools
