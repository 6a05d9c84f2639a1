// The last keyframe as it lies in L2 between frames (PARAMETERS.md#memory): its features, the
// landmark that each of them shows, the motion since then as the IMU saw it, and the buffer that
// the camera writes the next image to.
#pragma once

#include <cstdint>

#include "sim/work/machine.h"
#include "workload/inertial/initialisation.h"
#include "workload/inertial/preintegration.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

/// Landmark slot of a feature that shows none.
inline constexpr int kNoLandmark = 0xffff;

/// Features with the landmark slot of each, or kNoLandmark: 38 bytes per feature.
template <class P>
struct ObservedFeatures {
  FeatureList<P> list;
  typename P::template EitherSpan<typename P::U16> landmarks;
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
  bool whole_lists = true;  ///< lists of matches have room for all features that an image can have;
                            ///< else for those that it has, or not even for those
};

template <class P>
struct KeyframeRecord {
  using F = typename P::F32;

  /// @param residence    what is missing in local memory lies here
  /// @param keeps_image  whether the keyframe's image stays
  KeyframeRecord(work::Arena& arena, int capacity, int width, int height,
                 const Residence& residence, bool keeps_image, const StillnessOptions& standstill)
      : features(alloc_observed(arena, capacity)),
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
    if (!residence.whole_lists)
      fresh = alloc_observed(arena, capacity);
    else if (!residence.descriptors)
      fresh.list.descriptors = arena.alloc<typename P::template Span<typename P::U32>>(
          "descriptors of the frame", kDescriptorWords * capacity);
  }

  /// The first `n` features of `from` take the place of the keyframe's. What lies in L2 already
  /// stays where it is.
  void store(work::Machine& machine, const ObservedFeatures<P>& from, int n) {
    if (fresh.list.x.size() > 0)
      std::swap(features, fresh);
    else if (from.list.descriptors_in_l2)
      std::swap(features.list.descriptors, fresh.list.descriptors);
    FeatureList<P>& to = features.list;
    const bool listed = from.list.x.data() == to.x.data();
    if (!listed) {
      machine.copy_out(to.x, from.list.x.subspan(0, n));
      machine.copy_out(to.y, from.list.y.subspan(0, n));
    }
    if (!from.list.descriptors_in_l2)
      machine.copy_out(to.descriptors, from.list.descriptors.subspan(0, kDescriptorWords * n));
    if (!listed) machine.copy_out(features.landmarks, from.landmarks.subspan(0, n));
    to.count = from.list.count;
  }

  /// In L2.
  static ObservedFeatures<P> alloc_observed(work::Arena& arena, int capacity) {
    ObservedFeatures<P> features{
        alloc_features<P>(arena, capacity),
        arena.alloc<typename P::template Span<typename P::U16>>("landmarks of features", capacity)};
    features.list.x = features.list.x.in_l2();
    features.list.y = features.list.y.in_l2();
    features.landmarks = features.landmarks.in_l2();
    return features;
  }

  ObservedFeatures<P> features;
  typename P::template Span<F> interval;     ///< pre-integrated motion since the keyframe
  typename P::template Span<F> last_sample;  ///< where the next step of it begins
  typename P::template Span<F> stillness;    ///< of the StillnessDetector
  ImageView<P> image;
  ImageView<P> seen;     ///< that of the keyframe; empty where patches are not aligned
  ImageView<P> blurred;  ///< only where features are extracted from strips
  /// Of the present frame, what does not stay in local memory: descriptors, or all.
  ObservedFeatures<P> fresh;
};

}  // namespace leviosim::vio
