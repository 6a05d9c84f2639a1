#include "workload/graph/anchored_landmarks.h"

#include "workload/graph/linearisation.h"

namespace leviosim::vio {
namespace {

/// 1/m: beyond 100 m, and nearer than 10 cm, no landmark is looked for.
constexpr float kLeastInverseDepth = 0.001f, kMostInverseDepth = 10.0f;

template <class P>
Vec3<P> within_limits(Vec3<P> landmark) {
  using F = typename P::F32;
  landmark.z = work::min(F(work::max(landmark.z, F(kLeastInverseDepth))), F(kMostInverseDepth));
  return landmark;
}

}  // namespace

template <class P>
void AnchoredLandmarks<P>::anchor(const Window<P>& window) const {
  const typename P::Function function("anchor_landmarks");
  for (int i : P::range(0, window.landmarks)) {
    const int first = work::value(I32(window.first_observations[i]));
    // uncounted: where a landmark's observations begin
    const Pose<P> T = pose_of<P>(window.state, window.observation_keyframes[first]);
    const Vec3<P> seen = transpose(T.R) * (load_vec3<P>(window.state.points, 3 * i) - T.t);
    const F inverse_depth = F(1.0f) / work::max(seen.z, F(1e-3f));
    store_vec3<P>(
        all_, 3 * i,
        within_limits<P>({seen.x * inverse_depth, seen.y * inverse_depth, inverse_depth}));
  }
}

template <class P>
void AnchoredLandmarks<P>::aim(const Window<P>& window) const {
  const typename P::Function function("aim_landmarks");
  const F by_fx = F(1.0f) / model_.fx, by_fy = F(1.0f) / model_.fy;
  for (int i : P::range(0, window.landmarks)) {
    const Vec2<P> seen = observed_pixel<P>(window, work::value(I32(window.first_observations[i])));
    store_vec3<P>(all_, 3 * i, {(seen.x - model_.cx) * by_fx, (seen.y - model_.cy) * by_fy, mean_});
  }
}

/// The spread is a share of the mean, so that the scale of the whole costs nothing.
template <class P>
typename AnchoredLandmarks<P>::Prior AnchoredLandmarks<P>::prior_of(const Vec3<P>& landmark) const {
  constexpr float kFar = 3;  // standard deviations, from which on a landmark says little
  const F by_landmark = inverse_spread_ / mean_;
  const F residual = landmark.z * by_landmark - inverse_spread_;
  const F square = residual * residual;
  const F root = F(1.0f) / (F(1.0f) + square * F(1.0f / (kFar * kFar)));
  return {residual, by_landmark, -(landmark.z * by_landmark / mean_), root * root,
          F(0.5f) * square * root};
}

/// To the normal equations of one landmark.
template <class P>
void AnchoredLandmarks<P>::add_prior(const Prior& prior, Normal& normal) {
  const F weighted = prior.weight * prior.by_landmark;
  normal.H.m[2][2] += weighted * prior.by_landmark;
  normal.b.z -= weighted * prior.residual;
  normal.cost += prior.cost;
}

template <class P>
void AnchoredLandmarks<P>::add_mean(const Prior& prior, const ReducedSystem<P>& system) const {
  const F weighted = prior.weight * prior.by_mean;
  system.matrix()(kMeanInverseDepth, kMeanInverseDepth) += weighted * prior.by_mean;
  system.vector()[kMeanInverseDepth] -= weighted * prior.residual;
  by_landmark_[3 * kMeanInverseDepth + 2] += weighted * prior.by_landmark;
}

template <class P>
void AnchoredLandmarks<P>::release(const Window<P>& window) const {
  const typename P::Function function("release_landmarks");
  for (int i : P::range(0, window.landmarks)) {
    const int first = work::value(I32(window.first_observations[i]));
    // uncounted: where a landmark's observations begin
    const Pose<P> T = pose_of<P>(window.state, window.observation_keyframes[first]);
    const Vec3<P> landmark = load_vec3<P>(all_, 3 * i);
    const F depth = F(1.0f) / landmark.z;
    store_vec3<P>(window.state.points, 3 * i,
                  T * Vec3<P>{landmark.x * depth, landmark.y * depth, depth});
  }
}

/// @return false if the observation is lost
template <class P>
bool AnchoredLandmarks<P>::linearise(const CarriedPose<P>& anchor, const CarriedPose<P>& camera,
                                     const Vec3<P>& landmark, const Vec2<P>& observed, Term& term,
                                     Normal& normal) const {
  const typename P::Code code("linearise_anchored");
  const Mat3<P> R_camera_first = transpose(camera.R);
  term.R_camera_anchor = R_camera_first * anchor.R;
  const Vec3<P> moved = R_camera_first * (anchor.p - camera.p);
  term.point = term.R_camera_anchor * Vec3<P>{landmark.x, landmark.y, F(1.0f)} + moved * landmark.z;
  Projection<P> at;
  if (!project<P>(model_, term.point, observed, at)) {
    normal.cost += model_.lost_cost;
    normal.worst_sq = model_.lost_sq;
    return false;
  }
  normal.cost += huber_cost<P>(model_, at.error_sq);
  normal.worst_sq = work::max(normal.worst_sq, at.error_sq);
  const F weight = root_weight<P>(model_, at.error_sq);
  const F scale = weight * at.inverse_depth;
  const F a = model_.fx * scale, b = model_.fy * scale;
  term.residual[0] = at.error.x * weight;
  term.residual[1] = at.error.y * weight;
  term.by_point[0] = {a, F(0.0f), -(a * at.normalised.x)};
  term.by_point[1] = {F(0.0f), b, -(b * at.normalised.y)};
  for (int r = 0; r < 2; ++r) {
    const Vec3<P>& g = term.by_point[r];
    const Vec3<P> d{dot(g, term.R_camera_anchor.column(0)), dot(g, term.R_camera_anchor.column(1)),
                    dot(g, moved)};
    term.by_landmark[r] = d;
    const F of[3] = {d.x, d.y, d.z};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) normal.H.m[i][j] += of[i] * of[j];
    normal.b = normal.b - d * term.residual[r];
  }
  return true;
}

template <class P>
typename AnchoredLandmarks<P>::Normal AnchoredLandmarks<P>::normal_of(
    const Window<P>& window, const CarriedPoses<P>& poses, int i, const Vec3<P>& landmark) const {
  const int first = work::value(I32(window.first_observations[i]));
  const int number = work::value(I32(window.observation_numbers[i]));
  // uncounted: where a landmark's observations begin
  const CarriedPose<P> anchor = poses[window.observation_keyframes[first]];
  Normal normal;
  Term term;
  for (int o : P::range(first, first + number))
    linearise(anchor, poses[window.observation_keyframes[o]], landmark,
              observed_pixel<P>(window, o), term, normal);
  add_prior(prior_of(landmark), normal);
  return normal;
}

/// A lost observation says nothing of where its landmark is. So the landmark is looked for at the
/// mean, and far away, where nothing but rotation shows.
template <class P>
void AnchoredLandmarks<P>::retry(const Window<P>& window, const CarriedPoses<P>& poses, int i,
                                 Vec3<P>& landmark, Normal& normal) const {
  for (const float share : {1.0f, 0.1f}) {
    Vec3<P> other = landmark;
    other.z = mean_ * F(share);
    other = within_limits<P>(other);
    const Normal there = normal_of(window, poses, i, other);
    if (!(there.cost < normal.cost)) continue;
    landmark = other;
    normal = there;
  }
}

template <class P>
typename P::F32 AnchoredLandmarks<P>::settle(const Window<P>& window, const CarriedPoses<P>& poses,
                                             Span landmarks) const {
  const typename P::Function function("settle_landmarks");
  F cost = 0.0f;
  for (int i : P::range(0, window.landmarks)) {
    Vec3<P> before = load_vec3<P>(landmarks, 3 * i);
    Normal normal = normal_of(window, poses, i, before);
    if (normal.worst_sq >= model_.lost_sq) retry(window, poses, i, before, normal);
    store_vec3<P>(landmarks, 3 * i, before);
    F best = normal.cost;
    Mat3<P> inverse;
    if (invert_spd3<P>(normal.H, inverse)) {
      const Vec3<P> after = within_limits<P>(before + inverse * normal.b);
      const F settled = normal_of(window, poses, i, after).cost;
      if (settled < best) {
        best = settled;
        store_vec3<P>(landmarks, 3 * i, after);
      }
    }
    cost += best;
  }
  return cost;
}

/// The derivatives by all unknowns but the mean; those by the landmark are in the term.
template <class P>
void AnchoredLandmarks<P>::add_observation(const CarriedPose<P>& anchor,
                                           const CarriedPose<P>& camera, const Vec3<P>& landmark,
                                           const Term& term, const ReducedSystem<P>& system) const {
  const typename P::Code code("add_anchored");
  const F dt = anchor.time - camera.time;
  const F falling = F(0.5f) * dt * (anchor.time + camera.time);
  const Mat3<P> by_gyro = add_scaled<P>(anchor.p_by_gyro, F(-1.0f), camera.p_by_gyro);
  const Mat3<P> by_accel = add_scaled<P>(anchor.p_by_accel, F(-1.0f), camera.p_by_accel);
  const Vec3<P> direction{landmark.x, landmark.y, F(1.0f)};
  const MatrixView<P> H = system.matrix();
  for (int r : P::range(0, 2)) {
    const Vec3<P>& g = term.by_point[r];
    const Vec3<P> by_position = camera.R * g * landmark.z;
    const Vec3<P> in_anchor = transpose(term.R_camera_anchor) * g;
    store_vec3<P>(row_, 0, by_position * dt);
    store_vec3<P>(row_, 3, by_position * falling);
    store_vec3<P>(row_, 6,
                  transpose(by_gyro) * by_position -
                      transpose(anchor.R_by_gyro) * cross(in_anchor, direction) +
                      transpose(camera.R_by_gyro) * cross(g, term.point));
    store_vec3<P>(row_, 9, transpose(by_accel) * by_position);
    const F residual = term.residual[r];
    const Vec3<P>& d = term.by_landmark[r];
    for (int i : P::range(0, kMeanInverseDepth)) {
      const F of = row_[i];
      for (int j : P::range(0, i + 1)) H(i, j) += of * F(row_[j]);
      system.vector()[i] -= of * residual;
      by_landmark_[3 * i] += of * d.x;
      by_landmark_[3 * i + 1] += of * d.y;
      by_landmark_[3 * i + 2] += of * d.z;
    }
  }
}

template <class P>
void AnchoredLandmarks<P>::eliminate(const Normal& normal, const ReducedSystem<P>& system) const {
  Mat3<P> inverse;
  if (!invert_spd3<P>(normal.H, inverse)) return;
  for (int i : P::range(0, kAlignmentUnknowns)) {
    const Vec3<P> w = inverse * load_vec3<P>(by_landmark_, 3 * i);
    for (int j : P::range(0, i + 1))
      system.matrix()(i, j) -= F(dot(w, load_vec3<P>(by_landmark_, 3 * j)));
    system.vector()[i] -= F(dot(w, normal.b));
  }
}

template <class P>
typename P::F32 AnchoredLandmarks<P>::add(const Window<P>& window, const CarriedPoses<P>& poses,
                                          const ReducedSystem<P>& system) const {
  const typename P::Function function("add_anchored_landmarks");
  F cost = 0.0f;
  for (int i : P::range(0, window.landmarks)) {
    const int first = work::value(I32(window.first_observations[i]));
    const int number = work::value(I32(window.observation_numbers[i]));
    const Vec3<P> landmark = load_vec3<P>(all_, 3 * i);
    // uncounted: where a landmark's observations begin
    const CarriedPose<P> anchor = poses[window.observation_keyframes[first]];
    for (int e : P::range(0, 3 * kAlignmentUnknowns)) by_landmark_[e] = 0.0f;
    Normal normal;
    Term term;
    for (int o : P::range(first, first + number)) {
      const CarriedPose<P> camera = poses[window.observation_keyframes[o]];
      if (linearise(anchor, camera, landmark, observed_pixel<P>(window, o), term, normal))
        add_observation(anchor, camera, landmark, term, system);
    }
    const Prior prior = prior_of(landmark);
    add_prior(prior, normal);
    add_mean(prior, system);
    cost += normal.cost;
    eliminate(normal, system);
  }
  return cost;
}

template <class P>
typename AnchoredLandmarks<P>::Verdict AnchoredLandmarks<P>::judge(
    const Window<P>& window, const CarriedPoses<P>& poses) const {
  const typename P::Function function("judge_landmarks");
  constexpr float kErrors = 3;    // standard deviations of an observation that is explained
  constexpr float kDistance = 2;  // standard deviations of an inverse depth that is known
  const F limit = F(kErrors * kErrors) / model_.information * F(2.0f);
  Verdict verdict{0, 0};
  for (int i : P::range(0, window.landmarks)) {
    const Vec3<P> landmark = load_vec3<P>(all_, 3 * i);
    const Normal normal = normal_of(window, poses, i, landmark);
    Mat3<P> inverse;
    const bool observable = invert_spd3<P>(normal.H, inverse) &&
                            landmark.z * landmark.z > F(kDistance * kDistance) * inverse.m[2][2];
    const bool explained = bool(normal.worst_sq < limit);
    const bool lost = !observable || !explained;
    window.lost[i] = work::narrow<typename P::Byte>(I32(lost ? 1 : 0));
    if (explained) ++verdict.explained;
    if (!lost) ++verdict.observable;
  }
  return verdict;
}

template class AnchoredLandmarks<work::Native>;
template class AnchoredLandmarks<work::Counting>;

}  // namespace leviosim::vio
