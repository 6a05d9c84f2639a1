// Figures that are derived from a run when it is read out: means, speed-ups, latencies of the kinds
// of frame, shares of core-cycles, occupation. Tables, statistics and CSV files share them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/energy/model.h"
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
/// Poses that an alignment takes at least.
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

/// What frames take by themselves, without waiting for others: of the chip, whatever the camera.
struct FrameTimes {
  Banded mean_ns;
  Banded p99_ns;
  Banded worst_ns;
  std::int64_t late = 0;  ///< that take longer than the camera's period
  bool has_bands = false;

  /// At which frames do not pile up. [1/s]
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

/// With so many decimals; of a path that diverged, which may have twenty digits, three digits.
std::string readable(double value, int decimals);

/// Length of the estimated path [m].
double path_length(const std::vector<traces::StampedPose>& trajectory);

// What became of the frames of a closed loop, derived when it is read out: how many were lost or
// late, and how long a pose takes.
//
// The deadline of a frame is one period of the camera after its arrival. It is missed by frames
// that were dropped and by those whose pose came later: `missed` is both.

struct CameraFigures {
  std::int64_t arrived = 0;
  std::int64_t processed = 0;
  std::int64_t dropped = 0;
  std::int64_t late = 0;    ///< processed, but after the deadline
  std::int64_t waited = 0;  ///< processed, but not at once
  int most_found = 0;       ///< most frames that one found in the buffers
  /// From arrival to pose, of the processed frames; all 0 if there are none.
  struct Latencies {
    std::int64_t p50_ns = 0;
    std::int64_t p95_ns = 0;
    std::int64_t p99_ns = 0;
    std::int64_t max_ns = 0;
  } latency;

  std::int64_t missed() const { return dropped + late; }
  /// Of all arrived; 0 if none has.
  double share_of(std::int64_t frames) const;
};

/// Whether a processed frame missed its deadline.
bool is_late(const FrameResult& frame, const RunResult& run);

/// The least of the values that at least `share` of them do not exceed (nearest rank).
/// @param sorted  not empty
std::int64_t percentile(const std::vector<std::int64_t>& sorted, double share);

/// Of any run, whether its loop was open or closed.
CameraFigures::Latencies latencies_of(const RunResult& run);

/// Absent if the loop was open.
std::optional<CameraFigures> camera_figures(const RunResult& run);

// Energy of a run, derived when it is read out: of each stage, of the time in between, per frame,
// and the mean power at the camera's frame rate. Every joule is in one row and one domain.

/// A stage over the whole run, or the time without one.
struct EnergyRow {
  std::string name;
  std::string unit;  ///< what one call is
  bool on_controller = false;
  std::int64_t calls = 0;
  Seconds time;  ///< of all calls
  sim::DomainEnergies energy;

  /// Absent if there were no calls.
  std::optional<sim::Estimate<Joules>> per_call() const;
  /// Mean while it runs: the whole chip without the controller's core for a stage of the cluster,
  /// what the controller adds to that for one of the controller.
  std::optional<sim::Estimate<Watts>> power() const;
};

/// Name of the row for the time in which the cluster has no work.
inline constexpr const char* kIdle = "cluster idle";

struct RunEnergy {
  std::vector<EnergyRow> rows;  ///< the stages in the run's order, and last the idle time
  std::int64_t frames = 0;
  /// From the first frame to a period after the last, or what the front end took if that is longer;
  /// in a closed loop, until the last pose if that is later.
  Seconds time;

  sim::DomainEnergies total() const;
  std::optional<sim::Estimate<Joules>> per_frame() const;
  std::optional<sim::Estimate<Watts>> mean_power() const;
  /// Of the stages of the cluster while one of them runs, and of the controller while it works.
  std::optional<sim::Estimate<Watts>> power_of_front_end() const;
  std::optional<sim::Estimate<Watts>> power_of_controller() const;
};

/// Absent if the run was not timed, or its platform has no energy figures.
/// @param time  that it takes, if that is not the time of the run
std::optional<RunEnergy> energy_of(const RunResult& run, std::optional<Seconds> time = {});

/// The same cycles at another operating point: the faster of the two clocks runs at the clock of
/// the point, the other one in proportion. What another speed changes in the computation (a
/// result that is published a frame later) is left out; of a closed loop, where it also changes
/// which frames are processed, there is no such estimate.
std::optional<RunEnergy> energy_at(const RunResult& run, const sim::OperatingPoint& point);

}  // namespace leviosim::tools
