// Figures that are derived from a run when it is read out: means, speed-ups, latencies of the kinds
// of frame, shares of core-cycles, occupation. Tables, statistics and CSV files share them.
#pragma once

#include <cstdint>
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

/// Number of poses of a trajectory without gaps: of the frames that the camera delivered.
std::size_t expected_poses(const RunResult& run);
/// Why the run has no error that could be compared with another's; empty if it may have one.
std::string why_incomparable(const RunResult& run);
/// The poses that are no guesses; nothing if all are, none is, or so few are that their alignment
/// would fit them, whatever they are.
std::optional<traces::Trajectory> located_poses(const RunResult& run);
/// Least number of poses for an alignment.
inline constexpr std::size_t kFewestPoses = 3;

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

/// Times that frames take on the chip by themselves, without waiting for others, whatever the
/// camera.
struct FrameTimes {
  Banded mean_ns;
  Banded p99_ns;
  Banded worst_ns;
  std::int64_t late = 0;  ///< frames that take longer than the camera's period
  bool has_bands = false;

  /// Largest frame rate at which frames do not queue up [1/s].
  double sustainable_rate() const { return 1e9 / mean_ns.value; }
};
/// Absent if nothing was timed.
std::optional<FrameTimes> frame_times(const RunResult& run);

/// Frames that found the front end busy.
struct Waiting {
  std::int64_t frames = 0;
  std::int64_t longest_ns = 0;
};
Waiting frames_that_waited(const RunResult& run);

/// What the breakdown of a run's stages is by: the mechanisms of cores that its chip has.
std::vector<sim::MechanismInfo> breakdown_parts(const RunResult& run);

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

/// "121.9 of 131.1 kB", for people: whether it fits is plain, which a share of the nominal size,
/// that may be 102 % of a memory with room left, does not show.
std::string of_memory(Bytes used, Bytes size);

/// The value with so many decimals; of a path that diverged, three digits instead of twenty.
std::string readable(double value, int decimals);

/// Length of the estimated path [m].
double path_length(const std::vector<traces::StampedPose>& trajectory);
/// Whether the workload says where the body is: one that does not leaves it at the origin, and is
/// not compared with a truth.
bool has_poses(const RunResult& run);

}  // namespace leviosim::tools
