// The landmarks of a window for its alignment: each as a direction (x/z, y/z) and an inverse depth
// in the keyframe that saw it first. So even one that is far away is nearly linear in its unknowns.
#pragma once

#include "workload/graph/carried_poses.h"
#include "workload/graph/reduced_system.h"
#include "workload/graph/reprojection.h"

namespace leviosim::vio {

/// Velocity, gravity, biases of gyro and accelerometer, and the mean inverse depth of the
/// landmarks.
inline constexpr int kAlignmentUnknowns = 13;
/// Place of the mean.
inline constexpr int kMeanInverseDepth = 12;

template <class P>
class AnchoredLandmarks {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;
  using Span = typename P::template Span<F>;

  /// @param spread  of the inverse depths about their mean, a standard deviation, as a share of it
  /// @param mean    to begin with, 1/m
  AnchoredLandmarks(work::Arena& arena, const Window<P>& window, const PixelModel<P>& model, F mean,
                    float spread)
      : model_(model),
        mean_(mean),
        inverse_spread_(1.0f / spread),
        all_(arena.alloc<Span>("anchored landmarks", 3 * window.landmarks)),
        row_(arena.alloc<Span>("alignment row", kAlignmentUnknowns)),
        by_landmark_(arena.alloc<Span>("alignment by landmark", 3 * kAlignmentUnknowns)) {}

  /// Direction and inverse depth of each.
  Span all() const { return all_; }

  /// From the points of the window's state to anchored landmarks, and back; seen from the window's
  /// poses.
  void anchor(const Window<P>& window) const;
  void release(const Window<P>& window) const;
  /// All are at the mean, where the keyframes saw them first.
  void aim(const Window<P>& window) const;

  /// The mean about which the inverse depths are taken to lie, 1/m. It is an unknown: how far away
  /// the landmarks are is not known, only that their distances are alike. A landmark far from it
  /// says nothing of it (Geman and McClure), since wrong matches end anywhere.
  F mean() const { return mean_; }
  void set_mean(F mean) { mean_ = mean; }

  /// Moves each landmark one step to where it explains its observations best.
  /// @return the cost then
  F settle(const Window<P>& window, const CarriedPoses<P>& poses, Span landmarks) const;

  /// Adds the landmarks, eliminated, to a system of kAlignmentUnknowns.
  /// @return the cost
  F add(const Window<P>& window, const CarriedPoses<P>& poses,
        const ReducedSystem<P>& system) const;

  /// Marks those as lost that do not explain their observations, or whose distance is unknown.
  /// @return the numbers of those that explain them, and of those whose distance is known as well
  struct Verdict {
    int explained, observable;
  };
  Verdict judge(const Window<P>& window, const CarriedPoses<P>& poses) const;

 private:
  /// Normal equations of one landmark.
  struct Normal {
    Mat3<P> H = Mat3<P>::zero();
    Vec3<P> b{0.0f, 0.0f, 0.0f};
    F cost = 0.0f;
    F worst_sq = 0.0f;  ///< largest squared error, px²
  };
  /// An observation, linearised.
  struct Term {
    F residual[2];
    Vec3<P> by_point[2];  ///< in the observing camera's frame, at the anchor's depth
    Vec3<P> by_landmark[2];
    Vec3<P> point;  ///< in that frame
    Mat3<P> R_camera_anchor;
  };

  bool linearise(const CarriedPose<P>& anchor, const CarriedPose<P>& camera,
                 const Vec3<P>& landmark, const Vec2<P>& observed, Term& term,
                 Normal& normal) const;
  Normal normal_of(const Window<P>& window, const CarriedPoses<P>& poses, int i,
                   const Vec3<P>& landmark) const;
  void add_observation(const CarriedPose<P>& anchor, const CarriedPose<P>& camera,
                       const Vec3<P>& landmark, const Term& term,
                       const ReducedSystem<P>& system) const;
  void retry(const Window<P>& window, const CarriedPoses<P>& poses, int i, Vec3<P>& landmark,
             Normal& normal) const;
  /// What the mean says of a landmark, and it of the mean.
  struct Prior {
    F residual;     ///< standard deviations
    F by_landmark;  ///< derivatives of it
    F by_mean;
    F weight;
    F cost;
  };
  Prior prior_of(const Vec3<P>& landmark) const;
  static void add_prior(const Prior& prior, Normal& normal);
  void add_mean(const Prior& prior, const ReducedSystem<P>& system) const;
  void eliminate(const Normal& normal, const ReducedSystem<P>& system) const;

  PixelModel<P> model_;
  F mean_;
  F inverse_spread_;
  Span all_;
  Span row_;
  Span by_landmark_;
};

}  // namespace leviosim::vio
