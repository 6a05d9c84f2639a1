// The last keyframe as it lies in L2 between frames (PARAMETERS.md#memory): its features, the
// landmark that each of them shows, the motion since then as the IMU saw it, and the buffer that
// the camera writes the next image to.
#pragma once

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
  typename P::template Span<typename P::U16> landmarks;
};

template <class P>
ObservedFeatures<P> alloc_observed_features(work::Arena& arena, int capacity) {
  ObservedFeatures<P> features;
  features.list = alloc_features<P>(arena, capacity);
  features.landmarks =
      arena.alloc<typename P::template Span<typename P::U16>>("landmarks of features", capacity);
  return features;
}

/// What alloc_observed_features() takes.
template <class P>
Bytes observed_features_size(int capacity) {
  using Half = typename P::U16;
  constexpr std::size_t kEach = 3 * sizeof(Half) + kDescriptorWords * sizeof(typename P::U32);
  return Bytes(static_cast<std::int64_t>(kEach) * capacity);
}

template <class P>
struct KeyframeRecord {
  using F = typename P::F32;

  /// @param strips       whether features are extracted from strips of the image, which takes a
  ///                     blurred copy in L2
  /// @param keeps_image  whether the keyframe's image stays
  KeyframeRecord(work::Arena& arena, int capacity, int width, int height, bool strips,
                 bool keeps_image, const StillnessOptions& standstill)
      : features(alloc_observed_features<P>(arena, capacity)),
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
    if (strips) {
      using Pixels = typename P::template Span<typename P::Byte>;
      blurred = {arena.alloc<Pixels>("blurred image", width * height), width, height};
    }
  }

  ObservedFeatures<P> features;
  typename P::template Span<F> interval;     ///< pre-integrated motion since the keyframe
  typename P::template Span<F> last_sample;  ///< where the next step of it begins
  typename P::template Span<F> stillness;    ///< of the StillnessDetector
  ImageView<P> image;
  ImageView<P> seen;     ///< that of the keyframe; empty where patches are not aligned
  ImageView<P> blurred;  ///< only where features are extracted from strips
};

}  // namespace leviosim::vio
