// A recorded run on other chips: each variant is a replay of the one trace, or, where its work
// would be another (divided among other cores, in other tiles through L1), the run again.
//
// Left out: what another timing changes in the computation of a replay (../../run/trace_source.h).
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/comparison/main_causes.h"
#include "tools/app/html_report/page.h"
#include "tools/app/result/summary.h"
#include "tools/app/run/known_runs.h"
#include "tools/app/study/runner.h"
#include "tools/app/study/sweep/plan.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_inputs.h"

namespace leviosim::tools {

/// Begins the keys of settings that change the chip.
inline constexpr std::string_view kChipSettings = "platform.";

struct Variant {
  std::string name;   ///< as asked for: "cluster.fpu.units=2"
  SweepRow settings;  ///< "platform", "platform.…"; the rest is the run's
  std::vector<std::string> raised =
      {};  ///< "cluster.max_workers=16": what the change needs besides
};

/// What became of a variant.
struct VariantResult {
  std::string name;
  std::vector<std::string> raised;  ///< as of the variant
  std::string failure;              ///< why it cannot run; then there are no figures
  FrameTimes times;  ///< of frames by themselves, without the time they wait for the one before
  std::size_t frames = 0;
  double period_ms = 0;  ///< of the camera
  Verdicts verdicts;
  std::vector<std::string> tiled;  ///< stages whose blocks pass through a memory in tiles
  std::optional<Banded> energy_mj;
  std::optional<double> area_mm2;
  bool is_whole_area = true;  ///< else parts are unknown
  bool is_run = false;        ///< computed again, not replayed
  TimedParts parts;
  std::vector<std::string> unused;  ///< accelerators that served nothing: "hamming of the cluster"

  double mean_ms() const { return times.mean_ns.value * 1e-6; }
  /// What is not good: "3 late", "too slow, map lost"; "fits" if all is. With "?" where the band of
  /// the time holds the period.
  std::string verdict() const;
};

/// A run that is asked what if.
class WhatIf {
 public:
  /// @param trace   as inputs.trace() takes it, or has been given
  /// @param again   the settings that compute the run again, "data" and so on; empty if not known
  /// @param inputs  outlives this
  WhatIf(SweepInputs& inputs, std::string trace, SweepRow again);

  /// "cluster.fpu.units=2,4,8": three; "gap9-eigen", "mine.yaml"; "gap9:cluster.workers=4";
  /// "A=1,B=2": both at once. What a number of cores needs besides is raised with it.
  /// @throws InputError for names that do not exist
  std::vector<Variant> variants(const std::string& change);
  /// A standard set, made of what the platform has: each resource halved and doubled, both clocks
  /// halved, other numbers of cores, accelerators of built-in platforms.
  std::vector<Variant> standard_variants();

  /// The run as it is, then the variants in their order. @throws Interrupted
  std::vector<VariantResult> results(const std::vector<Variant>& variants,
                                     const RunnerOptions& options);

 private:
  void expect_known(const std::string& change, const SweepRow& settings);
  /// A recording holds its chip without the file that the chip extends. Where that is a built-in
  /// chip without changes, a change of what it extends is one of the built-in chip.
  void name_chip(Variant& variant);
  /// An event unit for as many cores as are asked for.
  void raise_event_unit(Variant& variant);
  /// @param anew  the work is computed again, for it is another on this chip
  ResolvedPoint resolved(const Variant& variant, bool anew = false);
  /// Whether a variant changes the size of L1.
  bool has_other_l1(const SweepRow& settings, const sim::ChipConfig& chip);
  /// Whether the recorded work passes through L1 in tiles, so that another L1 makes it another.
  bool passes_in_tiles();

  SweepInputs& inputs_;
  std::string trace_;
  SweepRow again_;
  SweepPlan plan_;
  KnownRuns known_;
  std::optional<Bytes> recorded_l1_;  ///< once it was needed
  std::optional<bool> passes_in_tiles_;
  std::mutex resolving_;  ///< inputs_ remembers what it has read
};

}  // namespace leviosim::tools
