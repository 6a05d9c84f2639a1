#include "workload/vio/parameters.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/base/check.h"
#include "sim/base/error.h"
#include "workload/vio/profile.h"

namespace leviosim::vio {
namespace {

using Kind = Parameter::Kind;

/// A field of the profile as get and set functions: of(p) is a reference to it.
#define LEVIOSIM_FIELD(field)                                    \
  [](const Profile& p) { return static_cast<double>(p.field); }, \
      [](Profile& p, double value) { p.field = static_cast<decltype(p.field)>(value); }

constexpr std::array kParameters = {
    Parameter{"workload.released", Kind::toggle, "", 0, 1,
              "behaviour of LEVIO's released program where that costs accuracy; profile levio only",
              false, LEVIOSIM_FIELD(released)},
    Parameter{"workload.fast_threshold", Kind::whole, "grey levels", 1, 254,
              "brightness difference that makes a FAST corner", false,
              LEVIOSIM_FIELD(extractor.fast_threshold)},
    Parameter{"workload.harris_threshold", Kind::whole, "", 0, 100'000'000,
              "least Harris response of a corner", false,
              LEVIOSIM_FIELD(extractor.harris_threshold)},
    Parameter{"workload.cell", Kind::whole, "px", 4, 128,
              "side of the square cells, each of which keeps its best features", false,
              LEVIOSIM_FIELD(extractor.cell)},
    Parameter{"workload.features_per_cell", Kind::whole, "features", 1,
              ExtractorOptions::kMostPerCell,
              "features kept in each cell, those with the highest Harris responses", false,
              LEVIOSIM_FIELD(extractor.per_cell)},
    Parameter{"workload.subpixel_steps", Kind::whole, "steps", 1, 64,
              "subpixel positions per pixel at which a corner may lie; more than one needs the "
              "joint optimiser",
              false, LEVIOSIM_FIELD(extractor.subpixel_steps)},
    Parameter{"workload.max_corner_shift", Kind::number, "px", 0, 8,
              "largest subpixel shift of a corner from its pixel, in each direction; 0: no shift",
              false, LEVIOSIM_FIELD(extractor.max_corner_shift)},
    Parameter{"workload.patches", Kind::toggle, "", 0, 1,
              "alignment of features to their image patches in the last keyframe", false,
              LEVIOSIM_FIELD(patches.enabled)},
    Parameter{"workload.patches.radius", Kind::whole, "px", 1, PatchAlignmentOptions::kMostRadius,
              "radius of an image patch, which has 2 radius + 1 pixels a side", false,
              LEVIOSIM_FIELD(patches.radius)},
    Parameter{"workload.patches.iterations", Kind::whole, "iterations", 1, 100,
              "iterations of the alignment of a patch, at most", false,
              LEVIOSIM_FIELD(patches.iterations)},
    Parameter{"workload.patches.max_shift", Kind::number, "px", 0, 100,
              "largest shift of a feature from its detected corner, in each direction", false,
              LEVIOSIM_FIELD(patches.max_shift)},
    Parameter{"workload.patches.reach", Kind::number, "px", 0, 100,
              "radius of the patch search for landmarks that the detector missed, in each "
              "direction; 0: no search",
              false, LEVIOSIM_FIELD(patches.reach)},
    Parameter{"workload.patches.required", Kind::toggle, "", 0, 1,
              "rejection of matches whose patches do not agree", false,
              LEVIOSIM_FIELD(patches.required)},
    Parameter{"workload.patches.max_difference", Kind::number, "", 0, 100,
              "largest difference of two patches that agree, as a share of their contrast", false,
              LEVIOSIM_FIELD(patches.max_difference)},
    Parameter{"workload.ransac_batch", Kind::whole, "hypotheses", 0, 64,
              "hypotheses that a fork of EPnP and of the 8-point algorithm computes; 0: eight, or "
              "the next multiple of the team's cores",
              false, [](const Profile& p) { return static_cast<double>(p.epnp.batch); },
              [](Profile& p, double value) {
                p.epnp.batch = p.essential.batch = static_cast<int>(value);
              }},
    Parameter{"workload.guided", Kind::toggle, "", 0, 1,
              "matching around the landmarks' predicted pixels, and refinement of the pose to the "
              "matches",
              false, LEVIOSIM_FIELD(guided.enabled)},
    Parameter{"workload.guided_radius", Kind::number, "px", 1, 100,
              "radius of the search around a landmark's predicted pixel", false,
              LEVIOSIM_FIELD(guided.radius_px)},
    Parameter{"workload.guided_distance", Kind::whole, "bits", 1, 255,
              "Hamming distance below which a landmark matches a feature near its predicted pixel",
              false, LEVIOSIM_FIELD(guided.max_distance)},
    Parameter{"workload.guided_cell", Kind::whole, "px", 4, 128,
              "side of the grid cells in which guided matching looks features up", false,
              LEVIOSIM_FIELD(guided.cell_px)},
    Parameter{"workload.min_depth", Kind::number, "m", 1e-3, 10,
              "least depth of a landmark in view", false,
              LEVIOSIM_FIELD(optimiser.visual.min_depth)},
    Parameter{"workload.refinement.steps", Kind::whole, "steps", 1, 100,
              "steps of the refinement of a pose to its landmarks", false,
              LEVIOSIM_FIELD(refinement.steps)},
    Parameter{"workload.refinement.noise", Kind::number, "px", 0.01, 100,
              "standard deviation of an observation in the refinement", false,
              LEVIOSIM_FIELD(refinement.sigma_px)},
    Parameter{"workload.refinement.huber", Kind::number, "px", 0.01, 100,
              "Huber threshold of the refinement: reprojection error from which on the cost grows "
              "linearly",
              false, LEVIOSIM_FIELD(refinement.huber_px)},
    Parameter{"workload.refinement.inlier", Kind::number, "px", 0.01, 100,
              "reprojection error below which a landmark agrees with the refined pose", false,
              LEVIOSIM_FIELD(refinement.inlier_px)},
    Parameter{"workload.refinement.min_share", Kind::number, "", 0, 1,
              "least share of the matched landmarks that must agree with the refined pose", false,
              LEVIOSIM_FIELD(refinement.min_share)},
    Parameter{"workload.refinement.rotation", Kind::number, "rad", 1e-4, 10,
              "standard deviation of the predicted rotation in the refinement, each axis", false,
              LEVIOSIM_FIELD(refinement.rotation)},
    Parameter{"workload.refinement.position", Kind::number, "m", 1e-4, 100,
              "standard deviation of the predicted position in the refinement, each axis", false,
              LEVIOSIM_FIELD(refinement.position)},
    Parameter{"workload.wide_radius", Kind::number, "px", 0, 200,
              "radius of a second search, where the first one finds too few landmarks; 0: no "
              "second search",
              false, LEVIOSIM_FIELD(recovery.wide_radius_px)},
    Parameter{"workload.wide_rotation", Kind::number, "rad", 1e-4, 10,
              "standard deviation of the predicted rotation in the second search, each axis", false,
              LEVIOSIM_FIELD(recovery.rotation)},
    Parameter{"workload.wide_position", Kind::number, "m", 1e-4, 100,
              "standard deviation of the predicted position in the second search, each axis", false,
              LEVIOSIM_FIELD(recovery.position)},
    Parameter{"workload.recovered_rotation", Kind::number, "rad", 1e-4, 10,
              "standard deviation of a rotation found by EPnP, in the search around it, each axis",
              false, LEVIOSIM_FIELD(recovery.recovered_rotation)},
    Parameter{"workload.recovered_position", Kind::number, "m", 1e-4, 100,
              "standard deviation of a position found by EPnP, in the search around it, each axis",
              false, LEVIOSIM_FIELD(recovery.recovered_position)},
    Parameter{"workload.min_tracked", Kind::whole, "landmarks", 0, 1000,
              "number of tracked landmarks below which a frame becomes a keyframe sooner", false,
              LEVIOSIM_FIELD(recovery.min_tracked)},
    Parameter{"workload.min_parallax", Kind::number, "", 0, 1,
              "parallax that such a keyframe needs, as a share of workload.keyframe_parallax",
              false, LEVIOSIM_FIELD(recovery.min_parallax)},
    Parameter{"workload.min_features", Kind::whole, "features", 0, 1000,
              "least number of features of a keyframe", false,
              LEVIOSIM_FIELD(recovery.min_features)},
    Parameter{"workload.max_blind_time", Kind::number, "s", 0, 60,
              "longest time in which the IMU alone carries the pose on", true,
              LEVIOSIM_FIELD(recovery.max_blind_time)},
    Parameter{"workload.max_speed", Kind::number, "m/s", 0.1, 1000,
              "speed of the vehicle above which the map is given up", false,
              LEVIOSIM_FIELD(recovery.max_speed)},
    Parameter{"workload.max_gyro_bias", Kind::number, "rad/s", 1e-3, 100,
              "bias of the gyroscope above which the map is given up", true,
              LEVIOSIM_FIELD(recovery.max_gyro_bias)},
    Parameter{"workload.max_accel_bias", Kind::number, "m/s^2", 1e-3, 100,
              "bias of the accelerometer above which the map is given up", true,
              LEVIOSIM_FIELD(recovery.max_accel_bias)},
    Parameter{"workload.max_correction", Kind::number, "m", 0, 1000,
              "largest correction of the last pose by the optimiser; a pose beyond it is rejected",
              false, LEVIOSIM_FIELD(recovery.max_correction)},
    Parameter{"workload.max_gyro_difference", Kind::number, "rad", 0, 4,
              "largest difference of the rotations of an 8-point pose and of the gyroscope, beyond "
              "its bias",
              true, LEVIOSIM_FIELD(recovery.max_gyro_difference)},
    Parameter{"workload.rest.position", Kind::number, "m", 0, 10,
              "distance from the last pose beyond which the images contradict rest", true,
              LEVIOSIM_FIELD(rest.position)},
    Parameter{"workload.rest.rotation", Kind::number, "rad", 0, 3,
              "rotation from the last pose beyond which the images contradict rest", true,
              LEVIOSIM_FIELD(rest.rotation)},
    Parameter{"workload.rest.image_motion", Kind::number, "", 0, 1,
              "image motion since the keyframe, as a share of depth, below which a camera without "
              "landmarks rests",
              true, LEVIOSIM_FIELD(rest.image_motion)},
    Parameter{
        "workload.rest.wrong_match", Kind::number, "", 0, 1,
        "image motion, in normalised coordinates, beyond which a match is rejected in that test",
        true, LEVIOSIM_FIELD(rest.wrong_match)},
    Parameter{"workload.rest.image_time", Kind::number, "s", 0, 60,
              "time for which the images must show no motion before the camera is taken to rest",
              true, LEVIOSIM_FIELD(rest.image_time)},
    Parameter{"workload.rest.gyro_bias", Kind::number, "rad/s", 0, 10,
              "mean angular rate above which the vehicle turns rather than rests with a bias", true,
              LEVIOSIM_FIELD(rest.gyro_bias)},
    Parameter{"workload.rest.accel_error", Kind::number, "m/s²", 0, 10,
              "largest difference of the mean specific force at rest from gravity", true,
              LEVIOSIM_FIELD(rest.accel_error)},
    Parameter{"workload.initialisation", Kind::toggle, "", 0, 1,
              "visual-inertial alignment of a map that begins in motion; needs the joint optimiser",
              true, LEVIOSIM_FIELD(alignment.enabled)},
    Parameter{"workload.initialisation.parallax", Kind::number, "", 0, 1,
              "parallax that makes a keyframe before the alignment, as a share of "
              "workload.keyframe_parallax",
              true, LEVIOSIM_FIELD(alignment_parallax)},
    Parameter{"workload.initialisation.interval", Kind::number, "s", 0, 10,
              "time after which a frame of a moving camera becomes a keyframe before the alignment",
              true, LEVIOSIM_FIELD(alignment_interval)},
    Parameter{"workload.initialisation.wait", Kind::number, "s", 0, 10,
              "longest time that the first poses wait for the alignment, which corrects them", true,
              LEVIOSIM_FIELD(initial_wait)},
    Parameter{
        "workload.initialisation.settling", Kind::number, "s", 0, 100,
        "time that these poses wait on after the alignment, for the corrections that follow it",
        true, LEVIOSIM_FIELD(settling_time)},
    Parameter{
        "workload.initialisation.few_keyframes", Kind::whole, "keyframes", 2, 31,
        "number of keyframes up to which no map is aligned, and inverse depths have first_spread",
        true, LEVIOSIM_FIELD(alignment.few_keyframes)},
    Parameter{
        "workload.initialisation.first_spread", Kind::number, "", 0.01, 100,
        "standard deviation of inverse depths with so few keyframes, as a share of their mean",
        true, LEVIOSIM_FIELD(alignment.first_spread)},
    Parameter{"workload.initialisation.first_gyro_bias", Kind::number, "rad/s", 1e-4, 10,
              "standard deviation of the gyroscope's bias with so few keyframes", true,
              LEVIOSIM_FIELD(alignment.first_gyro_bias)},
    Parameter{
        "workload.initialisation.distance", Kind::number, "", 1e-3, 100,
        "distance from its minimum, in standard deviations, below which an alignment has converged",
        true, LEVIOSIM_FIELD(alignment.max_distance)},
    Parameter{"workload.initialisation.prior_deviation", Kind::number, "", 0.1, 100,
              "deviation of velocity, biases and gravity, in standard deviations, beyond which no "
              "map is aligned",
              true, LEVIOSIM_FIELD(alignment.max_prior_deviation)},
    Parameter{
        "workload.initialisation.uncertainty", Kind::number, "", 1e-3, 1,
        "uncertainty of positions, as a share of their distances, below which a map is aligned",
        true, LEVIOSIM_FIELD(alignment.max_uncertainty)},
    Parameter{"workload.initialisation.full_window", Kind::number, "", 1, 100,
              "factor on that uncertainty where the window has no room for more keyframes", true,
              LEVIOSIM_FIELD(alignment.full_uncertainty)},
    Parameter{"workload.initialisation.landmarks", Kind::whole, "landmarks", 1, 1000,
              "least number of landmarks with a known depth for an alignment", true,
              LEVIOSIM_FIELD(alignment.min_landmarks)},
    Parameter{"workload.initialisation.inverse_depth", Kind::number, "1/m", 0.01, 10,
              "inverse depth of a new landmark at the start of an alignment", true,
              LEVIOSIM_FIELD(alignment.inverse_depth)},
    Parameter{"workload.initialisation.spread", Kind::number, "", 0.01, 100,
              "standard deviation of inverse depths, as a share of their mean", true,
              LEVIOSIM_FIELD(alignment.spread)},
    Parameter{"workload.initialisation.same_scale", Kind::number, "", 1, 100,
              "ratio of the scales of two alignments below which they are one solution", true,
              LEVIOSIM_FIELD(alignment.same_scale)},
    Parameter{
        "workload.initialisation.advantage", Kind::number, "", 0, 1000,
        "least advantage of an alignment's cost over those of other scales; with less it waits",
        true, LEVIOSIM_FIELD(alignment.min_advantage)},
    Parameter{"workload.initialisation.start_iterations", Kind::whole, "iterations", 1, 100,
              "iterations of an alignment from each of several depths, at most", true,
              LEVIOSIM_FIELD(alignment.start_iterations)},
    Parameter{"workload.initialisation.velocity", Kind::number, "m/s", 1e-3, 100,
              "standard deviation of the velocity at the first keyframe", true,
              LEVIOSIM_FIELD(alignment.velocity)},
    Parameter{"workload.initialisation.acceleration", Kind::number, "m/s^2", 1e-3, 100,
              "standard deviation of the mean acceleration over the window", true,
              LEVIOSIM_FIELD(alignment.acceleration)},
    Parameter{"workload.loop", Kind::toggle, "", 0, 1,
              "loop closure: recognised places correct the drift; needs guided tracking and the "
              "joint optimiser",
              true, LEVIOSIM_FIELD(loop.enabled)},
    Parameter{"workload.loop.places", Kind::whole, "places", 3, 120,
              "places kept, at most; beyond them the densest are removed", true,
              LEVIOSIM_FIELD(loop.places.places)},
    Parameter{"workload.loop.features", Kind::whole, "features", 20, 48,
              "features kept of a place, at most", true, LEVIOSIM_FIELD(loop.places.features)},
    Parameter{"workload.loop.place_distance", Kind::number, "m", 0.01, 100,
              "least distance from one place to the next", true,
              LEVIOSIM_FIELD(loop.places.min_distance)},
    Parameter{"workload.loop.place_turn", Kind::number, "rad", 0.01, 3,
              "turn of the camera that makes a place at a smaller distance", true,
              LEVIOSIM_FIELD(loop.places.min_turn)},
    Parameter{"workload.loop.candidates", Kind::whole, "places", 1, 8,
              "candidate places that a view is compared with", true,
              LEVIOSIM_FIELD(loop.search.candidates)},
    Parameter{"workload.loop.min_travelled", Kind::number, "m", 0, 1000,
              "path travelled since a place was visited, before it is looked for again", true,
              LEVIOSIM_FIELD(loop.search.min_travelled)},
    Parameter{"workload.loop.max_angle", Kind::number, "rad", 0, 1.5,
              "largest angle between the optical axes of a view and of a place", true,
              LEVIOSIM_FIELD(loop.search.max_angle)},
    Parameter{"workload.loop.gate", Kind::number, "m", 0, 100,
              "largest drift of the estimate, whatever the path", true,
              LEVIOSIM_FIELD(loop.search.gate)},
    Parameter{
        "workload.loop.gate_share", Kind::number, "", 0, 1,
        "largest drift of the estimate, as a share of the path since the place or the last closure",
        true, LEVIOSIM_FIELD(loop.search.gate_share)},
    Parameter{"workload.loop.distance", Kind::whole, "bits", 1, 256,
              "Hamming distance below which a feature matches a point of a place", true,
              LEVIOSIM_FIELD(loop.verification.max_distance)},
    Parameter{"workload.loop.min_inliers", Kind::whole, "points", 6, 48,
              "least number of a place's points that a view has to show", true,
              LEVIOSIM_FIELD(loop.verification.min_inliers)},
    Parameter{"workload.loop.min_share", Kind::number, "", 0, 1,
              "least share of a place's points in view that a view has to show", true,
              LEVIOSIM_FIELD(loop.verification.min_share)},
    Parameter{"workload.loop.views", Kind::whole, "views", 1, 100,
              "successive views that have to agree on a loop", true,
              LEVIOSIM_FIELD(loop.confirmation.views)},
    Parameter{"workload.loop.smoothing", Kind::number, "s", 0, 60,
              "time in which a correction is applied", true, LEVIOSIM_FIELD(loop.smoothing)},
    Parameter{"workload.match_distance", Kind::whole, "bits", 1, 256,
              "Hamming distance below which two descriptors match", false,
              LEVIOSIM_FIELD(matcher.max_distance)},
    Parameter{"workload.min_world_matches", Kind::whole, "matches", 4, 1000,
              "least number of matches with landmarks for EPnP", false,
              LEVIOSIM_FIELD(min_world_matches)},
    Parameter{"workload.epnp_inlier", Kind::number, "px", 0.01, 100,
              "reprojection error below which a match agrees with a pose of EPnP", false,
              LEVIOSIM_FIELD(epnp.inlier_px)},
    Parameter{"workload.min_epnp_inliers", Kind::whole, "matches", 4, 1000,
              "least number of inliers of an EPnP pose; with fewer the pose is predicted", false,
              LEVIOSIM_FIELD(min_epnp_inliers)},
    Parameter{"workload.min_frame_matches", Kind::whole, "matches", 8, 1000,
              "least number of matches with the last keyframe for the 8-point algorithm", false,
              LEVIOSIM_FIELD(min_frame_matches)},
    Parameter{"workload.essential_inlier", Kind::number, "px", 0.01, 100,
              "Sampson error below which a match agrees with an essential matrix", false,
              LEVIOSIM_FIELD(essential_inlier_px)},
    Parameter{"workload.min_translation", Kind::number, "m", 0, 10,
              "least translation of an 8-point pose since the last keyframe", false,
              LEVIOSIM_FIELD(min_translation)},
    Parameter{"workload.max_translation_time", Kind::number, "s", 0, 60,
              "longest time for which the last keyframe's velocity gives an 8-point pose its scale",
              false, LEVIOSIM_FIELD(max_translation_time)},
    Parameter{"workload.keyframe_parallax", Kind::number, "", 1e-3, 1,
              "mean parallax, in normalised image coordinates, that makes a keyframe", false,
              LEVIOSIM_FIELD(keyframe_parallax)},
    Parameter{"workload.max_landmark_age", Kind::whole, "keyframes", 1, 250,
              "keyframes after which a landmark that was not seen is no longer matched", false,
              LEVIOSIM_FIELD(max_landmark_age)},
    Parameter{"workload.max_landmarks", Kind::whole, "landmarks", 50, 4000,
              "landmarks in the map, at most", false, LEVIOSIM_FIELD(max_landmarks)},
    Parameter{"workload.max_observations", Kind::whole, "observations", 100, 20000,
              "observations of landmarks by the keyframes of the window, at most", false,
              LEVIOSIM_FIELD(max_observations)},
    Parameter{
        "workload.max_observation_error", Kind::number, "px^2", 0.1, 10000,
        "squared reprojection error above which an observation of a known landmark is rejected",
        false, LEVIOSIM_FIELD(max_observation_error_sq)},
    Parameter{"workload.max_landmark_error", Kind::number, "px^2", 0.1, 10000,
              "squared reprojection error above which a triangulated landmark is rejected", false,
              LEVIOSIM_FIELD(max_landmark_error_sq)},
    Parameter{
        "workload.joint", Kind::toggle, "", 0, 1,
        "joint optimisation of poses, velocities and biases, with a prior from marginalisation",
        true, LEVIOSIM_FIELD(optimiser.joint)},
    Parameter{"workload.tracked_marginalised", Kind::toggle, "", 0, 1,
              "marginalisation also of landmarks that are still seen", true,
              LEVIOSIM_FIELD(optimiser.prior.tracked_landmarks)},
    Parameter{"workload.initial_velocity", Kind::number, "m/s", 1e-3, 100,
              "standard deviation of the first keyframe's velocity, in the joint optimiser", true,
              LEVIOSIM_FIELD(optimiser.prior.velocity)},
    Parameter{"workload.initial_tilt", Kind::number, "rad", 1e-3, 3,
              "standard deviation of the first keyframe's tilt, in the joint optimiser", true,
              LEVIOSIM_FIELD(optimiser.prior.tilt)},
    Parameter{"workload.rest_velocity", Kind::number, "m/s", 1e-3, 100,
              "standard deviation of the first keyframe's velocity if the vehicle was at rest",
              true, LEVIOSIM_FIELD(optimiser.prior.rest_velocity)},
    Parameter{"workload.rest_tilt", Kind::number, "rad", 1e-3, 3,
              "standard deviation of the first keyframe's tilt if the vehicle was at rest", true,
              LEVIOSIM_FIELD(optimiser.prior.rest_tilt)},
    Parameter{"workload.rest_gyro_bias", Kind::number, "rad/s", 1e-5, 10,
              "standard deviation of the gyroscope's bias after rest", true,
              LEVIOSIM_FIELD(optimiser.prior.rest_gyro_bias)},
    Parameter{"workload.initial_gyro_bias", Kind::number, "rad/s", 1e-5, 10,
              "standard deviation of the gyroscope's bias at first, in the joint optimiser", true,
              LEVIOSIM_FIELD(optimiser.prior.gyro_bias)},
    Parameter{"workload.initial_accel_bias", Kind::number, "m/s^2", 1e-3, 10,
              "standard deviation of the accelerometer's bias at first, in the joint optimiser",
              true, LEVIOSIM_FIELD(optimiser.prior.accel_bias)},
    Parameter{"workload.gyro_walk", Kind::number, "rad/s^2/sqrt(Hz)", 0, 1,
              "random walk of the gyroscope's bias, in the joint optimiser", true,
              LEVIOSIM_FIELD(optimiser.prior.gyro_walk)},
    Parameter{"workload.accel_walk", Kind::number, "m/s^3/sqrt(Hz)", 0, 10,
              "random walk of the accelerometer's bias, in the joint optimiser", true,
              LEVIOSIM_FIELD(optimiser.prior.accel_walk)},
    Parameter{
        "workload.anchor.rotation", Kind::number, "rad", 0, 10,
        "standard deviation of the oldest keyframe's rotation; 0: free; not in the joint optimiser",
        false, LEVIOSIM_FIELD(optimiser.anchor.rotation)},
    Parameter{
        "workload.anchor.position", Kind::number, "m", 0, 100,
        "standard deviation of the oldest keyframe's position; 0: free; not in the joint optimiser",
        false, LEVIOSIM_FIELD(optimiser.anchor.position)},
    Parameter{
        "workload.anchor.velocity", Kind::number, "m/s", 0, 100,
        "standard deviation of the oldest keyframe's velocity; 0: free; not in the joint optimiser",
        true, LEVIOSIM_FIELD(optimiser.anchor.velocity)},
    Parameter{
        "workload.anchor.initial_velocity", Kind::number, "m/s", 0, 100,
        "standard deviation of the velocity of the very first keyframe; not in the joint optimiser",
        true, LEVIOSIM_FIELD(optimiser.anchor.initial_velocity)},
    Parameter{"workload.bias.gyro", Kind::number, "rad/s", 1e-5, 10,
              "standard deviation of the gyroscope's bias at first; not in the joint optimiser",
              true, LEVIOSIM_FIELD(biases.gyro_stddev)},
    Parameter{"workload.bias.accel", Kind::number, "m/s^2", 1e-5, 10,
              "standard deviation of the accelerometer's bias at first; not in the joint optimiser",
              true, LEVIOSIM_FIELD(biases.accel_stddev)},
    Parameter{"workload.window", Kind::whole, "keyframes", 2, 32,
              "keyframes in the optimiser's window", false, LEVIOSIM_FIELD(optimiser_keyframes)},
    Parameter{"workload.optimiser_iterations", Kind::whole, "iterations", 1, 100,
              "iterations of the optimiser per frame", false, LEVIOSIM_FIELD(optimiser_iterations)},
    Parameter{"workload.max_snapshots", Kind::whole, "snapshots", 1, 1000,
              "snapshots of one newest keyframe in the joint optimiser, at most", true,
              LEVIOSIM_FIELD(max_snapshots)},
    Parameter{"workload.reprojection_noise", Kind::number, "px", 0.01, 100,
              "standard deviation of an observation in the optimiser", false,
              LEVIOSIM_FIELD(optimiser.visual.sigma_px)},
    Parameter{"workload.huber", Kind::number, "px", 0.01, 100,
              "Huber threshold of the optimiser: reprojection error from which on the cost grows "
              "linearly",
              false, LEVIOSIM_FIELD(optimiser.visual.huber_px)},
    Parameter{"workload.lost", Kind::number, "px", 1, 1000,
              "reprojection error above which an observation is rejected, in images 160 px wide",
              false, LEVIOSIM_FIELD(optimiser.visual.lost_px)},
    Parameter{"workload.imu_noise.gyro", Kind::number, "rad/s/sqrt(Hz)", 1e-5, 10,
              "assumed noise density of the gyroscope", true, LEVIOSIM_FIELD(imu_noise.gyro)},
    Parameter{"workload.imu_noise.accel", Kind::number, "m/s^2/sqrt(Hz)", 1e-5, 100,
              "assumed noise density of the accelerometer", true, LEVIOSIM_FIELD(imu_noise.accel)},
    Parameter{"workload.imu_noise.gravity", Kind::number, "m/s^2", 0, 10,
              "standard deviation of each component of the gravity vector", true,
              LEVIOSIM_FIELD(imu_noise.gravity)},
    Parameter{"workload.imu_uncertainty", Kind::toggle, "", 0, 1,
              "less weight for IMU samples at the end of their range, and after a gap", true,
              LEVIOSIM_FIELD(imu_uncertainty.enabled)},
    Parameter{"workload.imu_uncertainty.longest_step", Kind::number, "s", 1e-4, 10,
              "longest time between IMU samples; a longer one is a gap", true,
              LEVIOSIM_FIELD(imu_uncertainty.longest_step)},
    Parameter{"workload.imu_uncertainty.gyro", Kind::number, "rad/s/sqrt(Hz)", 1e-5, 100,
              "noise density of the gyroscope at the end of its range and in gaps", true,
              LEVIOSIM_FIELD(imu_uncertainty.gyro)},
    Parameter{"workload.imu_uncertainty.accel", Kind::number, "m/s^2/sqrt(Hz)", 1e-5, 1000,
              "noise density of the accelerometer at the end of its range and in gaps", true,
              LEVIOSIM_FIELD(imu_uncertainty.accel)},
    Parameter{"workload.imu_range.gyro", Kind::number, "rad/s", 1e-3, 1000,
              "largest angular rate that the gyroscope measures", true,
              LEVIOSIM_FIELD(imu_uncertainty.gyro_range)},
    Parameter{"workload.imu_range.accel", Kind::number, "m/s^2", 1e-3, 10000,
              "largest specific force that the accelerometer measures", true,
              LEVIOSIM_FIELD(imu_uncertainty.accel_range)},
    Parameter{"workload.standstill.frames", Kind::whole, "frames", 2, 1000,
              "frames whose IMU samples must be still for a standstill", true,
              LEVIOSIM_FIELD(stillness.batches)},
    Parameter{"workload.standstill.gyro", Kind::number, "rad/s", 1e-4, 10,
              "standard deviation of the gyroscope's samples above which the vehicle moves", true,
              LEVIOSIM_FIELD(stillness.gyro_stddev)},
    Parameter{"workload.standstill.accel", Kind::number, "m/s^2", 1e-3, 100,
              "standard deviation of the accelerometer's samples above which the vehicle moves",
              true, LEVIOSIM_FIELD(stillness.accel_stddev)},
    Parameter{"workload.gravity_updates", Kind::toggle, "", 0, 1,
              "new measurement of gravity whenever the vehicle stands still", true,
              LEVIOSIM_FIELD(gravity_updates)},
    Parameter{"workload.l1", Kind::whole, "KiB", 0, 1'000'000,
              "budget of L1 for the workload, which leaves the rest to other tasks; 0: all of it",
              false, LEVIOSIM_FIELD(l1_kib)},
};

#undef LEVIOSIM_FIELD

std::vector<Parameter>& all_parameters() {
  static std::vector<Parameter> all(kParameters.begin(), kParameters.end());
  return all;
}

/// Written by add_profile() only.
std::vector<OtherProfile>& added_profiles() {
  static std::vector<OtherProfile> all;
  return all;
}

}  // namespace

std::span<const Parameter> parameters() { return all_parameters(); }

const Parameter* find_parameter(std::string_view name) {
  const std::vector<Parameter>& all = all_parameters();
  const auto it =
      std::find_if(all.begin(), all.end(), [&](const Parameter& p) { return p.name == name; });
  return it == all.end() ? nullptr : &*it;
}

std::span<const OtherProfile> other_profiles() { return added_profiles(); }

void add_profile(OtherProfile profile) {
  const std::vector<std::string> names = profile_names();
  if (std::find(names.begin(), names.end(), profile.name) != names.end())
    throw InputError(
        fmt::format("there is a profile '{}' already; expected another name for the "
                    "workload",
                    profile.name));
  for (const Parameter& p : profile.parameters) {
    if (!p.name.starts_with(kParameterPrefix) || find_parameter(p.name) != nullptr)
      throw InputError(
          fmt::format("the parameter '{}' of the workload '{}' has the name of another, "
                      "or does not begin with '{}'",
                      p.name, profile.name, kParameterPrefix));
    if (!p.is_of_another() || !is_valid(p, p.initial))
      throw InputError(
          fmt::format("the parameter '{}' of the workload '{}' is not between its "
                      "limits where nothing sets it",
                      p.name, profile.name));
    all_parameters().push_back(p);
  }
  added_profiles().push_back(std::move(profile));
}

const OtherProfile* other_profile(std::string_view name) {
  for (const OtherProfile& profile : other_profiles())
    if (profile.name == name) return &profile;
  return nullptr;
}

bool has_parameter(std::string_view profile, const Parameter& parameter) {
  const OtherProfile* const other = other_profile(profile);
  if (other == nullptr) return !parameter.is_of_another();
  return std::any_of(other->parameters.begin(), other->parameters.end(),
                     [&](const Parameter& p) { return p.name == parameter.name; });
}

std::string_view default_profile() {
  return other_profiles().empty() ? "levio" : std::string_view(other_profiles().back().name);
}

bool is_valid(const Parameter& parameter, double value) {
  if (!(value >= parameter.low && value <= parameter.high)) return false;
  return parameter.kind == Kind::number || value == std::floor(value);
}

std::string value_text(const Parameter& parameter, double value) {
  if (parameter.kind == Kind::toggle) return value != 0 ? "on" : "off";
  if (parameter.kind == Kind::whole) return fmt::format("{}", static_cast<int>(value));
  return fmt::format("{}", static_cast<float>(value));
}

std::string Assignment::text() const {
  return fmt::format("{}={}", parameter->name, value_text(*parameter, value));
}

void set_parameters(std::span<const Assignment> assignments, Profile& profile) {
  for (const Assignment& a : assignments) {
    check(is_valid(*a.parameter, a.value), "a workload parameter has a valid value");
    if (!a.parameter->is_of_another()) a.parameter->set(profile, a.value);
  }
}

}  // namespace leviosim::vio
