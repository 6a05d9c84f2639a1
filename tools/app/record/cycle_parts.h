// Breakdown of each stage's cycles on N cores, as rows: by fork, by mechanism and by kind of
// operation. They are the account of the run (sim/chip/account.h), in core-cycles over the cores of
// the team, so that the parts of a stage add up to its cycles.
//
// Left out: named functions within a fork. Work is counted between two synchronisation points, over
// all functions that run there (comparison/README.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/app/result/run_result.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

/// The cycles of a frame that belong to no stage: the controller calls the cluster and hears back.
inline constexpr const char* kOffloadStage = "offload";
/// In the place of a mechanism: small parts together, as a baseline has them.
inline constexpr std::string_view kOtherParts = "other";

/// Description of a mechanism. Empty for unknown keys.
std::string_view describe_mechanism(std::string_view key);

struct CyclePart {
  std::string where;      ///< name of a fork, sim::kSerialFork, or empty: outside of forks
  std::string mechanism;  ///< a key of sim::kMechanisms, or kOtherParts
  std::string operation;  ///< kind of operation or kernel; empty if it is not by operation
  double cycles = 0;      ///< of the stage, over all calls
  double count = 0;       ///< operations, bytes of code, items of kernels; 0: nothing to count
};

struct StageParts {
  std::string stage;
  bool on_controller = false;
  double cycles = 0;  ///< on N cores, over all calls
  std::vector<CyclePart> parts;
};

/// The stages that ran, in the order of the run, and last what is no stage's.
std::vector<StageParts> cycle_parts(const RunResult& run);

/// The same with parts below a share of the stage's cycles made one, the mechanism "other".
StageParts folded(const StageParts& stage, double least_share);
/// The same with all parts made one that another stage does not have.
StageParts folded_like(const StageParts& stage, const StageParts& other);

/// A row for the total of each stage and for each part of it.
Table cycle_rows(const std::vector<StageParts>& stages);

}  // namespace leviosim::tools
