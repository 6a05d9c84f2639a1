// Facts about a frame besides its pose, each described once: CSV files,
// statistics, work traces and tables walk over these descriptions. A new fact is a member and a row
// of kFrameFacts.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace leviosim::vio {

enum class PoseSource : std::uint8_t {
  First,
  Epnp,
  EightPoint,
  Kept,
  Predicted,
  Tracked,
  Initialising
};

/// How far a pose can be trusted.
enum class PoseState : std::uint8_t {
  Located,      ///< computed from landmarks or features in view
  Predicted,    ///< moved on by the IMU, since too little was seen again
  Kept,         ///< that of the last keyframe, for lack of matches
  Initialising  ///< a guess: velocity, gravity and scale are not known yet
};

/// In files, by number.
inline constexpr std::array<std::string_view, 4> kPoseStateNames{"located", "predicted", "kept",
                                                                 "initialising"};

struct PoseSourceInfo {
  PoseSource source;
  std::string_view name;   ///< in files
  std::string_view words;  ///< for people
  int rank;                ///< there, from the usual to the rare
  std::string_view meaning;
  PoseState state = PoseState::Located;  ///< of its poses, as long as nothing corrects them
};

/// All of them, by number.
inline constexpr std::array kPoseSources{
    PoseSourceInfo{PoseSource::First, "first", "at rest or first of a map", 6,
                   "where a map begins; at rest, before the first window is full, anew each frame"},
    PoseSourceInfo{PoseSource::Epnp, "epnp", "EPnP", 1, "from matches with landmarks"},
    PoseSourceInfo{PoseSource::EightPoint, "eight_point", "8-point", 2,
                   "from matches with the previous keyframe"},
    PoseSourceInfo{PoseSource::Kept, "kept", "pose kept", 5,
                   "too few matches: the last keyframe's pose", PoseState::Kept},
    PoseSourceInfo{PoseSource::Predicted, "predicted", "predicted", 3,
                   "EPnP found too few inliers: the last keyframe's pose, moved on",
                   PoseState::Predicted},
    PoseSourceInfo{PoseSource::Tracked, "tracked", "tracked", 0,
                   "refined from landmarks that a predicted pose found, or from EPnP's pose"},
    PoseSourceInfo{PoseSource::Initialising, "initialising", "initialising", 4,
                   "moved on by the IMU before velocity, gravity and scale are known",
                   PoseState::Initialising},
};

constexpr PoseState state_of(PoseSource source) {
  return kPoseSources[static_cast<std::size_t>(source)].state;
}

constexpr std::string_view name_of(PoseSource source) {
  return kPoseSources[static_cast<std::size_t>(source)].name;
}

/// Absent for other words.
constexpr std::optional<PoseSource> source_named(std::string_view name) {
  for (const PoseSourceInfo& info : kPoseSources)
    if (info.name == name) return info.source;
  return std::nullopt;
}

/// The odometry's own judgement of its map, without ground truth (odometry/map_health.h).
enum class Health : std::uint8_t { good, unreliable, lost, not_judged };

/// In files, by number.
inline constexpr std::array<std::string_view, 4> kHealthNames{"good", "unreliable", "lost",
                                                              "not_judged"};

/// Why the odometry does not call its map good, numbered as kHealthReasons.
enum class HealthReason : std::uint8_t {
  NoScale,
  Inconsistent,
  Blind,
  FewInliers,
  AccelBias,
  Drift,
  Restarted
};

/// In what people read. Files have the sum of 1 << number over those that hold.
inline constexpr std::array<std::string_view, 7> kHealthReasons{
    "the scale is not known yet",
    "images and IMU contradict each other in the window",
    "no landmark has been seen for a while",
    "too few matches agree with the pose",
    "the accelerometer would have a bias that no sensor has",
    "the length of the path is uncertain",
    "the map was begun again"};

constexpr int bit(HealthReason reason) { return 1 << static_cast<int>(reason); }

struct FrameFacts {
  PoseSource source = PoseSource::First;
  bool keyframe = false;
  int features = 0;
  int world_matches = 0;
  int frame_matches = 0;
  int inliers = 0;
  int landmarks = 0;
  int map_restarts = 0;
  int places = 0;
  int places_removed = 0;
  int loop_closures = 0;
  int health = 0;             ///< as Health numbers it
  int health_reasons = 0;     ///< bits of HealthReason; 0 for a map that is good or not judged
  int path_mm = 0;            ///< length of the path so far, guesses excepted [mm]
  int path_deviation_mm = 0;  ///< its standard deviation, as the estimator knows it [mm]
  int at_rest = 0;  ///< 1: images, and the IMU but for idling rotors, show that the vehicle rests
  int state = 0;    ///< of the pose, as PoseState numbers it

  PoseState pose_state() const { return static_cast<PoseState>(state); }
};

/// FrameFacts::state after a later frame, of state `by`, has corrected the pose: a map that is
/// aligned locates it.
constexpr int state_after(int state, int by) {
  constexpr int kGuess = static_cast<int>(PoseState::Initialising);
  return state == kGuess && by != kGuess ? static_cast<int>(PoseState::Located) : state;
}

/// A number that is never negative.
struct FrameFact {
  std::string_view name;  ///< in files
  std::string_view meaning;
  int FrameFacts::*of;
  bool adds_up = true;                           ///< over frames
  std::span<const std::string_view> words = {};  ///< in CSV files, by number; else the number
};

inline constexpr std::array kFrameFacts{
    FrameFact{"features", "features in the image", &FrameFacts::features},
    FrameFact{"world_matches", "matches with landmarks, after the age filter",
              &FrameFacts::world_matches},
    FrameFact{"frame_matches", "matches with the last keyframe", &FrameFacts::frame_matches},
    FrameFact{"inliers", "inliers of the RANSAC that gave the pose", &FrameFacts::inliers},
    FrameFact{"landmarks", "landmarks alive after the frame", &FrameFacts::landmarks},
    FrameFact{"map_restarts", "restarts of the map, since what it had become could not be true",
              &FrameFacts::map_restarts},
    FrameFact{"places", "places that loop closure keeps", &FrameFacts::places},
    FrameFact{"places_removed", "places given up for this frame, where places lay densest",
              &FrameFacts::places_removed},
    FrameFact{"loop_closures", "loops closed with this frame", &FrameFacts::loop_closures},
    FrameFact{"health",
              "what the estimator knows of its map: 0 good, 1 unreliable, 2 lost, 3 nothing",
              &FrameFacts::health, false},
    FrameFact{
        "health_reasons",
        "why it is 1 or 2, summed: 1 no scale yet, 2 images and IMU contradict each other, 4 no "
        "landmark seen, 8 few matches agree, 16 accelerometer bias, 32 drift, 64 begun again",
        &FrameFacts::health_reasons, false},
    FrameFact{"path_mm", "length of the path so far, guesses excepted, mm", &FrameFacts::path_mm,
              false},
    FrameFact{"path_deviation_mm",
              "standard deviation of that length, as the estimator knows it, mm",
              &FrameFacts::path_deviation_mm, false},
    FrameFact{"at_rest", "the vehicle rests, as images and IMU show it", &FrameFacts::at_rest},
    FrameFact{"state", "what the pose is worth: located, predicted, kept, initialising (a guess)",
              &FrameFacts::state, false, kPoseStateNames},
};

}  // namespace leviosim::vio
