// Frames of a closed loop that were dropped or late, and the latency of poses, derived from a run's
// result.
//
// The deadline of a frame is one period of the camera after its arrival. It is missed by frames
// that were dropped and by those whose pose came later: `missed` is both.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tools/app/result/run_result.h"

namespace leviosim::tools {

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
bool is_late(const soc::FrameTiming& frame, const RunSubject& run);

/// The least of the values that at least `share` of them do not exceed (nearest rank).
/// @param sorted  not empty
std::int64_t percentile(const std::vector<std::int64_t>& sorted, double share);

/// Of any run, whether its loop was open or closed.
CameraFigures::Latencies latencies_of(const RunResult& run);

/// Absent if the loop was open.
std::optional<CameraFigures> camera_figures(const RunResult& run);

}  // namespace leviosim::tools
