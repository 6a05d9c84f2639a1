// How far a sweep is and how long the rest takes: points that are done or open, and, timed on one
// that is open, the shares that make tasks of a wanted length. Of a sweep that begins, how long its
// points will take, by the first of them. Writes no file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tools/app/cli/progress_line.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/table/json.h"

namespace leviosim::tools {

struct SweepStatus {
  std::int64_t points = 0;
  std::int64_t done = 0;                  ///< with those that failed
  std::int64_t failed = 0;                ///< done, but cannot run
  std::optional<double> seconds_a_point;  ///< of one core of this host; none if nothing is open

  std::int64_t open() const { return points - done; }
  /// As many as make tasks of that length; at least 1.
  std::int64_t shares(double task_seconds) const;
};

/// @param folder  of the sweep, or of folders with its shares; empty or missing: nothing is done
/// @param time    computes an open point by its place in `points`
/// @throws InputError for a sweep of other points
SweepStatus sweep_status(const std::filesystem::path& folder, const std::vector<SweepPoint>& points,
                         const std::function<void(std::size_t point)>& time);

/// Says once on stderr how long a sweep takes, as soon as it is known.
class SweepEstimate {
 public:
  /// @param points   to be computed; of a few nothing is said
  /// @param threads  that do; 0: as many as the host has cores
  SweepEstimate(std::size_t points, unsigned threads, ProgressLine::Style style)
      : points_(points), threads_(threads), style_(style) {}

  /// A point took so long. The first one also read what all need, so the second is waited for.
  void take(double seconds);

 private:
  std::size_t points_;
  unsigned threads_;
  ProgressLine::Style style_;
  std::mutex mutex_;
  int taken_ = 0;
  double least_s_ = 0;
};

/// For people: the answer, and the shares. @param plan  as it was named
std::string status_text(const SweepStatus& status, const std::string& plan, double task_seconds);
Json status_json(const SweepStatus& status, double task_seconds);

}  // namespace leviosim::tools
