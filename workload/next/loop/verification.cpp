#include "workload/next/loop/verification.h"

#include "workload/next/loop/place_matching.h"
#include "workload/next/loop/upright_pose.h"
#include "workload/vision/guided_matcher.h"

namespace leviosim::vio {
namespace {

constexpr int kColumns = 4, kRows = 3;  ///< cells of the image

/// Points of a place and the pixels that they match.
template <class P>
levio::LandmarkMatches<P> gather(work::Arena& local, const StoredView<P>& place,
                                 const FeatureList<P>& features, const MatchList<P>& matches,
                                 const LoopCamera& camera) {
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
  return {points, pixels, matches.count};
}

/// The pose that descriptors alone lead to.
template <class P>
std::optional<YawTransform<P>> first_pose(work::Machine& machine, const StoredView<P>& place,
                                          const FeatureList<P>& features,
                                          const Mat3<P>& R_camera_upright, const LoopCamera& camera,
                                          const VerificationOptions& options,
                                          levio::ShiftRegister<P>& random) {
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  MatchList<P> matches = alloc_matches<P>(machine, place.count);
  match_place<P>(machine, features, place.descriptors, place.count, options, matches);
  if (matches.count < options.min_matches) return std::nullopt;
  const UprightInput<P> input{gather(local, place, features, matches, camera), camera.camera,
                              R_camera_upright};
  UprightPose<P> found = find_upright_pose<P>(machine, input, options.pose, random);
  if (found.inliers < options.min_pair_inliers) return std::nullopt;
  if (!refine_upright_pose<P>(local, input, options.pose, found.T)) return std::nullopt;
  return found.T;
}

/// Features around where a pose puts the points of the place.
template <class P>
MatchList<P> search_around(work::Machine& machine, const StoredView<P>& place,
                           const FeatureList<P>& features, const LoopCamera& camera,
                           const Pose<P>& T_camera_place, const VerificationOptions& options) {
  using I32 = typename P::I32;
  using Byte = typename P::Byte;
  work::Arena& local = machine.local();
  MatchList<P> matches = alloc_matches<P>(machine, features.capacity);
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

/// What of a place is where it ought to be: points that a pose puts into the image, away from its
/// margin, and those of them that are seen, by vertical stripes of the image.
template <class P>
struct Coverage {
  using I32 = typename P::I32;
  using Numbers = typename P::template Span<I32>;

  Numbers expected, seen;  ///< one for each stripe
  I32 in_view = 0;
  I32 cells = 0;  ///< of kColumns × kRows, that hold inliers
};

template <class P>
void count_expected(const StoredView<P>& place, const Pose<P>& T_camera_place,
                    const LoopCamera& camera, float margin, Coverage<P>& coverage) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const PinholeCamera& c = camera.camera;
  const F right = static_cast<float>(camera.width) - margin,
          bottom = static_cast<float>(camera.height) - margin;
  const F columns = static_cast<float>(kColumns) / static_cast<float>(camera.width);
  for (int i : P::range(0, place.count)) {
    const Vec3<P> stored{F(place.points[3 * i]), F(place.points[3 * i + 1]),
                         F(place.points[3 * i + 2])};
    const Vec3<P> x = T_camera_place * stored;
    if (!(x.z > F(0.05f))) continue;
    const F inverse = F(1.0f) / x.z;
    const F u = F(c.fx) * (x.x * inverse) + F(c.cx), v = F(c.fy) * (x.y * inverse) + F(c.cy);
    if (!(u > F(margin) && u < right && v > F(margin) && v < bottom)) continue;
    ++coverage.in_view;
    coverage.expected[work::to_i32(u * columns)] += I32(1);
  }
}

template <class P>
void count_seen(const levio::LandmarkMatches<P>& matches,
                typename P::template Span<typename P::Byte> inliers, const LoopCamera& camera,
                Coverage<P>& coverage) {
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
    coverage.seen[column] += I32(1);
  }
  coverage.cells = work::popcount(cells);
}

template <class P>
bool is_covered(const Coverage<P>& coverage, int inliers, const VerificationOptions& options) {
  using I32 = typename P::I32;
  if (static_cast<float>(inliers) <
      options.min_share * static_cast<float>(work::value(coverage.in_view)))
    return false;
  if (coverage.cells < I32(options.min_cells)) return false;
  for (int stripe : P::range(0, kColumns))
    if (I32(coverage.expected[stripe]) >= I32(options.stripe_points) &&
        I32(coverage.seen[stripe]) < I32(options.min_stripe_inliers))
      return false;
  return true;
}

}  // namespace

template <class P>
std::optional<Recognised<P>> recognise(work::Machine& machine, const StoredView<P>& place,
                                       const FeatureList<P>& features,
                                       const Mat3<P>& R_odometry_camera, const LoopCamera& camera,
                                       const VerificationOptions& options,
                                       levio::ShiftRegister<P>& random) {
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const Mat3<P> R = transpose(R_odometry_camera);
  const std::optional<YawTransform<P>> first =
      first_pose(machine, place, features, R, camera, options, random);
  if (!first) return std::nullopt;
  const MatchList<P> matches =
      search_around(machine, place, features, camera, upright_camera_pose<P>(R, *first), options);
  if (matches.count < options.min_inliers) return std::nullopt;
  const UprightInput<P> input{gather(local, place, features, matches, camera), camera.camera, R};
  YawTransform<P> T = *first;
  if (!refine_upright_pose<P>(local, input, options.pose, T)) return std::nullopt;
  const auto inliers =
      local.alloc<typename P::template Span<typename P::Byte>>("inlier mask", matches.count);
  const int agreeing =
      mark_inliers<P>(input, T, options.inlier_px, options.pose.min_depth, inliers);
  if (agreeing < options.min_inliers) return std::nullopt;
  Coverage<P> coverage;
  coverage.expected = local.alloc<typename Coverage<P>::Numbers>("points in stripes", kColumns);
  coverage.seen = local.alloc<typename Coverage<P>::Numbers>("inliers in stripes", kColumns);
  for (int stripe : P::range(0, kColumns)) {
    coverage.expected[stripe] = 0;
    coverage.seen[stripe] = 0;
  }
  count_expected(place, upright_camera_pose<P>(R, T), camera, options.radius_px, coverage);
  count_seen(input.matches, inliers, camera, coverage);
  if (!is_covered(coverage, agreeing, options)) return std::nullopt;
  return Recognised<P>{T, agreeing};
}

#define LEVIOSIM_INSTANTIATE(P)                                                    \
  template std::optional<Recognised<P>> recognise(                                 \
      work::Machine&, const StoredView<P>&, const FeatureList<P>&, const Mat3<P>&, \
      const LoopCamera&, const VerificationOptions&, levio::ShiftRegister<P>&);
LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
