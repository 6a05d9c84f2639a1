// What closes loops, and under which conditions (README.md).
#pragma once

namespace leviosim::vio {

/// Which views are kept as places. With the sizes below all of it takes 244 kB of L2
/// (place_store.h).
struct PlaceOptions {
  int places = 120;           ///< most places that are kept
  int features = 48;          ///< most features of a place
  int min_features = 20;      ///< least features of a place
  int min_observations = 2;   ///< least observations of a feature's landmark in the window
  float min_distance = 0.3f;  ///< least distance to the place before [m] …
  float min_turn = 0.3f;      ///< … or least angle between their optical axes [rad]
  float metres_per_rad = 1;   ///< weight of a turn where distances to places are compared [m/rad]
};

/// Which views are looked at, and which places they are compared with.
struct SearchOptions {
  float view_distance =
      0.15f;                ///< least distance from one view that is looked at to the next [m] …
  float view_turn = 0.15f;  ///< … or least angle between their optical axes [rad]
  int candidates = 4;       ///< places that a view is compared with
  float candidate_distance = 0.5f;  ///< least distance of two candidates of one visit [m]
  float min_travelled = 6;          ///< least path since the place was visited [m]
  float max_angle = 0.7f;           ///< largest angle between the optical axes [rad]
  // Gate: largest drift of the estimate, a constant and a share of the path since the place was
  // visited or since the last closure.
  float gate = 0.4f;         ///< [m]
  float gate_share = 0.03f;  ///< [m/m]
  float gate_yaw = 0.15f;    ///< [rad]
  float yaw_share = 0.001f;  ///< [rad/m]
};

/// How a pose with a known vertical is found.
struct UprightOptions {
  int iterations = 32;  ///< RANSAC hypotheses
  float inlier_px = 4;  ///< reprojection error of an inlier of a hypothesis from two matches [px]
  int steps = 4;        ///< Gauss–Newton iterations
  float huber_px = 1;   ///< reprojection error from which on the cost grows linearly [px]
  float min_depth = 0.05f;  ///< least depth of a point in view [m]
};

/// When a view shows a place.
struct VerificationOptions {
  int max_distance = 60;     ///< Hamming distance that a match must be below [bits]
  int ratio_percent = 90;    ///< largest share of the second best distance, ratio test [%]
  int min_matches = 9;       ///< least matches with a place
  int min_pair_inliers = 6;  ///< least inliers of the best hypothesis from two matches
  UprightOptions pose;
  float radius_px = 4;       ///< radius of the search for all points of the place [px]
  int guided_distance = 70;  ///< Hamming distance that a match of that search must be below [bits]
  float inlier_px = 2;       ///< reprojection error of a point that agrees [px]
  int min_inliers = 14;      ///< least number of points that agree
  float min_share = 0.4f;    ///< least share of the points in view that agree
  int stripe_points = 8;     ///< points of a place in a vertical quarter of the image …
  int min_stripe_inliers = 2;  ///< … of which so many have to agree, at least
  int min_cells = 5;           ///< least number of cells with inliers, of 4 × 3 over the image
};

/// When several views make a closure.
struct ConfirmationOptions {
  int views = 4;          ///< views that have to agree
  float span = 1;         ///< least path from the first of them to the last [m]
  float position = 0.2f;  ///< largest difference of their corrections, beyond drift [m]
  float yaw = 0.03f;      ///< the same of the yaw [rad]
  float window = 4;       ///< path over which views are remembered [m]
  /// A correction that differs by less from the graph's present one adds nothing [m].
  float known_position = 0.05f;
  float known_yaw = 0.01f;  ///< the same of the yaw [rad]
};

/// Standard deviations in the pose graph, and its solution.
struct LoopGraphOptions {
  int closures = 32;              ///< most closures that are kept
  float drift_position = 0.035f;  ///< odometry drift after 1 m [m]; grows with the root of the path
  float drift_yaw = 0.003f;       ///< the same of the yaw [rad]
  float loop_position = 0.07f;    ///< of a closure's position [m]
  float loop_yaw = 0.02f;         ///< of a closure's yaw [rad]
  int steps = 4;                  ///< Gauss–Newton steps, one per frame
  int iterations = 24;            ///< most iterations of conjugate gradients in a step
  float converged = 1e-3f;        ///< change of a position below which no further step follows [m]
};

struct LoopOptions {
  bool enabled = false;
  PlaceOptions places;
  SearchOptions search;
  VerificationOptions verification;
  ConfirmationOptions confirmation;
  LoopGraphOptions graph;
  float restart_travelled = 20;  ///< path whose drift a restart of the map counts as [m]
  float smoothing = 1;           ///< time over which a correction is applied [s]
};

}  // namespace leviosim::vio
