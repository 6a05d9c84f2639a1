#include "workload/next/loop/upright_pose.h"

#include "workload/inertial/record.h"
#include "workload/math/solve.h"

namespace leviosim::vio {
namespace {

constexpr int kUnknowns = 4;  ///< yaw, x, y, z

template <class P>
Vec3<P> point_of(const UprightInput<P>& input, typename P::I32 i) {
  return load_vec3<P>(input.matches.points.subspan(typename P::I32(i * typename P::I32(3)), 3), 0);
}

/// Through the pixel of a match, in the upright axes of the view; 1 long along the optical axis.
template <class P>
Vec3<P> ray_of(const UprightInput<P>& input, typename P::I32 i) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const auto pixel = input.matches.pixels.subspan(I32(i * I32(2)), 2);
  const PinholeCamera& c = input.camera;
  const Vec3<P> ray{(F(pixel[0]) - F(c.cx)) * F(1 / c.fx), (F(pixel[1]) - F(c.cy)) * F(1 / c.fy),
                    1.0f};
  return transpose(input.R_camera_upright) * ray;
}

/// How far from its pixel a pose puts a point, and where the point is.
template <class P>
struct Reprojection {
  using F = typename P::F32;
  Vec3<P> x;  ///< in the camera frame, m
  F inverse_depth, du, dv;
};

template <class P>
Reprojection<P> reproject(const UprightInput<P>& input, const Vec3<P>& x, int i) {
  using F = typename P::F32;
  const PinholeCamera& c = input.camera;
  const F inverse = F(1.0f) / x.z;
  return {x, inverse, F(c.fx) * (x.x * inverse) + F(c.cx) - F(input.matches.pixels[2 * i]),
          F(c.fy) * (x.y * inverse) + F(c.cy) - F(input.matches.pixels[2 * i + 1])};
}

/// Better by inliers, then by the sum of their squared errors.
template <class P>
struct Score {
  typename P::I32 inliers = 0;
  typename P::F32 error = 0.0f;

  bool is_better_than(const Score& other) const {
    if (inliers > other.inliers) return true;
    return inliers == other.inliers && error < other.error;
  }
};

template <class P>
Score<P> score_of(const UprightInput<P>& input, const YawTransform<P>& T,
                  const UprightOptions& options) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const Pose<P> pose = upright_camera_pose<P>(input.R_camera_upright, T);
  Score<P> score;
  for (int i : P::range(0, input.matches.n)) {
    const Vec3<P> x = pose * load_vec3<P>(input.matches.points, 3 * i);
    if (!(x.z > F(options.min_depth))) continue;
    const Reprojection<P> r = reproject(input, x, i);
    const F squared = r.du * r.du + r.dv * r.dv;
    if (!(squared < F(options.inlier_px * options.inlier_px))) continue;
    score.inliers += I32(1);
    score.error += squared;
  }
  return score;
}

/// What the cores found, 4 floats of the pose and the score each.
template <class P>
struct Found {
  typename P::template Span<typename P::F32> poses;
  typename P::template Span<typename P::I32> inliers;
  typename P::template Span<typename P::F32> errors;
};

template <class P>
void store(const Found<P>& found, int core, const YawTransform<P>& T, const Score<P>& score) {
  store_vec3<P>(found.poses, kUnknowns * core, T.t);
  found.poses[kUnknowns * core + 3] = T.yaw;
  found.inliers[core] = score.inliers;
  found.errors[core] = score.error;
}

/// The rows of the normal equations' Jacobian in one coordinate of the pixel, its error, and the
/// weight of both.
template <class P>
void add_row(const typename P::F32 (&row)[kUnknowns], typename P::F32 error, typename P::F32 weight,
             MatrixView<P> H, typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  for (int r = 0; r < kUnknowns; ++r) {
    const F weighted = row[r] * weight;
    for (int c = 0; c <= r; ++c) H(r, c) += weighted * row[c];
    b[r] -= weighted * error;
  }
}

template <class P>
void add_match(const UprightInput<P>& input, const SinCos<P>& yaw, const YawTransform<P>& T,
               const UprightOptions& options, int i, MatrixView<P> H,
               typename P::template Span<typename P::F32> b) {
  using F = typename P::F32;
  const Vec3<P> lever = turned<P>(yaw, load_vec3<P>(input.matches.points, 3 * i));
  const Vec3<P> x = input.R_camera_upright * (lever + T.t);
  if (!(x.z > F(options.min_depth))) return;
  const Reprojection<P> r = reproject(input, x, i);
  const F error_sq = r.du * r.du + r.dv * r.dv;
  F weight = 1.0f;
  if (error_sq > F(options.huber_px * options.huber_px))
    weight = F(options.huber_px) / work::sqrt(error_sq);
  // d(u)/dx = fx/z (1, 0, −x/z) in the camera, turned into the upright axes.
  const Mat3<P>& R = input.R_camera_upright;
  const F inverse = r.inverse_depth;
  const PinholeCamera& c = input.camera;
  const Vec3<P> of_u = (R.row(0) - R.row(2) * (x.x * inverse)) * (F(c.fx) * inverse);
  const Vec3<P> of_v = (R.row(1) - R.row(2) * (x.y * inverse)) * (F(c.fy) * inverse);
  add_row<P>({of_u.y * lever.x - of_u.x * lever.y, of_u.x, of_u.y, of_u.z}, r.du, weight, H, b);
  add_row<P>({of_v.y * lever.x - of_v.x * lever.y, of_v.x, of_v.y, of_v.z}, r.dv, weight, H, b);
}

}  // namespace

template <class P>
Pose<P> upright_camera_pose(const Mat3<P>& R_camera_upright, const YawTransform<P>& T) {
  const SinCos<P> yaw = sincos_of<P>(T.yaw);
  Pose<P> pose;
  for (int r = 0; r < 3; ++r) {
    const Vec3<P> row = R_camera_upright.row(r);
    pose.R.m[r][0] = row.x * yaw.cos + row.y * yaw.sin;
    pose.R.m[r][1] = row.y * yaw.cos - row.x * yaw.sin;
    pose.R.m[r][2] = row.z;
  }
  pose.t = R_camera_upright * T.t;
  return pose;
}

/// The points lie λ1 and λ2 along their rays. Their difference in height is known, which leaves a
/// line of (λ1, λ2), and their distance is, which leaves two points of it.
template <class P>
PairSolution<P> solve_pair(const UprightInput<P>& input, typename P::I32 first,
                           typename P::I32 second) {
  using F = typename P::F32;
  constexpr float kLeast = 1e-8f;
  PairSolution<P> solution;
  const Vec3<P> p = point_of(input, first), q = point_of(input, second);
  const Vec3<P> r = ray_of(input, first), s = ray_of(input, second);
  const Vec3<P> apart = p - q;
  const F slope = r.z * r.z + s.z * s.z;
  if (!(slope > F(kLeast))) return solution;  // both at the horizon
  const F base = apart.z / slope;
  const Vec3<P> fixed = r * (base * r.z) + s * (base * s.z), along = r * s.z - s * r.z;
  const F a = dot(along, along), b = dot(along, fixed), c = dot(fixed, fixed) - dot(apart, apart);
  const F discriminant = b * b - a * c;
  if (!(a > F(kLeast)) || !(discriminant > F(0.0f))) return solution;
  const F root = work::sqrt(discriminant), inverse = F(1.0f) / a;
  for (const F numerator : {F(-b - root), F(-b + root)}) {
    const F step = numerator * inverse;
    const F of_first = base * r.z + step * s.z, of_second = step * r.z - base * s.z;
    if (!(of_first > F(0.0f)) || !(of_second > F(0.0f))) continue;
    const Vec3<P> x = r * of_first, y = s * of_second, seen = x - y;
    const F sine = apart.x * seen.y - apart.y * seen.x,
            cosine = apart.x * seen.x + apart.y * seen.y;
    if (!(sine * sine + cosine * cosine > F(kLeast))) continue;  // one above the other
    const F yaw = atan2_of<P>(sine, cosine);
    const Vec3<P> middle = turned<P>(sincos_of<P>(yaw), (p + q) * F(0.5f));
    solution.T[solution.count++] = {yaw, (x + y) * F(0.5f) - middle};
  }
  return solution;
}

template <class P>
UprightPose<P> find_upright_pose(work::Machine& machine, const UprightInput<P>& input,
                                 const UprightOptions& options, levio::ShiftRegister<P>& random) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  using U16 = typename P::U16;
  using Numbers = typename P::template Span<U16>;
  using Floats = typename P::template Span<F>;
  UprightPose<P> best;
  if (input.matches.n < 2) return best;
  work::Arena& local = machine.local();
  const work::Arena::Frame memory(local);
  const Numbers numbers = local.alloc<Numbers>("match numbers", input.matches.n);
  const Numbers pairs = local.alloc<Numbers>("pairs of matches", 2 * options.iterations);
  const Found<P> found{
      local.alloc<Floats>("poses by cores", kUnknowns * machine.cores()),
      local.alloc<typename P::template Span<I32>>("inliers by cores", machine.cores()),
      local.alloc<Floats>("errors by cores", machine.cores())};
  levio::number_consecutively<P>(numbers);
  for (int k : P::range(0, options.iterations))
    levio::draw_sample<P>(random, numbers, 2, pairs.subspan(2 * k, 2));
  machine.fork("solve pairs", [&](work::Core& core) {
    Score<P> most;
    YawTransform<P> of_most = YawTransform<P>::identity();
    const auto [first, last] = core.share(options.iterations);
    for (int k : P::range(first, last)) {
      const PairSolution<P> pair = solve_pair<P>(input, I32(pairs[2 * k]), I32(pairs[2 * k + 1]));
      for (int i : P::range(0, pair.count)) {
        const Score<P> score = score_of(input, pair.T[i], options);
        if (!score.is_better_than(most)) continue;
        most = score;
        of_most = pair.T[i];
      }
    }
    store(found, core.id, of_most, most);
  });
  Score<P> most;
  for (int id : P::range(0, machine.cores())) {
    const Score<P> score{I32(found.inliers[id]), F(found.errors[id])};
    if (!score.is_better_than(most)) continue;
    most = score;
    best.T = {F(found.poses[kUnknowns * id + 3]), load_vec3<P>(found.poses, kUnknowns * id)};
  }
  best.inliers = work::value(most.inliers);
  return best;
}

template <class P>
bool refine_upright_pose(work::Arena& local, const UprightInput<P>& input,
                         const UprightOptions& options, YawTransform<P>& T) {
  using F = typename P::F32;
  using Floats = typename P::template Span<F>;
  const work::Arena::Frame memory(local);
  const MatrixView<P> H = alloc_matrix<P>(local, "normal equations", kUnknowns, kUnknowns);
  const Floats b = local.alloc<Floats>("right-hand side", kUnknowns);
  for ([[maybe_unused]] int step : P::range(0, options.steps)) {
    for (int r = 0; r < kUnknowns; ++r) {
      for (int c = 0; c <= r; ++c) H(r, c) = 0.0f;
      b[r] = 0.0f;
    }
    const SinCos<P> yaw = sincos_of<P>(T.yaw);
    for (int i : P::range(0, input.matches.n)) add_match<P>(input, yaw, T, options, i, H, b);
    if (!cholesky_factor<P>(H)) return false;
    cholesky_solve<P>(H, b);
    T = {wrapped<P>(T.yaw + F(b[0])), T.t + load_vec3<P>(b, 1)};
  }
  return true;
}

template <class P>
int mark_inliers(const UprightInput<P>& input, const YawTransform<P>& T, float inlier_px,
                 float min_depth, typename P::template Span<typename P::Byte> inliers) {
  using F = typename P::F32;
  using I32 = typename P::I32;
  const Pose<P> pose = upright_camera_pose<P>(input.R_camera_upright, T);
  I32 number = 0;
  for (int i : P::range(0, input.matches.n)) {
    const Vec3<P> x = pose * load_vec3<P>(input.matches.points, 3 * i);
    bool agrees = false;
    if (x.z > F(min_depth)) {
      const Reprojection<P> r = reproject(input, x, i);
      agrees = bool(r.du * r.du + r.dv * r.dv < F(inlier_px * inlier_px));
    }
    inliers[i] = work::narrow<typename P::Byte>(I32(agrees ? 1 : 0));
    if (agrees) number += I32(1);
  }
  return work::value(number);
}

#define LEVIOSIM_INSTANTIATE(P)                                                                  \
  template Pose<P> upright_camera_pose(const Mat3<P>&, const YawTransform<P>&);                  \
  template PairSolution<P> solve_pair(const UprightInput<P>&, P::I32, P::I32);                   \
  template UprightPose<P> find_upright_pose(work::Machine&, const UprightInput<P>&,              \
                                            const UprightOptions&, levio::ShiftRegister<P>&);    \
  template bool refine_upright_pose(work::Arena&, const UprightInput<P>&, const UprightOptions&, \
                                    YawTransform<P>&);                                           \
  template int mark_inliers(const UprightInput<P>&, const YawTransform<P>&, float, float,        \
                            P::Span<P::Byte>);

LEVIOSIM_INSTANTIATE(work::Native)
LEVIOSIM_INSTANTIATE(work::Counting)
#undef LEVIOSIM_INSTANTIATE

}  // namespace leviosim::vio
