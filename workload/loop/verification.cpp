#include "workload/loop/verification.h"

#include "workload/geometry/pnp_ransac.h"
#include "workload/geometry/pose_refinement.h"
#include "workload/loop/place_matching.h"
#include "workload/vision/guided_matcher.h"

namespace leviosim::vio {
namespace {

constexpr int kColumns = 4, kRows = 3;  ///< cells of the image

/// Points of a place and the pixels that they match.
template <class P>
PnpInput<P> gather(work::Arena& local, const StoredView<P>& place, const FeatureList<P>& features,
                   const MatchList<P>& matches, const LoopCamera& camera) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Floats = typename P::template Span<F>;
  const auto points = local.alloc<Floats>("matched points", 3 * matches.count);
  const auto pixels = local.alloc<Floats>("matched pixels", 2 * matches.count);
  const F unit = 1.0f / static_cast<float>(camera.steps);
  for (int i : P::range(0, matches.count)) {
    const I32 at = I32(matches.reference[i]) * I32(3);
    for (int c = 0; c < 3; ++c) points[3 * i + c] = F(place.points[I32(at + I32(c))]);
    const I32 feature = matches.query[i];
    pixels[2 * i] = work::to_f32(I32(features.x[feature])) * unit;
    pixels[2 * i + 1] = work::to_f32(I32(features.y[feature])) * unit;
  }
  return {points, pixels, matches.count, camera.camera};
}

/// T_camera_place by EPnP RANSAC on descriptors alone.
template <class P>
std::optional<Pose<P>> first_pose(work::Machine& machine, const StoredView<P>& place,
                                  const FeatureList<P>& features, const LoopCamera& camera,
                                  const VerificationOptions& options, std::uint32_t seed) {
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  MatchList<P> matches = alloc_matches<P>(local, place.count);
  match_place<P>(machine, features, place.descriptors, place.count, options, matches);
  if (matches.count < options.min_matches) return std::nullopt;
  PnpOptions ransac;
  ransac.iterations = options.ransac_iterations;
  ransac.inlier_px = options.ransac_inlier_px;
  ransac.seed = seed;
  const PnpResult<P> found =
      estimate_pose_epnp<P>(machine, gather(local, place, features, matches, camera), ransac);
  if (!found.ok || found.inliers < options.min_ransac_inliers) return std::nullopt;
  return found.T_camera_world;
}

/// Features around where a pose puts the points of the place.
template <class P>
MatchList<P> search_around(work::Machine& machine, const StoredView<P>& place,
                           const FeatureList<P>& features, const LoopCamera& camera,
                           const Pose<P>& T_camera_place, const VerificationOptions& options) {
  using I32 = typename P::I32;
  using Byte = typename P::Byte;
  work::Arena& local = machine.local();
  MatchList<P> matches = alloc_matches<P>(local, features.capacity);
  const auto ages = local.alloc<typename P::template Span<Byte>>("ages", place.count);
  for (int i : P::range(0, place.count)) ages[i] = work::narrow<Byte>(I32(0));
  const GuidedInput<P> input{
      place.points,   place.descriptors, ages,         place.count,   0,
      T_camera_place, camera.camera,     camera.width, camera.height, camera.steps};
  GuidedOptions guided;
  guided.radius_px = options.radius_px;
  guided.max_distance = options.guided_distance;
  match_guided<P>(machine, input, features, guided, matches);
  return matches;
}

/// Points of the place that the pose puts into the image, away from its margin.
template <class P>
typename P::I32 points_in_view(const StoredView<P>& place, const Pose<P>& T_camera_place,
                               const LoopCamera& camera, float margin) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const PinholeCamera& c = camera.camera;
  const F right = static_cast<float>(camera.width) - margin,
          bottom = static_cast<float>(camera.height) - margin;
  I32 number = 0;
  for (int i : P::range(0, place.count)) {
    const Vec3<P> stored{F(place.points[3 * i]), F(place.points[3 * i + 1]),
                         F(place.points[3 * i + 2])};
    const Vec3<P> x = T_camera_place * stored;
    if (!(x.z > F(0.05f))) continue;
    const F inverse = F(1.0f) / x.z;
    const F u = F(c.fx) * (x.x * inverse) + F(c.cx), v = F(c.fy) * (x.y * inverse) + F(c.cy);
    if (u > F(margin) && u < right && v > F(margin) && v < bottom) ++number;
  }
  return number;
}

/// Cells of the image that hold inliers.
template <class P>
typename P::I32 cells_with_inliers(const PnpInput<P>& matches,
                                   typename P::template Span<typename P::Byte> inliers,
                                   const LoopCamera& camera) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U32 = typename P::U32;
  U32 cells = 0u;
  const F columns = static_cast<float>(kColumns) / static_cast<float>(camera.width);
  const F rows = static_cast<float>(kRows) / static_cast<float>(camera.height);
  for (int i : P::range(0, matches.n)) {
    if (I32(inliers[i]) == I32(0)) continue;
    const I32 column = work::to_i32(F(matches.pixels[2 * i]) * columns);
    const I32 row = work::to_i32(F(matches.pixels[2 * i + 1]) * rows);
    cells |= U32(1u) << I32(row * I32(kColumns) + column);
  }
  return work::popcount(cells);
}

}  // namespace

template <class P>
std::optional<Recognised<P>> recognise(work::Machine& machine, const StoredView<P>& place,
                                       const FeatureList<P>& features, const LoopCamera& camera,
                                       const VerificationOptions& options, std::uint32_t seed) {
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const std::optional<Pose<P>> first = first_pose(machine, place, features, camera, options, seed);
  if (!first) return std::nullopt;
  const MatchList<P> matches = search_around(machine, place, features, camera, *first, options);
  if (matches.count < options.min_inliers) return std::nullopt;
  const PnpInput<P> input = gather(local, place, features, matches, camera);
  const auto inliers =
      local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", matches.count);
  RefinementOptions refinement;
  refinement.inlier_px = options.inlier_px;
  refinement.rotation = refinement.position = 1.0f;  // EPnP's pose is no prediction
  const RefinedPose<P> refined = refine_pose<P>(machine, input, *first, refinement, inliers);
  if (!refined.ok || refined.inliers < options.min_inliers) return std::nullopt;
  const int in_view =
      work::value(points_in_view(place, refined.T_camera_world, camera, options.radius_px));
  if (static_cast<float>(refined.inliers) < options.min_share * static_cast<float>(in_view))
    return std::nullopt;
  if (work::value(cells_with_inliers(input, inliers, camera)) < options.min_cells)
    return std::nullopt;
  return Recognised<P>{inverse(refined.T_camera_world), refined.inliers};
}

template std::optional<Recognised<work::Native>> recognise(
    work::Machine&, const StoredView<work::Native>&, const FeatureList<work::Native>&,
    const LoopCamera&, const VerificationOptions&, std::uint32_t);
template std::optional<Recognised<work::Counting>> recognise(
    work::Machine&, const StoredView<work::Counting>&, const FeatureList<work::Counting>&,
    const LoopCamera&, const VerificationOptions&, std::uint32_t);

}  // namespace leviosim::vio
