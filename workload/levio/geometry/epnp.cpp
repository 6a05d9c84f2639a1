#include "workload/levio/geometry/epnp.h"

#include "workload/levio/geometry/epnp_starts.h"
#include "workload/levio/geometry/jacobi.h"
#include "workload/levio/geometry/pose_matrix.h"
#include "workload/levio/geometry/svd.h"

namespace leviosim::vio::levio {
namespace {

constexpr int kUnknowns = 3 * kControlPoints;

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
  const F number = static_cast<float>(points.rows());
  return {sum.x / number, sum.y / number, sum.z / number};
}

/// to = points − centre, row by row.
template <class P>
void subtract(MatrixView<P> to, MatrixView<P> points, const Vec3<P>& centre) {
  for (int i : P::range(0, points.rows())) {
    const Vec3<P> d = row_of<P>(points, i) - centre;
    to(i, 0) = d.x;
    to(i, 1) = d.y;
    to(i, 2) = d.z;
  }
}

/// The work memory of a hypothesis. It stays as a whole until the hypothesis is done.
template <class P>
struct Workspace {
  using Span = typename P::template Span<typename P::F32>;

  explicit Workspace(work::Arena& a)
      : differences(alloc_matrix<P>(a, "points about their centroid", kEpnpSample, 3)),
        camera_differences(alloc_matrix<P>(a, "points in camera about theirs", kEpnpSample, 3)),
        control(alloc_matrix<P>(a, "control points", kControlPoints, 3)),
        weights(alloc_matrix<P>(a, "weights", kEpnpSample, kControlPoints)),
        normal(alloc_matrix<P>(a, "MtM", kUnknowns, kUnknowns)),
        square(alloc_matrix<P>(a, "square of MtM", kUnknowns, kUnknowns)),
        vectors(alloc_matrix<P>(a, "eigenvectors", kUnknowns, kUnknowns)),
        sorted(alloc_matrix<P>(a, "sorted eigenvectors", kUnknowns, kUnknowns)),
        system{alloc_matrix<P>(a, "L", kDistances, kProducts),
               a.alloc<Span>("distances", kDistances)},
        betas(a.alloc<Span>("betas", kBetas)),
        camera_control(alloc_matrix<P>(a, "control points in camera", kControlPoints, 3)),
        camera_points(alloc_matrix<P>(a, "points in camera", kEpnpSample, 3)),
        candidate(alloc_matrix<P>(a, "pose of a start", 4, 4)) {}

  MatrixView<P> differences, camera_differences, control, weights, normal, square, vectors, sorted;
  DistanceSystem<P> system;
  Span betas;
  MatrixView<P> camera_control, camera_points, candidate;
};

/// Control points: the centroid, and one standard deviation along each principal axis.
template <class P>
void choose_control_points(MatrixView<P> points, const Workspace<P>& work, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_choose_control_points");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> covariance = alloc_matrix<P>(scratch, "covariance", 3, 3);
  const MatrixView<P> axes = alloc_matrix<P>(scratch, "principal axes", 3, 3);
  const MatrixView<P> right = alloc_matrix<P>(scratch, "right singular vectors", 3, 3);
  const Span spread = scratch.alloc<Span>("singular values", 3);
  const Vec3<P> centroid = centroid_of<P>(points);
  subtract<P>(work.differences, points, centroid);
  product<P>(covariance, transposed<P>(work.differences), plain<P>(work.differences));
  svd<P>(covariance, axes, spread, right, scratch);

  const F origin[3] = {centroid.x, centroid.y, centroid.z};
  const F number = static_cast<float>(points.rows());
  for (int c = 0; c < 3; ++c) work.control(0, c) = origin[c];
  for (int j : P::range(0, 3)) {
    const F length = work::sqrt(F(F(spread[j]) / number));
    for (int c = 0; c < 3; ++c) work.control(j + 1, c) = origin[c] + length * axes(c, j);
  }
}

/// Inverse by cofactors, each divided by the determinant.
template <class P>
void invert3(MatrixView<P> inverse, MatrixView<P> a) {
  using F = typename P::F32;
  const typename P::Function function("levio_invert3");
  const Vec3<P> r0 = row_of<P>(a, 0), r1 = row_of<P>(a, 1), r2 = row_of<P>(a, 2);
  const Vec3<P> columns[3] = {cross(r1, r2), cross(r2, r0), cross(r0, r1)};
  const F determinant = dot(r0, columns[0]);
  for (int c = 0; c < 3; ++c) {
    inverse(0, c) = columns[c].x / determinant;
    inverse(1, c) = columns[c].y / determinant;
    inverse(2, c) = columns[c].z / determinant;
  }
}

/// Weights of the control points whose sums are the points of the sample.
template <class P>
void find_weights(const Workspace<P>& work, work::Arena& scratch) {
  using F = typename P::F32;
  const typename P::Function function("levio_find_weights");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> axes = alloc_matrix<P>(scratch, "control axes", 3, 3);
  const MatrixView<P> inverse = alloc_matrix<P>(scratch, "inverse of the axes", 3, 3);
  const MatrixView<P> parts = alloc_matrix<P>(scratch, "weights of the axes", 3, kEpnpSample);
  for (int j : P::range(0, 3))
    for (int c = 0; c < 3; ++c) axes(c, j) = work.control(j + 1, c) - work.control(0, c);
  invert3<P>(inverse, axes);
  product<P>(parts, plain<P>(inverse), transposed<P>(work.differences));
  for (int i : P::range(0, kEpnpSample)) {
    F rest = 1.0f;
    for (int j = 0; j < 3; ++j) {
      const F weight = parts(j, i);
      work.weights(i, j + 1) = weight;
      rest -= weight;
    }
    work.weights(i, 0) = rest;
  }
}

/// MᵀM, the two rows of M of each point added one point after the other: 144 elements are read and
/// written for each.
template <class P>
void accumulate_normal_matrix(const EpnpSample<P>& sample, const CameraConstants<P>& camera,
                              const Workspace<P>& work) {
  using F = typename P::F32;
  const typename P::Function function("levio_accumulate_normal_matrix");
  typename P::template Array<F, kUnknowns> row_u, row_v;
  fill<P>(work.normal, 0.0f);
  for (int i : P::range(0, kEpnpSample)) {
    const F u = sample.pixels(i, 0), v = sample.pixels(i, 1);
    for (int j : P::range(0, kControlPoints)) {
      const F weight = work.weights(i, j);
      row_u[3 * j] = weight * camera.fx();
      row_u[3 * j + 1] = 0.0f;
      row_u[3 * j + 2] = weight * F(camera.cx() - u);
      row_v[3 * j] = 0.0f;
      row_v[3 * j + 1] = weight * camera.fy();
      row_v[3 * j + 2] = weight * F(camera.cy() - v);
    }
    for (int r : P::range(0, kUnknowns)) {
      const F ur = row_u[r], vr = row_v[r];
      for (int c : P::range(0, kUnknowns)) {
        F sum = work.normal(r, c);
        sum += ur * row_u[c];
        sum += vr * row_v[c];
        work.normal(r, c) = sum;
      }
    }
  }
}

/// The eigenvectors of (MᵀM)², scaled to a Frobenius norm of 1, as rows; the smallest
/// eigenvalue's first.
template <class P>
void find_null_vectors(const Workspace<P>& work, work::Arena& scratch) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Indices = typename P::template Span<typename P::U16>;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_find_null_vectors");
  const work::Arena::Frame frame(scratch);
  const Span values = scratch.alloc<Span>("eigenvalues", kUnknowns);
  const Indices order = scratch.alloc<Indices>("order of eigenvalues", kUnknowns);
  product<P>(work.square, plain<P>(work.normal), plain<P>(work.normal));
  F squares = 0.0f;
  for (int i : P::range(0, kUnknowns * kUnknowns)) {
    const F x = work.square.data()[i];
    squares += x * x;
  }
  const F scale = F(1.0f) / work::sqrt(squares);
  for (int i : P::range(0, kUnknowns * kUnknowns)) work.square.data()[i] *= scale;
  jacobi_eigen<P>(work.square, work.vectors, kMostEpnpRotations, F(kEpnpTolerance));
  for (int i : P::range(0, kUnknowns)) values[i] = F(work.square(i, i));
  sort_descending<P>(values, order);
  for (int i : P::range(0, kUnknowns)) {
    const MatrixView<P> column = work.vectors.from_column(I32(order[kUnknowns - 1 - i]));
    for (int k : P::range(0, kUnknowns)) work.sorted(i, k) = F(column(k, 0));
  }
}

/// Control points and points of the sample in the camera frame, the first point in front of it:
/// both signs of β give the same distances.
template <class P>
void place_points(const Workspace<P>& work) {
  using F = typename P::F32;
  const typename P::Function function("levio_place_points");
  for (int j : P::range(0, kUnknowns)) {
    F sum = 0.0f;
    for (int k : P::range(0, kBetas)) sum += work.betas[k] * work.sorted(k, j);
    work.camera_control.data()[j] = sum;
  }
  product<P>(work.camera_points, plain<P>(work.weights), plain<P>(work.camera_control));
  if (F(work.camera_points(0, 2)) < 0.0f) {
    for (int j : P::range(0, kUnknowns)) work.camera_control.data()[j] *= F(-1.0f);
    for (int j : P::range(0, 3 * kEpnpSample)) work.camera_points.data()[j] *= F(-1.0f);
  }
}

/// The pose that brings the points of the sample closest to those in the camera frame.
template <class P>
void align(MatrixView<P> points, const Workspace<P>& work, work::Arena& scratch) {
  using F = typename P::F32;
  using Span = typename P::template Span<F>;
  const typename P::Function function("levio_align");
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> correlation = alloc_matrix<P>(scratch, "correlation", 3, 3);
  const MatrixView<P> u = alloc_matrix<P>(scratch, "U", 3, 3);
  const MatrixView<P> v = alloc_matrix<P>(scratch, "V", 3, 3);
  const MatrixView<P> rotation = alloc_matrix<P>(scratch, "rotation", 3, 3);
  const Span s = scratch.alloc<Span>("singular values", 3);
  const Vec3<P> world = centroid_of<P>(points);
  const Vec3<P> camera = centroid_of<P>(work.camera_points);
  subtract<P>(work.differences, points, world);
  subtract<P>(work.camera_differences, work.camera_points, camera);
  product<P>(correlation, transposed<P>(work.camera_differences), plain<P>(work.differences));
  svd<P>(correlation, u, s, v, scratch);
  product<P>(rotation, plain<P>(u), transposed<P>(v));
  Mat3<P> R{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) R.m[r][c] = F(rotation(r, c));
  if (determinant(R) < 0.0f) {
    for (int r : P::range(0, 3)) u(r, 2) *= F(-1.0f);
    product<P>(rotation, plain<P>(u), transposed<P>(v));
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) R.m[r][c] = F(rotation(r, c));
  }
  store_pose<P>(work.candidate, {R, camera - R * world});
}

/// Of the points of the sample; a division and a root each.
template <class P>
typename P::F32 mean_error(MatrixView<P> T_camera_world, const EpnpSample<P>& sample,
                           const CameraConstants<P>& camera) {
  using F = typename P::F32;
  const typename P::Function function("levio_mean_error");
  const Pose<P> T = load_pose<P>(T_camera_world);
  F sum = 0.0f;
  for (int i : P::range(0, kEpnpSample)) {
    const Vec3<P> x = T * row_of<P>(sample.points, i);
    const F inverse = F(1.0f) / x.z;
    const F du = camera.fx() * x.x * inverse + camera.cx() - sample.pixels(i, 0);
    const F dv = camera.fy() * x.y * inverse + camera.cy() - sample.pixels(i, 1);
    sum += work::sqrt(F(du * du + dv * dv));
    sum += depth_penalty<P>(x.z);
  }
  return sum / F(static_cast<float>(kEpnpSample));
}

/// Makes the rotation of a pose orthonormal.
template <class P>
void orthonormalise_rotation(MatrixView<P> pose, work::Arena& scratch) {
  using F = typename P::F32;
  const work::Arena::Frame frame(scratch);
  const MatrixView<P> R = alloc_matrix<P>(scratch, "rotation", 3, 3);
  for (int r : P::range(0, 3))
    for (int c : P::range(0, 3)) R(r, c) = F(pose(r, c));
  orthonormalise_columns<P>(R);
  for (int r : P::range(0, 3))
    for (int c : P::range(0, 3)) pose(r, c) = F(R(r, c));
}

}  // namespace

template <class P>
typename P::F32 solve_epnp(const EpnpSample<P>& sample, const CameraConstants<P>& camera,
                           MatrixView<P> T_camera_world, work::Arena& scratch) {
  using F = typename P::F32;
  const typename P::Function function("levio_solve_epnp");
  const work::Arena::Frame frame(scratch);
  const Workspace<P> work(scratch);
  choose_control_points<P>(sample.points, work, scratch);
  find_weights<P>(work, scratch);
  accumulate_normal_matrix<P>(sample, camera, work);
  find_null_vectors<P>(work, scratch);
  fill_distance_system<P>(work.system, work.sorted, work.control);
  F best = 0.0f;
  for (int start : P::range(0, kStarts)) {
    start_betas<P>(work.system, start, work.betas, scratch);
    refine_betas<P>(work.system, work.betas, scratch);
    place_points<P>(work);
    align<P>(sample.points, work, scratch);
    const F error = mean_error<P>(work.candidate, sample, camera);
    if (start > 0 && !(error < best)) continue;
    best = error;
    copy<P>(T_camera_world, work.candidate);
  }
  orthonormalise_rotation<P>(T_camera_world, scratch);
  return best;
}

template work::Native::F32 solve_epnp(const EpnpSample<work::Native>&,
                                      const CameraConstants<work::Native>&,
                                      MatrixView<work::Native>, work::Arena&);
template work::Counting::F32 solve_epnp(const EpnpSample<work::Counting>&,
                                        const CameraConstants<work::Counting>&,
                                        MatrixView<work::Counting>, work::Arena&);

}  // namespace leviosim::vio::levio
