// Figures that are derived from a run when it is read out: means, speed-ups, latencies of the kinds
// of frame, shares of core-cycles, occupation. Tables, statistics and CSV files share them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/app/result/run_result.h"

namespace leviosim::tools {

/// "EPnP RANSAC" → "epnp_ransac", for names in files.
std::string key_of(std::string_view name);

/// Absent if there were no calls.
std::optional<double> mean(Cycles sum, std::int64_t calls);
/// One core over N cores; absent if there were no calls.
std::optional<double> speedup(const StageResult& stage);
/// Of its cycles on one core, the share of work segments none of whose functions was measured as
/// compiled code; absent if there were no calls.
std::optional<double> unmeasured_share(const StageResult& stage);
/// Of the domain that the stage runs in.
Hertz clock_of(const RunResult& run, const StageResult& stage);
double milliseconds(double cycles, Hertz clock);

/// That a trajectory without gaps would have: of the frames that the camera delivered.
std::size_t expected_poses(const RunResult& run);
/// Why the run has no error that could be compared with another's; empty if it may have one.
std::string why_incomparable(const RunResult& run);

/// Frames of one kind and how long they took.
struct Scenario {
  std::string_view name;  ///< for people
  std::string_view key;   ///< in files
  std::int64_t frames = 0;
  std::int64_t latency_ns = 0;  ///< from the camera's frame to its pose, summed
  std::int64_t worst_latency_ns = 0;
  std::int64_t over_period = 0;  ///< frames whose latency exceeds the frame period
  Cycles single;                 ///< front end on one core, summed
  Cycles parallel;               ///< front end on N cores, summed

  std::optional<double> mean_latency_ns() const;
};

/// EPnP and 8-point, without and with keyframe; the same of frames whose pose was tracked, if there
/// are any; and last the rest (the first frame, and poses that were kept): every frame is in one of
/// them.
std::vector<Scenario> scenarios(const RunResult& run);

/// Frames that found the front end busy.
struct Waiting {
  std::int64_t frames = 0;
  std::int64_t longest_ns = 0;
};
Waiting frames_that_waited(const RunResult& run);

/// One part of a breakdown. All parts together are its total.
struct BreakdownPart {
  std::string_view key;
  std::string_view column;  ///< of the table that people read, which it is added to
  std::string_view description;
  double (*of)(const sim::CycleBreakdown&);
};
inline constexpr std::array kBreakdownParts{
    BreakdownPart{"issue", "useful", "issuing instructions of parallel work",
                  [](const sim::CycleBreakdown& a) { return a.useful.issue; }},
    BreakdownPart{"load_use", "useful", "waiting for loaded values",
                  [](const sim::CycleBreakdown& a) { return a.useful.load_use; }},
    BreakdownPart{"control", "useful", "pipeline refills after branches, calls and loop entries",
                  [](const sim::CycleBreakdown& a) { return a.useful.control; }},
    BreakdownPart{"memory", "useful", "L2 latency and straddling words",
                  [](const sim::CycleBreakdown& a) { return a.useful.memory; }},
    BreakdownPart{"arithmetic", "useful",
                  "latency of integer divisions and floating-point operations",
                  [](const sim::CycleBreakdown& a) { return a.useful.arithmetic; }},
    BreakdownPart{"fpu", "FPU", "waiting for a shared floating-point unit",
                  [](const sim::CycleBreakdown& a) { return a.fpu; }},
    BreakdownPart{"divider", "divider", "waiting for the shared divider",
                  [](const sim::CycleBreakdown& a) { return a.divider; }},
    BreakdownPart{"banks", "banks", "waiting for L1 banks",
                  [](const sim::CycleBreakdown& a) { return a.banks; }},
    BreakdownPart{"fetch", "I-cache", "waiting for code that the private instruction cache lacks",
                  [](const sim::CycleBreakdown& a) { return a.useful.fetch; }},
    BreakdownPart{"fetch_contention", "I-cache", "more of that, since other cores fetch as well",
                  [](const sim::CycleBreakdown& a) { return a.fetch; }},
    BreakdownPart{"imbalance", "imbalance", "waiting at the end of forks for the slowest core",
                  [](const sim::CycleBreakdown& a) { return a.imbalance; }},
    BreakdownPart{"synchronisation", "sync", "forking, waking up, barriers",
                  [](const sim::CycleBreakdown& a) { return a.synchronisation; }},
    BreakdownPart{"transfer", "transfer", "waiting for the DMA",
                  [](const sim::CycleBreakdown& a) { return a.transfer; }},
    BreakdownPart{"serial", "serial", "all cores, while the master works alone",
                  [](const sim::CycleBreakdown& a) { return a.serial; }},
    BreakdownPart{"rounding", "imbalance", "ends of shares moved to the next clock edge",
                  [](const sim::CycleBreakdown& a) { return a.rounding; }},
};

/// Those that there are on chips with accelerators only.
inline constexpr std::array kAcceleratorParts{
    BreakdownPart{"accelerator", "served", "waiting for accelerators while they serve the core",
                  [](const sim::CycleBreakdown& a) { return a.useful.accelerator; }},
    BreakdownPart{"accelerator_contention", "queue",
                  "waiting for accelerators while they serve others",
                  [](const sim::CycleBreakdown& a) { return a.accelerator; }},
};
/// All parts that a run has.
std::vector<BreakdownPart> breakdown_parts(const RunResult& run);

/// Blocks of one name, e.g. the scratch of the cores.
struct BlockGroup {
  std::string_view name;
  int copies = 0;
  Bytes bytes;  ///< of all copies
};
/// In the order of first appearance.
std::vector<BlockGroup> grouped(const std::vector<work::Block>& blocks);

/// Share of a memory in per cent, by the convention of the LEVIO paper: kilobytes of 1000 bytes, of
/// the memory's nominal size (128 kB for 131 072 bytes).
double percent_of_nominal(Bytes used, Bytes size);

/// Length of the estimated path [m].
double path_length(const std::vector<traces::StampedPose>& trajectory);

}  // namespace leviosim::tools
