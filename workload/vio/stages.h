// The names of the workload's stages: as the paper's tables have them, and what `next` adds.
#pragma once

#include <string_view>

namespace leviosim::vio::stages {

inline constexpr std::string_view kImu = "IMU pre-integration";
inline constexpr std::string_view kExtraction = "feature extraction";
inline constexpr std::string_view kWorldMatching = "world matching";
inline constexpr std::string_view kGuided = "guided matching";
inline constexpr std::string_view kRefinement = "pose refinement";
inline constexpr std::string_view kEpnp = "EPnP RANSAC";
inline constexpr std::string_view kFrameMatching = "frame matching";
inline constexpr std::string_view kPatches = "patch alignment";
inline constexpr std::string_view kEightPoint = "8-point RANSAC";
inline constexpr std::string_view kKeyframeSelection = "keyframe selection";
inline constexpr std::string_view kTriangulation = "triangulation";
inline constexpr std::string_view kInitialisation = "initialisation";
inline constexpr std::string_view kOptimiserUpdate = "optimiser update";
inline constexpr std::string_view kOptimiser = "optimiser iteration";

}  // namespace leviosim::vio::stages
