#include "workload/geometry/epnp.h"

#include "workload/geometry/camera_matrix.h"
#include "workload/geometry/epnp_betas.h"
#include "workload/math/svd.h"

namespace leviosim::vio {
namespace {

/// A control axis shorter than this part of the longest is degenerate: the second one means that
/// the sample is collinear.
constexpr float kCollinear = 1e-3f;
/// A third axis shorter than this part of the first is lengthened to it. The sample is then close
/// to planar; the length of an axis is free, and its weights stay finite.
constexpr float kShortestAxis = 0.02f;

constexpr int kUnknowns = 3 * kControlPoints;

/// The matches of one sample, side by side.
template <class P>
struct Sample {
  MatrixView<P> points;  ///< s×3, world
  MatrixView<P> pixels;  ///< s×2
  int size() const { return points.rows(); }
};

template <class P>
Sample<P> gather(const PnpInput<P>& input, typename P::template Span<const typename P::U16> indices,
                 work::Arena& scratch) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const int s = indices.size();
  const Sample<P> sample{alloc_matrix<P>(scratch, "sample points", s, 3),
                         alloc_matrix<P>(scratch, "sample pixels", s, 2)};
  for (int i : P::range(0, s)) {
    const I32 match = indices[i];
    const I32 point = match * 3;
    const I32 pixel = match * 2;
    for (int c = 0; c < 3; ++c) sample.points(i, c) = F(input.points[point + c]);
    for (int c = 0; c < 2; ++c) sample.pixels(i, c) = F(input.pixels[pixel + c]);
  }
  return sample;
}

template <class P>
Vec3<P> row_of(MatrixView<P> a, int r) {
  using F = typename P::F32;
  return {F(a(r, 0)), F(a(r, 1)), F(a(r, 2))};
}

template <class P>
Vec3<P> centroid_of(MatrixView<P> points) {
  using F = typename P::F32;
  Vec3<P> sum{0.0f, 0.0f, 0.0f};
  for (int i : P::range(0, points.rows())) sum = sum + row_of<P>(points, i);
  return sum * F(1.0f / static_cast<float>(points.rows()));
}

/// Covariance of the points about their centroid.
template <class P>
void fill_covariance(MatrixView<P> covariance, MatrixView<P> points, const Vec3<P>& centroid) {
  using F = typename P::F32;
  Mat3<P> sum = Mat3<P>::zero();
  for (int i : P::range(0, points.rows())) {
    const Vec3<P> d = row_of<P>(points, i) - centroid;
    const F component[3] = {d.x, d.y, d.z};
    for (int r = 0; r < 3; ++r)
      for (int c = r; c < 3; ++c) sum.m[r][c] += component[r] * component[c];
  }
  const F scale = 1.0f / static_cast<float>(points.rows());
  for (int r = 0; r < 3; ++r)
    for (int c = r; c < 3; ++c) {
      const F value = sum.m[r][c] * scale;
      covariance(r, c) = value;
      covariance(c, r) = value;
    }
}

/// Chooses the control points (4×3): the centroid, and one step of the standard deviation along
/// each principal axis; writes the weights of the points (s×4).
/// @return false if the points are collinear
template <class P>
bool choose_control_points(MatrixView<P> points, MatrixView<P> control, MatrixView<P> weights,
                           const PnpOptions& options, work::Arena& scratch) {
  using F = typename P::F32;
  const typename P::Function function("choose_control_points");
  const MatrixView<P> covariance = alloc_matrix<P>(scratch, "covariance", 3, 3);
  const MatrixView<P> axes = alloc_matrix<P>(scratch, "principal axes", 3, 3);
  const Vec3<P> centroid = centroid_of<P>(points);
  fill_covariance<P>(covariance, points, centroid);
  jacobi_eigen_classical<P>(covariance, axes, options.jacobi_max_rotations,
                            options.jacobi_tolerance, options.diagonal);
  sort_eigen_descending<P>(covariance, axes);

  const F longest = work::sqrt(work::max(F(covariance(0, 0)), F(0.0f)));
  const F second = work::sqrt(work::max(F(covariance(1, 1)), F(0.0f)));
  const F third = work::sqrt(work::max(F(covariance(2, 2)), F(0.0f)));
  if (!(second > kCollinear * longest)) return false;
  const F lengths[3] = {longest, second, work::max(third, F(kShortestAxis * longest))};

  const F origin[3] = {centroid.x, centroid.y, centroid.z};
  for (int c = 0; c < 3; ++c) control(0, c) = origin[c];
  for (int i : P::range(0, points.rows())) weights(i, 0) = 1.0f;
  for (int j = 0; j < 3; ++j) {
    const Vec3<P> axis{F(axes(0, j)), F(axes(1, j)), F(axes(2, j))};
    const Vec3<P> tip = centroid + axis * lengths[j];
    control(j + 1, 0) = tip.x;
    control(j + 1, 1) = tip.y;
    control(j + 1, 2) = tip.z;
    const F inverse = F(1.0f) / lengths[j];
    for (int i : P::range(0, points.rows())) {
      const F weight = dot(axis, row_of<P>(points, i) - centroid) * inverse;
      weights(i, j + 1) = weight;
      weights(i, 0) -= weight;
    }
  }
  return true;
}

/// M (2s×12): two equations per match that are linear in the control points in the camera frame.
template <class P>
void fill_measurements(MatrixView<P> m, const Sample<P>& sample, MatrixView<P> weights,
                       const PinholeCamera& camera) {
  using F = typename P::F32;
  const typename P::Function function("fill_measurements");
  for (int i : P::range(0, sample.size())) {
    const F du = camera.cx - F(sample.pixels(i, 0));
    const F dv = camera.cy - F(sample.pixels(i, 1));
    for (int j : P::range(0, kControlPoints)) {
      const F weight = weights(i, j);
      m(2 * i, 3 * j) = weight * camera.fx;
      m(2 * i, 3 * j + 1) = 0.0f;
      m(2 * i, 3 * j + 2) = weight * du;
      m(2 * i + 1, 3 * j) = 0.0f;
      m(2 * i + 1, 3 * j + 1) = weight * camera.fy;
      m(2 * i + 1, 3 * j + 2) = weight * dv;
    }
  }
}

/// The four eigenvectors of (MᵀM)² with the smallest eigenvalues, smallest first, as columns
/// (12×4).
template <class P>
void find_null_vectors(MatrixView<P> null_vectors, MatrixView<P> m, const PnpOptions& options,
                       work::Arena& scratch) {
  using F = typename P::F32;
  const typename P::Function function("find_null_vectors");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> matrix = alloc_matrix<P>(scratch, "null space matrix", kUnknowns, kUnknowns);
  const MatrixView<P> vectors = alloc_matrix<P>(scratch, "eigenvectors", kUnknowns, kUnknowns);
  if (options.square_normal_matrix) {
    const MatrixView<P> normal = alloc_matrix<P>(scratch, "MtM", kUnknowns, kUnknowns);
    multiply_transposed<P>(normal, m, m);
    normalised_square<P>(matrix, normal);
  } else {
    normalised_square<P>(matrix, m);
  }
  jacobi_eigen_classical<P>(matrix, vectors, options.jacobi_max_rotations, options.jacobi_tolerance,
                            options.diagonal);
  sort_eigen_descending<P>(matrix, vectors);
  for (int r : P::range(0, kUnknowns))
    for (int k : P::range(0, kBetas)) null_vectors(r, k) = F(vectors(r, kUnknowns - 1 - k));
}

/// The points of the sample in the camera frame (s×3), in front of the camera.
template <class P>
void place_points(MatrixView<P> camera_points, MatrixView<P> null_vectors, MatrixView<P> weights,
                  typename P::template Span<typename P::F32> betas, work::Arena& scratch) {
  using F = typename P::F32;
  const typename P::Function function("place_points");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> control =
      alloc_matrix<P>(scratch, "control points in camera", kControlPoints, 3);
  // The first control point is the centroid: it tells the side of the camera. Both signs of β give
  // the same distances.
  F centroid_z = 0.0f;
  for (int k : P::range(0, kBetas)) centroid_z += betas[k] * null_vectors(2, k);
  F sign = 1.0f;
  if (centroid_z < 0.0f) sign = -1.0f;
  for (int j : P::range(0, kUnknowns)) {
    F sum = 0.0f;
    for (int k : P::range(0, kBetas)) sum += betas[k] * null_vectors(j, k);
    control.data()[j] = sum * sign;
  }
  multiply<P>(camera_points, weights, control);
}

/// The rotation and translation that bring the world points closest to the camera points.
template <class P>
Pose<P> align(MatrixView<P> world_points, MatrixView<P> camera_points, const PnpOptions& options) {
  using F = typename P::F32;
  const typename P::Function function("align");
  const Vec3<P> world = centroid_of<P>(world_points);
  const Vec3<P> camera = centroid_of<P>(camera_points);
  Mat3<P> correlation = Mat3<P>::zero();
  for (int i : P::range(0, world_points.rows())) {
    const Vec3<P> w = row_of<P>(world_points, i) - world;
    const Vec3<P> c = row_of<P>(camera_points, i) - camera;
    const F cs[3] = {c.x, c.y, c.z};
    const F ws[3] = {w.x, w.y, w.z};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) correlation.m[a][b] += cs[a] * ws[b];
  }
  Mat3<P> u, v;
  Vec3<P> s;
  svd3<P>(correlation, u, s, v, kSvd3Rotations, kSvdTolerance, options.diagonal);
  const F handedness = determinant(u) * determinant(v);
  if (handedness < 0.0f)
    for (int r = 0; r < 3; ++r) u.m[r][2] = -u.m[r][2];
  const Mat3<P> R = u * transpose(v);
  return {R, camera - R * world};
}

template <class P>
typename P::F32 mean_reprojection_error(const Pose<P>& T_camera_world, const Sample<P>& sample,
                                        const PinholeCamera& camera) {
  using F = typename P::F32;
  const typename P::Function function("mean_reprojection_error");
  const CameraMatrix<P> K = CameraMatrix<P>::of(camera);
  F sum = 0.0f;
  for (int i : P::range(0, sample.size())) {
    const Vec3<P> x = T_camera_world * row_of<P>(sample.points, i);
    const Vec2<P> d = reprojection_difference<P>(K, x, sample.pixels(i, 0), sample.pixels(i, 1));
    sum += work::sqrt(d.x * d.x + d.y * d.y);
  }
  return sum * F(1.0f / static_cast<float>(sample.size()));
}

}  // namespace

template <class P>
EpnpSolution<P> solve_epnp(const PnpInput<P>& input,
                           typename P::template Span<const typename P::U16> indices,
                           const PnpOptions& options, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("solve_epnp");
  const work::Arena::Frame frame(scratch);
  const Sample<P> sample = gather<P>(input, indices, scratch);
  const int s = sample.size();
  const MatrixView<P> control = alloc_matrix<P>(scratch, "control points", kControlPoints, 3);
  const MatrixView<P> weights = alloc_matrix<P>(scratch, "weights", s, kControlPoints);
  const MatrixView<P> m = alloc_matrix<P>(scratch, "M", 2 * s, kUnknowns);
  const MatrixView<P> null_vectors = alloc_matrix<P>(scratch, "null vectors", kUnknowns, kBetas);
  const DistanceSystem<P> system{alloc_matrix<P>(scratch, "L", kDistances, kProducts),
                                 scratch.alloc<Span>("distances", kDistances)};
  const Span betas = scratch.alloc<Span>("betas", kBetas);
  const MatrixView<P> camera_points = alloc_matrix<P>(scratch, "points in camera", s, 3);

  EpnpSolution<P> best;
  best.mean_error_px = 1e9f;
  if (!choose_control_points<P>(sample.points, control, weights, options, scratch)) return best;
  fill_measurements<P>(m, sample, weights, input.camera);
  find_null_vectors<P>(null_vectors, m, options, scratch);
  fill_distance_system<P>(system, null_vectors, control);
  for (int hypothesis : P::range(0, kBetaHypotheses)) {
    if (!initial_betas<P>(system, hypothesis, betas, scratch)) continue;
    refine_betas<P>(system, betas, options.gauss_newton_steps, scratch);
    place_points<P>(camera_points, null_vectors, weights, betas, scratch);
    const Pose<P> pose = align<P>(sample.points, camera_points, options);
    const F error = mean_reprojection_error<P>(pose, sample, input.camera);
    if (error < best.mean_error_px) best = {true, pose, error};  // never with NaN
  }
  return best;
}

template EpnpSolution<work::Native> solve_epnp<work::Native>(const PnpInput<work::Native>&,
                                                             work::NativeSpan<const std::uint16_t>,
                                                             const PnpOptions&, work::Arena&);
template EpnpSolution<work::Counting> solve_epnp<work::Counting>(
    const PnpInput<work::Counting>&, work::CountedSpan<const std::uint16_t>, const PnpOptions&,
    work::Arena&);

}  // namespace leviosim::vio
