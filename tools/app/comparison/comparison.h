// The difference of two runs as a tree of quantities: each has its value in run A and in run B, and
// parts whose values add up to it; so do the differences. Plain data; comparison_report.cpp prints
// it.
//
// Cycles are those of a mean frame on N cores. They are split twice: by mechanism and kind of
// operation, and by fork. A third split is by cause: work, its cost, and contention.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/app/record/record.h"

namespace leviosim::tools {

struct ComparedQuantity {
  std::string name;
  std::string unit;
  std::optional<double> a;  ///< absent if the run has none
  std::optional<double> b;
  std::vector<ComparedQuantity> parts = {};  ///< all or none of it

  /// B minus A; absent if one of them is.
  std::optional<double> difference() const;
  /// The difference in per cent of A; absent also if A is 0.
  std::optional<double> percent() const;
};

/// A difference of cycles, split by cause.
struct Causes {
  double work = 0;        ///< change of the numbers of operations, at their cost in A
  double cost = 0;        ///< change of the cost of an operation, at the numbers of B
  double contention = 0;  ///< change of the waits for shared units, for each other, for the DMA

  double total() const { return work + cost + contention; }
  Causes& operator+=(const Causes& o);
};

/// The part for waits of the team between forks: transfers.
inline constexpr const char* kOutsideForks = "outside of forks";

struct StageComparison {
  StageName stage;
  ComparedQuantity calls;
  ComparedQuantity single;      ///< cycles of a call on one core
  ComparedQuantity parallel;    ///< … on N cores
  ComparedQuantity share;       ///< of the cycles of a frame, in per cent; none on the controller
  ComparedQuantity operations;  ///< of all calls
  bool same_work = true;
  /// Accelerators that serve the stage in one of the runs only: "offloaded to hamming".
  std::vector<std::string> offloaded = {};
  /// Cycles of a mean frame. Parts: mechanisms, and in them kinds of operation; absent if one of
  /// the runs has no breakdown.
  std::optional<ComparedQuantity> mechanisms;
  /// The same by fork, with mechanisms as parts.
  std::optional<ComparedQuantity> forks;
  Causes causes;
};

struct RunComparison {
  const RunRecord& a;
  const RunRecord& b;
  std::vector<std::string> notes;
  std::vector<ComparedQuantity> figures;  ///< of the run as a whole
  std::vector<StageComparison> stages;
  ComparedQuantity frame;  ///< cycles of a mean frame on N cores; parts: the cluster's stages
  /// Blocks of memory at a peak that are in one run only, or differ in size.
  std::vector<ComparedQuantity> blocks;
  ComparedQuantity energy_by_stage;  ///< mJ of a frame
  ComparedQuantity energy_by_domain;

  bool same_work() const;
};

/// @param a,b    outlive the comparison
/// @param notes  of check_comparable()
RunComparison compare_runs(const RunRecord& a, const RunRecord& b,
                           std::vector<std::string> notes = {});
RunComparison compare_runs(RunRecord&&, const RunRecord&, std::vector<std::string> = {}) = delete;
RunComparison compare_runs(const RunRecord&, RunRecord&&, std::vector<std::string> = {}) = delete;
RunComparison compare_runs(RunRecord&&, RunRecord&&, std::vector<std::string> = {}) = delete;

/// A part of a tree that has no parts itself, named with the parts that it is in.
struct Leaf {
  std::string name;
  double difference = 0;
};
/// All of them, the largest difference first. What is absent in a run counts as 0.
std::vector<Leaf> leaves_by_difference(const ComparedQuantity& whole);

}  // namespace leviosim::tools
