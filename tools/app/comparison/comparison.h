// Whether two runs can be compared: they must have processed the same data, frame by frame, with
// the same random draws, at the same size, by the same profile. Anything else may differ; what
// should be known about it is noted.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "tools/app/record/record.h"

namespace leviosim::tools {

/// Differences that the user does not mind: "data,seed".
using Allowed = std::set<std::string>;

/// @throws InputError for names that are none of chip, data, frames, profile, seed, size
Allowed parse_allowed(const std::string& text);

/// @returns notes: what else differs, and what was allowed to
/// @throws InputError naming each difference that is not allowed
std::vector<std::string> check_comparable(const RunRecord& a, const RunRecord& b,
                                          const Allowed& allowed);

/// Of a run and a baseline: limits of one chip say nothing of another. Settings of the chip and the
/// number of cores are what a user tries out, and may differ.
/// @throws InputError unless "chip" is allowed
void check_same_chip(const RunRecord& a, const RunRecord& b, const Allowed& allowed);

// Two builds of leviosim on the same input. What each leaves is compared as any two runs are; the
// new build also times the work that the old one recorded, so that it is known what of a difference
// is other work, another cost of the same work, and another number of the chip.

/// `PROGRAM run ARGUMENTS --record --quiet --out FOLDER`, for each in a folder of its own.
class TwoPrograms {
 public:
  /// @param programs   two
  /// @param arguments  of `leviosim run`, without --out and --record; closed loops are not recorded
  /// @throws InputError for other numbers of programs, and if one of them fails; Interrupted
  TwoPrograms(const std::vector<std::string>& programs, const std::vector<std::string>& arguments);
  ~TwoPrograms();
  TwoPrograms(const TwoPrograms&) = delete;
  TwoPrograms& operator=(const TwoPrograms&) = delete;

  /// Of the runs; removed with the object.
  const std::vector<std::string>& folders() const { return folders_; }
  /// "of +1.34 % of a frame: …": the split. Empty where nothing was recorded, or the new build
  /// does not take the old one's files.
  std::string split() const;

 private:
  /// Cycles of a mean frame of the old build's work, on a chip, by the new one.
  std::optional<double> cycles_of_replay(const std::string& platform) const;

  std::string new_program_;
  std::filesystem::path place_;
  std::vector<std::string> folders_;
};

// What differs between two runs, as a tree of quantities: each has its value in run A and in run B,
// and parts whose values add up to it. So do their differences. Plain data; comparison_report.cpp
// prints it.
//
// Cycles are those of a mean frame on N cores. They are split twice: by mechanism and kind of
// operation, and by fork. A third split is by cause: work, its cost, and contention.

struct ComparedQuantity {
  std::string name;
  std::string unit;
  std::optional<double> a;  ///< absent if the run has none
  std::optional<double> b;
  std::vector<ComparedQuantity> parts = {};  ///< all or none of it

  /// B minus A, absent where one of them is.
  std::optional<double> difference() const;
  /// Of A; absent also if that is 0.
  std::optional<double> percent() const;
};

/// Of a difference of cycles.
struct Causes {
  double work = 0;        ///< other numbers of operations, at their cost in A
  double cost = 0;        ///< the operations of B at their cost in B instead of that in A
  double contention = 0;  ///< cores that wait for shared units, for each other, for the DMA

  double total() const { return work + cost + contention; }
  Causes& operator+=(const Causes& o);
};

/// The name of what the team awaits between forks: transfers.
inline constexpr const char* kOutsideForks = "outside of forks";

struct StageComparison {
  StageName stage;
  ComparedQuantity calls;
  ComparedQuantity single;      ///< cycles of a call on one core
  ComparedQuantity parallel;    ///< … on N cores
  ComparedQuantity share;       ///< of the cycles of a frame, in per cent; none on the controller
  ComparedQuantity operations;  ///< of all calls
  bool same_work = true;
  /// What became of work that an accelerator serves in one of the runs only: "offloaded to
  /// hamming".
  std::vector<std::string> offloaded = {};
  /// Cycles of a mean frame. Parts: mechanisms, and in them kinds of operation; absent if of
  /// one of the runs it is not known where its cycles went.
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
  std::vector<ComparedQuantity>
      blocks;  ///< alive at a peak, that appeared, went, or changed their size
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

// The difference of the cycles of a stage in two runs, split by mechanism, by fork and by cause.
// What the parts leave over stands in a part of its own, "rest", so that all adds up.

/// @param frames_a,frames_b  that the cycles are divided by
ComparedQuantity split_by_mechanism(const StageParts* a, const StageParts* b, double frames_a,
                                    double frames_b);
ComparedQuantity split_by_fork(const StageParts* a, const StageParts* b, double frames_a,
                               double frames_b);
Causes split_by_cause(const StageParts* a, const StageParts* b, double frames_a, double frames_b);

// A comparison for people and programs: text of 80 columns, Markdown, CSV (a row per quantity of
// the tree), JSON (the tree). Text and Markdown show the largest parts and the sum of the others;
// CSV and JSON hold all.

enum class ReportFormat { text, markdown, json, csv };

/// @throws InputError for another name than text, markdown, json, csv
ReportFormat parse_report_format(const std::string& name);

std::string comparison_report(const RunComparison& comparison, ReportFormat format);
/// The same of several, one after the other; in JSON a list if there is more than one.
/// @param all  else text is the summary
std::string comparison_report(const std::vector<RunComparison>& comparisons, ReportFormat format,
                              bool all);

/// At most 24 lines of 80 columns: figures of the run, the stages that differ most, and the main
/// causes. More lines only for notes.
std::string comparison_summary(const RunComparison& comparison);

/// Cycles of a call, or of a frame, of a model beside what was measured.
struct ModelError {
  std::string stage;
  std::optional<double> measured;
  std::optional<double> model;
  std::optional<double> percent;  ///< of what was measured
};
/// Of each stage, and last of the frame, where one of the runs was measured (A, if both were).
std::vector<ModelError> model_errors(const RunComparison& comparison);

/// A table of them, and their mean.
std::string measured_report(const RunComparison& comparison, bool markdown);

/// "8-point hypotheses: issue +1.2 %": the parts of a stage that explain most of its difference,
/// each with its share of the stage's cycles in A.
/// @param most  of them at most
std::vector<std::string> reasons(const StageComparison& stage, std::size_t most);

/// The name of a part for people: what a mechanism is, else as it is.
std::string part_label(const std::string& name);

/// One line about the work: the same, or where it is not.
std::string work_line(const RunComparison& comparison);

// A comparison as JSON and CSV: every quantity of the tree.

Json comparison_json(const RunComparison& comparison);

/// subject,quantity,part,subpart,unit,a,b,difference; a row per quantity. Cells that hold commas or
/// quotes are quoted (RFC 4180).
std::string comparison_csv(const RunComparison& comparison);

}  // namespace leviosim::tools
