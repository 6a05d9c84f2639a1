// The figures of a run that verdicts, comparisons and budgets read: its statistics, those that need
// every frame or every memory, and what its frames say of the map. They are the same whether the
// run lies in memory or its folder was read (record/record.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/app/result/run_result.h"

namespace leviosim::tools {

struct Statistic {
  std::string name;
  std::string unit = {};
  std::string description = {};
  std::optional<double> value = {};  ///< absent where the run has none
  std::string protocol = {};         ///< of accuracy, how it was measured; else empty
};

/// A figure of a run as a whole that has a name for people. Budgets, comparisons, the history,
/// summaries and pages walk over the rows, so a further figure is a row with `of`.
struct FigureRow {
  std::string_view statistic;
  std::string_view unit;             ///< of the statistic
  std::string_view phrase = {};      ///< in budgets; empty: in none
  std::string_view title = {};       ///< where runs are compared; empty: nowhere
  std::string_view title_unit = {};  ///< there
  double scale = 1;                  ///< to that unit
  bool more_is_better = false;
  // Of a figure that is computed nowhere else; it stands in summaries and on pages by its title.
  std::string_view meaning = {};
  /// Absent if the run has none.
  std::optional<double> (*of)(const RunResult& run) = nullptr;
};
/// In the order in which comparisons list them.
std::span<const FigureRow> figure_rows();

/// A stage, by its name for people and as statistics name it.
struct StageName {
  std::string name;  ///< "EPnP RANSAC"; the key where stages.csv is missing
  std::string key;   ///< "epnp_ransac"
  bool on_controller = false;
};

/// A frame of the camera, as a row of frames.csv has it.
struct RecordedFrame {
  int number = 0;  ///< in the data set, or of the camera
  std::int64_t t_ns = 0;
  std::optional<PoseSource> source;  ///< absent if it was dropped
  int features = 0;
  int map_restarts = 0;
  std::optional<int> health;  ///< of the map, as vio::Health numbers it; absent if not recorded
  int health_reasons = 0;     ///< bits of vio::HealthReason
  int path_mm = 0;            ///< length of the path so far, as the estimator knows it [mm]
  int path_deviation_mm = 0;  ///< standard deviation of that length [mm]
  vio::PoseState state = vio::PoseState::Located;  ///< of its pose
  bool at_rest = false;
};

/// Comparison of a run with the ground truth; empty without one.
struct TruthSigns {
  std::optional<double> error_m{};    ///< RMSE of the positions
  std::optional<double> path_m{};     ///< length of the true path
  std::optional<double> scale{};      ///< size of the estimated path over that of the true one
  std::optional<double> located_m{};  ///< error_m without guesses, if there are any
  std::optional<double> tilt_deg{};   ///< RMSE of the vertical, attitudes best aligned
};

/// Frames, by their numbers.
struct FrameSpan {
  int first = 0;
  int last = 0;
  std::int64_t frames = 0;  ///< those of them that are meant
};

/// Evidence for the verdict on the map.
struct MapSigns {
  bool has_poses = true;  ///< of a workload without, there is nothing to judge
  TruthSigns truth;
  double kept_s = 0;                ///< longest time without a new pose [s]
  double initialising_s = 0;        ///< longest initialisation [s]
  bool ends_without_pose = false;   ///< the last frame kept its pose, or still initialises
  std::int64_t restarts = 0;        ///< of the map
  double duration_s = 0;            ///< of the run [s]
  std::int64_t poses_left_out = 0;  ///< poses that are NaN
  std::optional<double> features;   ///< mean number of features of a frame
  std::optional<int> health;        ///< of the last frame
  int health_reasons = 0;           ///< likewise
  /// By number of the reason: the frame from which on it holds until the end.
  std::array<int, vio::kHealthReasons.size()> reason_since{};
  /// By number of the reason: the frames in which it held, if it does not any more at the end.
  std::array<std::optional<FrameSpan>, vio::kHealthReasons.size()> past_reasons{};
  std::optional<double> own_path_m;        ///< length of the path as the estimator knows it
  std::optional<double> path_deviation_m;  ///< standard deviation of that length
  FrameSpan lost;                          ///< frames of health 2, lost
  std::int64_t guesses = 0;                ///< poses from before there was a map
  std::optional<int> located_from;         ///< the frame after all guesses, if they come first
  std::optional<int> at_rest_since;  ///< the frame from which on the vehicle rests until the end
};

enum class Grade { good, unknown, doubtful, bad };
/// "good", "unknown", "doubtful", "bad": in files.
std::string_view name_of(Grade grade);

struct RunVerdict {
  std::string_view about;  ///< "time", "memory", "map"
  Grade grade = Grade::good;
  std::vector<std::string> reasons;

  std::string_view word() const;  ///< "fits on average"
  std::string reason() const;     ///< the reasons in a row; may be empty
  std::string text() const;       ///< "map lost: the error is 37.8 % of the path"
};

struct Verdicts {
  std::vector<RunVerdict> list;  ///< time, memory, map, as far as there is something to judge

  /// The worst; good only if all are.
  Grade grade() const;
  /// One line, the worst first. "no frames" if there is nothing to judge.
  std::string text() const;
};

struct RunFigures {
  std::vector<StageName> stages = {};  ///< in the order of the run
  std::vector<Statistic> statistics = {};
  Verdicts verdicts = {};  ///< verdict.h
  MapSigns map = {};       ///< of a run in memory; files hold the verdicts that come of it

  /// Null if there is none of that name.
  const Statistic* find(std::string_view statistic) const;
  /// Absent also if there is no such statistic.
  std::optional<double> value(std::string_view statistic) const;
};

/// All frames that arrived.
std::vector<RecordedFrame> recorded_frames(const RunResult& run);

/// Adds to the statistics of run.json what follows from them and from all frames: the peaks of L1
/// and L2, operations of stages, the signs of the map, and the verdicts as grades (verdict.*).
void complete(RunFigures& run, const std::vector<RecordedFrame>& frames);

/// The stage of the cluster with the highest peak of L1; null if there is none.
const StageName* fullest_stage(const RunFigures& run);

/// Time between two frames of the camera [ns].
double deadline_ns(const RunFigures& run);

}  // namespace leviosim::tools
