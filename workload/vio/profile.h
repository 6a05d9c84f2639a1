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
  int steps = 4;            ///< Gauss-Newton iterations
  float sigma_px = 1.0f;    ///< standard deviation of an observation [px]
  float huber_px = 1.0f;    ///< reprojection error from which on the cost grows linearly [px]
  float inlier_px = 3.0f;   ///< reprojection error below which a match agrees with the pose [px]
  float min_share = 0.6f;   ///< least share of the matches that must agree with the pose; of wrong
                            ///< matches within 8 px a seventh agrees by chance
  float rotation = 0.02f;   ///< standard deviation of the prior's rotation, each axis [rad]
  float position = 0.05f;   ///< standard deviation of the prior's position, each axis [m]
  float min_depth = 0.05f;  ///< least depth of a landmark in view [m]
};

/// What `next` does when landmarks get few or are lost (next/). Chosen on the rendered EuRoC
/// flights (ACCURACY.md).
struct RecoveryOptions {
  /// Radius of a second search, where the first one finds too few landmarks; 0: no second search
  /// [px].
  float wide_radius_px = 24;
  float rotation = 0.1f;  ///< standard deviation of the second search's prior, each axis [rad]
  float position = 0.3f;  ///< the same of its position, each axis [m]
  /// Poses that EPnP tries in a frame that is lost: a batch of the team's. More take longer than a
  /// frame has time for; if none is right, the next frame tries others.
  int hypotheses = 8;
  float recovered_rotation = 1;  ///< standard deviation of a pose found by EPnP, each axis [rad]
  float recovered_position = 1;  ///< the same of its position, each axis [m]
  float max_blind_time = 3;      ///< longest time for which the IMU alone moves the pose on [s]
  int min_tracked = 60;          ///< landmarks below which a frame becomes a keyframe; 0: never
  float min_parallax = 0.3f;     ///< parallax of such a keyframe, as a share of keyframe_parallax
  int min_features = 40;         ///< least features of a keyframe; with fewer it is dark or blurred
  // A map that exceeds one of these is given up, and another one is begun.
  float max_speed = 20;       ///< speed of the vehicle [m/s]
  float max_gyro_bias = 0.5;  ///< size of the gyro's bias [rad/s]
  float max_accel_bias = 3;   ///< size of the accelerometer's bias [m/s²]
  float max_correction = 1;   ///< correction of the last pose by the optimiser [m]
  /// Largest difference between the rotations of an 8-point pose and of the gyro since the
  /// keyframe, beyond what the largest gyro bias explains; a pose that differs more is rejected
  /// [rad].
  float max_gyro_difference = 0.05f;
};

/// When images and IMU show that the vehicle rests. Chosen on the rendered EuRoC flights
/// (ACCURACY.md).
struct RestOptions {
  // Differences from the last pose that noise explains; beyond them the images contradict rest.
  float position = 0.05f;  ///< [m]
  float rotation = 0.02f;  ///< [rad]
  /// Translation since the keyframe, as a share of the scene's depth, below which a camera without
  /// landmarks has not moved, whatever the IMU says.
  float image_motion = 0.006f;
  float image_time = 1;  ///< time for which the images must show no motion before it rests [s]
  /// Standard deviation of the gyro over the last second, beyond which the vehicle turns; an image
  /// that does not move is then frozen, or shows what moves with the camera. Recorded flights have
  /// up to 0.04 while rotors idle, and 0.11 or more in the air [rad/s].
  float gyro_stddev = 0.08f;
  float seen_share = 0.25f;   ///< share of image_time after which still images count as rest
  float wrong_match = 0.03f;  ///< motion, in normalised coordinates, of a match that is rejected
  /// If most matches moved by more than wrong_match, but by less than this, the camera moves fast.
  float fast_match = 0.12f;
  // Largest means over a second at rest, as data sheets of MEMS sensors allow them.
  float gyro_bias = 0.17f;   ///< angular rate: 10 °/s [rad/s]
  float accel_error = 1.5f;  ///< difference from gravity: 0.1 g of offset, 5 % of scale [m/s²]
};

/// When `next` takes a part of the picture for one that moves with the camera
/// (next/fixed_in_view.h).
struct FixedPartOptions {
  int cell = 8;             ///< side of the cells in which evidence is kept [px]
  int evidence = 4;         ///< matches of a cell that stayed, less those that moved
  float turned_px = 2;      ///< least motion that the rotation alone gives a match that counts [px]
  float stayed_px = 0.25f;  ///< motion below which it has stayed: patches agree within a tenth [px]
};

/// When `next` takes a match for one of something that moves by itself (next/own_motion.h).
struct OwnMotionOptions {
  int pairs = 24;          ///< of matches that are tried: of 40 % wrong ones a third are right
  int stride = 7;          ///< between their partners, without a factor in common with pairs
  float agrees_px = 1;     ///< distance below which a match agrees with a translation [px]
  float disagrees_px = 2;  ///< distance from which on it has moved by itself [px]
  int cell = 16;           ///< side of the cells in which neighbours are taken for the same [px]
  int keyframes = 4;       ///< for which a feature that moved by itself is remembered
};

/// Limits beyond which the odometry calls its map unreliable or lost (odometry/map_health.h).
struct HealthOptions {
  /// Mean square of the whitened residuals: 4 is twice the assumed noise. The assumed IMU noise is
  /// several times the data sheet's, so good windows have 0.1, and windows whose samples come 10 ms
  /// late have 2 to 3.
  float mean_square = 4;
  float accel_bias = 5;        ///< accelerometer bias, in standard deviations of the prior
  float lost_accel_bias = 10;  ///< the same, from which on the poses are of no use
  /// Time for which an inconsistent window and changes of the path's length count, and tracking is
  /// averaged [s].
  float memory_s = 1;
  float tracked = 0.7f;  ///< least share of the matches that agree with the pose
  float drift = 0.1f;    ///< uncertainty of the path, as a share of its length
  float blind_s = 0.5f;  ///< longest time for which the IMU alone may move the pose on [s]
  // Errors of a pose that the IMU alone has moved on.
  float blind_velocity = 0.05f;      ///< velocity [m/s]
  float blind_acceleration = 0.05f;  ///< acceleration from tilt and bias [m/s²]
};

struct Profile {
  std::string name;

  ExtractorOptions extractor;
  MatcherOptions matcher;

  // Pose of a frame (paper III.B.3–4).
  levio::EpnpRansacOptions epnp;
  levio::EssentialRansacOptions essential;
  float essential_inlier_px = 0.7f;  ///< Sampson error of an inlier of the 8-point algorithm
  std::uint32_t sampling_seed = 1;   ///< seed of the shift register of both RANSACs
  int min_world_matches = 25;        ///< least matches for EPnP, before and after the age filter
  int min_frame_matches = 10;        ///< least matches for the 8-point algorithm
  int min_epnp_inliers = 15;         ///< least inliers of EPnP; with fewer the pose is predicted
  float min_translation = 0.01f;     ///< least translation of an 8-point pose per keyframe [m]
  float max_translation_time =
      1.0f;  ///< longest time for which the last velocity gives it scale [s]

  /// Behaves as the released program where that costs accuracy, for comparisons with it: rotation
  /// counts as parallax, descriptors have the release's indexing slip, and as few match. Profile
  /// levio only.
  bool released = false;

  // What `next` adds (next/); `levio` leaves all of it disabled.
  GuidedOptions guided;
  RefinementOptions refinement;
  PatchAlignmentOptions patches;  ///< alignment of features to patches of the last keyframe
  RecoveryOptions recovery;
  RestOptions rest;
  FixedPartOptions fixed;
  OwnMotionOptions own_motion;
  HealthOptions health;
  AlignmentOptions alignment;  ///< of a map that begins in motion; needs the joint optimiser
  /// Parallax between keyframes before the alignment, as a share of keyframe_parallax …
  float alignment_parallax = 0.8f;
  float alignment_interval = 0.25f;  ///< … or time between them, if the camera has moved [s]
  float initial_wait = 0;      ///< longest wait of poses for the alignment, which corrects them [s]
  float settling_time = 1.5f;  ///< wait of those poses after the alignment [s]
  LoopOptions loop;

  // Keyframes and landmarks (III.B.5–6).
  float keyframe_parallax = 0.05f;  ///< mean parallax of a keyframe, in normalised coordinates
  int max_landmarks = 1000;
  int max_landmark_age = 15;               ///< keyframes since a landmark was last seen
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
  int optimiser_keyframes = 8;  ///< keyframes of the window
  int max_observations = 2400;
  int optimiser_iterations = 3;  ///< per frame
  /// Snapshots of one newest keyframe that the joint optimiser works on; in slow flight keyframes
  /// lie as many frames apart.
  int max_snapshots = 10;

  int l1_kib = 0;        ///< of L1 that the workload may use; 0: all of it
  int l1_alignment = 1;  ///< bytes; the release's allocator packs blocks

  /// Whether poses are found by EPnP: guided tracking refines predicted ones.
  bool runs_epnp() const { return use_epnp && !guided.enabled; }
  /// Whether a map that begins in motion waits for its alignment.
  bool initialises() const { return alignment.enabled && optimiser.joint; }
  /// Number of frames whose poses wait for the alignment, at a camera's frame rate [1/s].
  int frames_that_wait(float frame_rate) const;
};

/// @throws InputError for an unknown name, with the nearest known one.
Profile profile_named(std::string_view name, std::uint32_t seed);

}  // namespace leviosim::vio
