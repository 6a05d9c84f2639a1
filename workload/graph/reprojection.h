// The visual term of the optimiser: where a landmark appears in a keyframe, against where it was
// seen.
//
// Residual: projected minus observed pixel, divided by σ, with Huber weighting: from `huber_px` on,
// the cost grows linearly with the distance (iteratively reweighted least squares: residual and
// derivatives are scaled by the root of the weight; its own derivative is left out).
//
// An observation is lost if its point lies behind the camera or nearer than min_depth, or if it is
// more than `lost_px` off. It takes part in no derivative, and its cost is constant: that of
// lost_px. So a step cannot lower the cost by pushing landmarks out of sight, and one landmark next
// to a camera, where nothing is linear, cannot have the steps of all others rejected.
#pragma once

#include "workload/math/vec.h"

namespace leviosim::vio {

/// For EuRoC's images of 160x120 (PARAMETERS.md#input); the odometry fits them to its images.
struct ReprojectionOptions {
  static constexpr float kImageWidth = 160;

  PinholeCamera camera{114.66f, 114.32f, 77.80f, 62.09f};
  float sigma_px = 1.0f;
  float huber_px = 1.0f;
  float lost_px = 40.0f;    ///< a quarter of the image width
  float min_depth = 0.05f;  ///< m
};

/// The options as values of the policy.
template <class P>
struct PixelModel {
  using F = typename P::F32;

  explicit PixelModel(const ReprojectionOptions& options)
      : fx(options.camera.fx),
        fy(options.camera.fy),
        cx(options.camera.cx),
        cy(options.camera.cy),
        information(1.0f / (options.sigma_px * options.sigma_px)),
        inverse_sigma(1.0f / options.sigma_px),
        huber(options.huber_px),
        huber_sq(options.huber_px * options.huber_px),
        lost_sq(options.lost_px * options.lost_px),
        lost_cost(information * huber * (F(options.lost_px) - F(0.5f) * huber)),
        min_depth(options.min_depth) {}

  F fx, fy, cx, cy;
  F information, inverse_sigma;
  F huber, huber_sq;
  F lost_sq, lost_cost;
  F min_depth;
};

/// Where a point appears.
template <class P>
struct Projection {
  Vec3<P> in_camera;  ///< m
  typename P::F32 inverse_depth;
  Vec2<P> normalised;        ///< image coordinates at depth 1
  Vec2<P> error;             ///< projected minus observed, px
  typename P::F32 error_sq;  ///< px²
};

/// @param in_camera  the point in the camera frame
/// @return false if the observation is lost; `at` is then not to be used
template <class P>
bool project(const PixelModel<P>& model, const Vec3<P>& in_camera, const Vec2<P>& observed,
             Projection<P>& at) {
  using F = typename P::F32;
  if (in_camera.z < model.min_depth) return false;
  const F inverse_depth = F(1.0f) / in_camera.z;
  const F x = in_camera.x * inverse_depth;
  const F y = in_camera.y * inverse_depth;
  const F u = model.fx * x + model.cx - observed.x;
  const F v = model.fy * y + model.cy - observed.y;
  at = {in_camera, inverse_depth, {x, y}, {u, v}, u * u + v * v};
  if (at.error_sq > model.lost_sq) return false;
  return true;
}

/// Half the squared error in units of σ, linear beyond huber_px.
template <class P>
typename P::F32 huber_cost(const PixelModel<P>& model, typename P::F32 error_sq) {
  using F = typename P::F32;
  const F half = 0.5f;
  if (error_sq > model.huber_sq)
    return model.information * model.huber * (work::sqrt(error_sq) - half * model.huber);
  return model.information * (half * error_sq);
}

/// Root of the weight of an observation: 1/σ, less for outliers.
template <class P>
typename P::F32 root_weight(const PixelModel<P>& model, typename P::F32 error_sq) {
  using F = typename P::F32;
  F root = model.inverse_sigma;
  if (error_sq > model.huber_sq) root *= work::sqrt(F(model.huber / work::sqrt(error_sq)));
  return root;
}

/// Weighted residual and its derivatives, two rows each.
template <class P>
struct VisualTerm {
  typename P::F32 residual[2];
  Vec3<P> by_rotation[2];  ///< right perturbation of R_world_camera
  Vec3<P> by_point[2];     ///< the landmark; by the camera's position it is the negative
};

/// @param R  R_world_camera
template <class P>
VisualTerm<P> linearise(const PixelModel<P>& model, const Mat3<P>& R, const Projection<P>& at) {
  using F = typename P::F32;
  const F weight = root_weight<P>(model, at.error_sq);
  const F scale = weight * at.inverse_depth;
  // Rows of the derivative by the point in the camera frame: (a, 0, c) and (0, b, d).
  const F a = model.fx * scale;
  const F b = model.fy * scale;
  const F c = -(a * at.normalised.x);
  const F d = -(b * at.normalised.y);
  const Vec3<P>& x = at.in_camera;
  VisualTerm<P> term;
  term.residual[0] = at.error.x * weight;
  term.residual[1] = at.error.y * weight;
  // A rotation φ moves the point in the camera frame by x × φ.
  term.by_rotation[0] = {-(c * x.y), c * x.x - a * x.z, a * x.y};
  term.by_rotation[1] = {b * x.z - d * x.y, d * x.x, -(b * x.x)};
  term.by_point[0] = {a * R.m[0][0] + c * R.m[0][2], a * R.m[1][0] + c * R.m[1][2],
                      a * R.m[2][0] + c * R.m[2][2]};
  term.by_point[1] = {b * R.m[0][1] + d * R.m[0][2], b * R.m[1][1] + d * R.m[1][2],
                      b * R.m[2][1] + d * R.m[2][2]};
  return term;
}

}  // namespace leviosim::vio
