// Parameters of the workload, as named profiles. `levio` is the faithful one (paper section III and
// the embedded release's parameters); what improves on it goes into other profiles.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "workload/graph/alignment.h"
#include "workload/graph/optimiser.h"
#include "workload/inertial/bias_estimation.h"
#include "workload/inertial/initialisation.h"
#include "workload/inertial/preintegration.h"
#include "workload/levio/geometry/epnp_ransac.h"
#include "workload/levio/geometry/essential_ransac.h"
#include "workload/vio/loop_options.h"
#include "workload/vision/extractor.h"
#include "workload/vision/guided_matcher.h"
#include "workload/vision/matcher.h"
#include "workload/vision/patch_alignment.h"

namespace leviosim::vio {

/// How `next` refines a pose to the landmarks that it finds (next/pose_refinement.h). Chosen on the
/// rendered EuRoC flights (ACCURACY.md).
struct RefinementOptions {
  int steps = 4;
  float sigma_px = 1.0f;
  float huber_px = 1.0f;    ///< errors count linearly from here on
  float inlier_px = 3.0f;   ///< of a match that agrees
  float min_share = 0.6f;   ///< of the matches that must agree; of wrong ones found within 8 px, a
                            ///< seventh does by chance
  float rotation = 0.02f;   ///< standard deviation of the prior, each axis, rad
  float position = 0.05f;   ///< likewise, m
  float min_depth = 0.05f;  ///< of a landmark in view, m
};

/// What `next` does when landmarks get few or are lost (next/). Chosen on the rendered EuRoC
/// flights (ACCURACY.md).
struct RecoveryOptions {
  float wide_radius_px = 24;     ///< of a second search, where the first one finds too few; 0: none
  float rotation = 0.1f;         ///< of its prior, standard deviation of each axis, rad
  float position = 0.3f;         ///< likewise, m
  float recovered_rotation = 1;  ///< of a search around the pose that EPnP found, likewise, rad
  float recovered_position = 1;  ///< likewise, m
  float max_blind_time = 3;      ///< that the IMU alone carries the pose for [s]
  int min_tracked = 60;          ///< a frame that sees fewer landmarks becomes a keyframe, 0: never
  float min_parallax = 0.3f;     ///< that it needs for that, as a share of keyframe_parallax
  int min_features = 40;         ///< an image with fewer is dark or blurred, and no keyframe
  // Beyond these a map has no meaning any more, and another one is begun.
  float max_speed = 20;       ///< m/s
  float max_gyro_bias = 0.5;  ///< rad/s
  float max_accel_bias = 3;   ///< m/s²
  float max_correction = 1;   ///< that the optimiser may have made since the last frame, m
  /// An 8-point pose whose rotation differs by more from the gyro's, but for the largest bias since
  /// the keyframe, is rejected, rad.
  float max_gyro_difference = 0.05f;
};

/// What the noise of a frame does to the pose of a camera at rest, at most; beyond it the images
/// contradict rest. Chosen on the rendered EuRoC flights (ACCURACY.md).
struct RestOptions {
  float position = 0.05f;  ///< m
  float rotation = 0.02f;  ///< rad
  /// While there are no landmarks: of the motion since the keyframe, over the distance of what is
  /// seen. Below it the camera has not moved, whatever the IMU says.
  float image_motion = 0.006f;
  float image_time = 1;  ///< for which the images must show it to say that it rests [s]
  /// Of the gyro, over the last second: beyond it the vehicle turns, and an image that does not is
  /// frozen, or shows what moves with the camera. With rotors that idle recorded flights have up to
  /// 0.04, in the air 0.11 and more; rad/s.
  float gyro_stddev = 0.08f;
  float seen_share = 0.25f;   ///< of that time, after which images that do not move have shown rest
  float wrong_match = 0.03f;  ///< a match that moved farther is rejected, in normalised coordinates
  /// If most matches moved farther than that, but not this far, the camera moves fast.
  float fast_match = 0.12f;
  // Of means over a second at rest, at most, as data sheets of MEMS sensors have it.
  float gyro_bias = 0.17f;   ///< 10 °/s, rad/s
  float accel_error = 1.5f;  ///< of gravity's size: 0.1 g of offset, 5 % of scale, m/s²
};

/// From where on the odometry does not call its map good (odometry/back_end.h).
struct HealthOptions {
  /// Of whitened residuals: they are twice as large as their noise. What is assumed of the IMU is
  /// several times its data sheet's, so that good windows lie at a tenth, and one with samples that
  /// come 10 ms late at two to three.
  float mean_square = 4;
  float accel_bias = 5;        ///< in standard deviations of the prior
  float lost_accel_bias = 10;  ///< likewise; the poses are of no use
  float memory_s = 1;    ///< for which an inconsistent window counts, and tracking is averaged
  float tracked = 0.7f;  ///< share of the matches that agree
  float drift = 0.1f;    ///< share of the path
  /// Share of what windows changed the path's length by in memory_s that the scale may be off by: a
  /// single correction comes to rest, while a map in a wrong minimum wanders on.
  float corrected = 0.3f;
  float blind_s = 0.5f;  ///< for which the IMU alone may move the pose on
  // Of such a pose: what velocity and tilt, with the bias, are wrong by.
  float blind_velocity = 0.05f;      ///< m/s
  float blind_acceleration = 0.05f;  ///< m/s²
};

struct Profile {
  std::string name;

  ExtractorOptions extractor;
  MatcherOptions matcher;

  // Pose of a frame (paper III.B.3–4).
  levio::EpnpRansacOptions epnp;
  levio::EssentialRansacOptions essential;
  float essential_inlier_px = 0.7f;   ///< Sampson error of an inlier of the 8-point algorithm
  std::uint32_t sampling_seed = 1;    ///< of the one register that samples are drawn with
  int min_world_matches = 25;         ///< for EPnP, before and after the age filter
  int min_frame_matches = 10;         ///< for the 8-point algorithm
  int min_epnp_inliers = 15;          ///< as many; with fewer the pose is predicted instead
  float min_translation = 0.01f;      ///< per keyframe interval, of the 8-point pose [m]
  float max_translation_time = 1.0f;  ///< that the last velocity is trusted for [s]

  /// Do as the released program where that costs accuracy, to be compared with it: rotation counts
  /// as parallax, and descriptors have its slip and as few matches. Of the profile levio only.
  bool released = false;

  // What `next` adds to it (next/). Not enabled: `levio`.
  GuidedOptions guided;
  RefinementOptions refinement;
  PatchAlignmentOptions patches;  ///< of features with those of the last keyframe
  RecoveryOptions recovery;
  RestOptions rest;
  HealthOptions health;
  AlignmentOptions alignment;        ///< of a map that begins in motion; needs the joint optimiser
  float alignment_parallax = 0.8f;   ///< of its keyframes, as a share of keyframe_parallax …
  float alignment_interval = 0.25f;  ///< … or this time, if they have moved at all [s]
  float initial_wait = 0;            ///< of poses for the alignment that corrects them, at most [s]
  float settling_time = 1.5f;        ///< of those poses after the alignment, s
  LoopOptions loop;

  // Keyframes and landmarks (III.B.5–6).
  float keyframe_parallax = 0.05f;  ///< mean, in normalised coordinates
  int max_landmarks = 1000;
  int max_landmark_age = 15;               ///< keyframes without being seen
  float max_landmark_error_sq = 2.0f;      ///< squared reprojection error of a new landmark [px²]
  float max_observation_error_sq = 64.0f;  ///< … of a known landmark in a new keyframe [px²]

  // Inertial part and optimiser (III.C). The paper anchors pose, velocity and bias of the oldest
  // keyframe and leaves open how tightly; see levio_anchor().
  bool use_imu = true;
  bool use_epnp = true;
  bool gravity_updates = true;  ///< gravity is measured again whenever the vehicle stands still
  ImuNoise imu_noise;
  ImuUncertainty imu_uncertainty;
  StillnessOptions stillness;
  BiasOptions biases;
  OptimiserOptions optimiser;
  int optimiser_keyframes = 8;  ///< window
  int max_observations = 2400;
  int optimiser_iterations = 3;  ///< per frame
  /// Of the same newest keyframe, for the joint optimiser; as many as two keyframes in slow flight
  /// lie frames apart.
  int max_snapshots = 10;

  int l1_alignment = 1;  ///< bytes; the release's allocator packs blocks

  /// Whether poses are found by EPnP: guided tracking refines predicted ones.
  bool runs_epnp() const { return use_epnp && !guided.enabled; }
  /// Whether a map that begins in motion waits for its alignment.
  bool initialises() const { return alignment.enabled && optimiser.joint; }
  /// Of a camera, whose poses may wait.
  int frames_that_wait(float frame_rate) const;
};

/// @throws InputError for an unknown name, with the nearest known one.
Profile profile_named(std::string_view name, std::uint32_t seed);

}  // namespace leviosim::vio
