// What a front end keeps between frames, and where it works: the parts of both front ends take it
// and change it. Its data persist in L2; L1 is a scratchpad that is empty between frames.
#pragma once

#include <array>
#include <cstdint>

#include "sim/work/machine.h"
#include "workload/graph/pose_graph.h"
#include "workload/inertial/initialisation.h"
#include "workload/inertial/preintegration.h"
#include "workload/math/vec.h"
#include "workload/vio/profile.h"
#include "workload/vio/records.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

// The camera for coordinates of features, which are whole numbers of 1/subpixel_steps px. Its
// inverse is a 3×3 constant of the program, which lies in L2 and is multiplied as a whole; the
// cluster reads its nine elements from there each time (PARAMETERS.md#memory). A controller has it
// in its own memory.

template <class P>
class FeatureCamera {
 public:
  using F = typename P::F32;
  using I32 = typename P::I32;

  /// @param camera  in px
  /// @param steps   per px
  FeatureCamera(const PinholeCamera& camera, int steps) : steps_(steps) {
    const auto per_px = static_cast<float>(steps);
    const PinholeCamera c{per_px * camera.fx, per_px * camera.fy, per_px * camera.cx,
                          per_px * camera.cy};
    const float inverse[] = {1.0f / c.fx,  0.0f, -c.cx / c.fx, 0.0f, 1.0f / c.fy,
                             -c.cy / c.fy, 0.0f, 0.0f,         1.0f};
    for (std::size_t i = 0; i < inverse_.size(); ++i) inverse_[i] = F(inverse[i]);
  }

  /// Image coordinates at depth 1.
  Vec2<P> normalised(I32 u, I32 v) const {
    const typename P::template L2Span<const F> k(inverse_.data(), 9);
    const Vec3<P> x{work::to_f32(u), work::to_f32(v), 1.0f};
    const Vec3<P> ray{F(k[0]) * x.x + F(k[1]) * x.y + F(k[2]) * x.z,
                      F(k[3]) * x.x + F(k[4]) * x.y + F(k[5]) * x.z,
                      F(k[6]) * x.x + F(k[7]) * x.y + F(k[8]) * x.z};
    return {ray.x, ray.y};
  }

  /// One coordinate in px.
  F pixel(I32 coordinate) const {
    if (steps_ == 1) return work::to_f32(coordinate);
    return work::to_f32(coordinate) * F(1.0f / static_cast<float>(steps_));
  }

 private:
  std::array<F, 9> inverse_;
  int steps_;
};

// The last keyframe as it lies in L2 between frames (PARAMETERS.md#memory): its features, the
// landmark that each of them shows, the motion since then as the IMU saw it, and the buffer that
// the camera writes the next image to.

/// Landmark slot of a feature that shows none.
inline constexpr int kNoLandmark = 0xffff;

/// Features with the landmark slot of each, or kNoLandmark: 38 bytes per feature.
template <class P>
struct ObservedFeatures {
  FeatureList<P> list;
  typename P::template Span<typename P::U16> landmarks;
};

/// What features and their landmarks take, with their descriptors or without.
template <class P>
Bytes observed_features_size(int capacity, bool descriptors) {
  using Half = typename P::U16;
  const std::size_t each =
      3 * sizeof(Half) + (descriptors ? kDescriptorWords * sizeof(typename P::U32) : 0);
  return Bytes(static_cast<std::int64_t>(each) * capacity);
}

/// What lies in L2 since local memory has no room for it. It depends on sizes only, so that it is
/// the same in every frame.
struct Residence {
  bool image = true;        ///< the whole image and its blurred copy have room; else strips of them
  bool descriptors = true;  ///< those of two frames have room; else those of none stay
};

template <class P>
struct KeyframeRecord {
  using F = typename P::F32;

  /// @param residence    what is missing in local memory lies here
  /// @param keeps_image  whether the keyframe's image stays
  KeyframeRecord(work::Arena& arena, int capacity, int width, int height,
                 const Residence& residence, bool keeps_image, const StillnessOptions& standstill)
      : features{alloc_features<P>(arena, capacity),
                 arena.alloc<typename P::template Span<typename P::U16>>("landmarks of features",
                                                                         capacity)},
        interval(
            arena.alloc<typename P::template Span<F>>("IMU interval", Preintegration<P>::kFloats)),
        last_sample(arena.alloc<typename P::template Span<F>>("last IMU sample", kImuSampleFloats)),
        stillness(arena.alloc<typename P::template Span<F>>(
            "IMU sums of the last second", StillnessDetector<P>::floats(standstill))),
        image{arena.alloc<typename P::template Span<typename P::Byte>>("camera image",
                                                                       width * height),
              width, height} {
    if (keeps_image)
      seen = {arena.alloc<typename P::template Span<typename P::Byte>>("image of the keyframe",
                                                                       width * height),
              width, height};
    if (!residence.image) {
      using Pixels = typename P::template Span<typename P::Byte>;
      blurred = {arena.alloc<Pixels>("blurred image", width * height), width, height};
    }
    if (!residence.descriptors)
      fresh = arena.alloc<typename P::template Span<typename P::U32>>(
          "descriptors of the frame", kDescriptorWords * capacity);
  }

  ObservedFeatures<P> features;
  typename P::template Span<F> interval;     ///< pre-integrated motion since the keyframe
  typename P::template Span<F> last_sample;  ///< where the next step of it begins
  typename P::template Span<F> stillness;    ///< of the StillnessDetector
  ImageView<P> image;
  ImageView<P> seen;     ///< that of the keyframe; empty where patches are not aligned
  ImageView<P> blurred;  ///< only where features are extracted from strips
  /// Descriptors of the present frame, only where they do not stay in local memory.
  typename P::template Span<typename P::U32> fresh;
};

template <class P>
struct FrontEndState {
  /// @param cluster          where the front end runs; its memory is L1
  /// @param keyframe_memory  in L2, for the last keyframe
  /// @param in_l2            the graph, shared with the back end
  FrontEndState(const Profile& parameters, const Rig& camera_rig, work::Machine& cluster,
                work::Arena& keyframe_memory, const PoseGraph<P>& in_l2);

  KeyframeState<P> newest_keyframe() const {
    return graph_in_l2.keyframe(graph_in_l2.newest_keyframe());
  }

  const Profile& profile;
  Rig rig;
  work::Machine& machine;
  FeatureCamera<P> camera;
  Residence residence;
  KeyframeRecord<P> keyframe;
  PoseGraph<P> graph;                       ///< in L2, as the source and target of transfers
  PoseGraph<P, L2FromCluster> graph_in_l2;  ///< the graph as a cluster core reaches it
  bool started = false;                     ///< there is a map
  std::uint32_t frame_number = 0;           ///< of the present frame, from 1 on
  float time_since_keyframe = 0;            ///< [s]
};

/// Room for the features of the frame, in local memory; their descriptors may lie in L2.
template <class P>
ObservedFeatures<P> alloc_frame_features(const FrontEndState<P>& state);

// A front end as the odometry sees it: one frame, from pixels and IMU samples to a pose, on the
// cluster (paper Fig. 1, right side). The two that there are have rooms of their own: levio/ is the
// paper's, next/ ours.

template <class P>
class FrontEnd {
 public:
  FrontEnd() = default;
  FrontEnd(const FrontEnd&) = delete;  // its parts refer to each other
  FrontEnd& operator=(const FrontEnd&) = delete;
  virtual ~FrontEnd() = default;

  virtual FrameReport process(const FrameInput& input) = 0;
};

}  // namespace leviosim::vio
