// What closes loops, and under which conditions (README.md).
#pragma once

namespace leviosim::vio {

/// Which views are kept as places. With the sizes below all of it takes 244 kB of L2
/// (place_store.h).
struct PlaceOptions {
  int places = 120;           ///< kept at most
  int features = 48;          ///< of each, at most
  int min_features = 20;      ///< with fewer a view is no place
  int min_observations = 2;   ///< of a feature's landmark, in the window of keyframes
  float min_distance = 0.3f;  ///< to the place before, m …
  float min_turn = 0.3f;      ///< … or angle between the optical axes, rad
  float metres_per_rad = 1;   ///< of a turn, when distances to places are compared
};

/// Which views are looked at, and which places they are compared with.
struct SearchOptions {
  float view_distance = 0.15f;  ///< from one view that is looked at to the next, m …
  float view_turn = 0.15f;      ///< … or angle between the optical axes, rad
  int candidates = 4;
  float candidate_distance = 0.5f;  ///< between those of one visit, m: near ones say the same
  float min_travelled = 6;          ///< since the place was visited, m
  float max_angle = 0.7f;           ///< between the optical axes, rad
  // The position gate: the estimate's drift at most.
  float gate = 0.4f;         ///< m
  float gate_share = 0.03f;  ///< of what was travelled since the place, or the last closure
  float gate_yaw = 0.15f;    ///< rad
  float yaw_share = 0.001f;  ///< rad/m, likewise: between two places
};

/// How a pose with a known vertical is found.
struct UprightOptions {
  int iterations = 32;      ///< of RANSAC
  float inlier_px = 4;      ///< of a pair's pose; a pair is less exact than all
  int steps = 4;            ///< Gauss–Newton
  float huber_px = 1;       ///< errors count linearly from here on
  float min_depth = 0.05f;  ///< of a point in view, m
};

/// When a view shows a place.
struct VerificationOptions {
  int max_distance = 60;   ///< bits; a match is strictly closer
  int ratio_percent = 90;  ///< of the second best distance, at most
  int min_matches = 9;
  int min_pair_inliers = 6;  ///< of the best pose of two matches
  UprightOptions pose;
  float radius_px = 4;       ///< of the search for all points of the place, around that pose
  int guided_distance = 70;  ///< bits, in that search
  float inlier_px = 2;       ///< reprojection error of a point that agrees
  int min_inliers = 14;
  float min_share = 0.4f;      ///< of the points in view that have to agree
  int stripe_points = 8;       ///< of a place in a vertical quarter of the image …
  int min_stripe_inliers = 2;  ///< … of which that many have to agree
  int min_cells = 5;           ///< of 4 × 3 of the image, which inliers have to lie in
};

/// When several views make a closure.
struct ConfirmationOptions {
  int views = 4;                 ///< that have to agree
  float span = 1;                ///< of the path, from the first of them to the last, at least, m
  float position = 0.2f;         ///< besides the drift between the places, m
  float yaw = 0.03f;             ///< likewise, rad
  float window = 4;              ///< of the path, in which views are remembered, m
  float known_position = 0.05f;  ///< what is nearer than this to the graph's answer adds nothing, m
  float known_yaw = 0.01f;       ///< likewise, rad
};

/// Standard deviations in the pose graph, and its solution.
struct LoopGraphOptions {
  int closures = 32;              ///< kept at most
  float drift_position = 0.035f;  ///< m after 1 m, and with the root of the path
  float drift_yaw = 0.003f;       ///< rad, likewise
  float loop_position = 0.07f;    ///< of a closure, m
  float loop_yaw = 0.02f;         ///< of a closure, rad
  int steps = 4;                  ///< Gauss–Newton, one in a frame
  int iterations = 24;            ///< of conjugate gradients in a step, at most
  float converged = 1e-3f;        ///< change of a position below which no step follows, m
};

struct LoopOptions {
  bool enabled = false;
  PlaceOptions places;
  SearchOptions search;
  VerificationOptions verification;
  ConfirmationOptions confirmation;
  LoopGraphOptions graph;
  float restart_travelled = 20;  ///< what a restart of the map counts as in drift, m of path
  float smoothing = 1;           ///< in which a correction is applied, s
};

}  // namespace leviosim::vio
