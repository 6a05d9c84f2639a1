// What the vision front end works on and hands over: images, and lists of features as structures of
// spans.
//
// Sizes (PARAMETERS.md#memory): a keypoint is 4 bytes (two u16 pixel coordinates), a descriptor
// 32 bytes (256 bits).
#pragma once

#include <type_traits>

#include "sim/work/arena.h"
#include "sim/work/policy.h"

namespace leviosim::vio {

/// 32-bit words of one 256-bit descriptor.
inline constexpr int kDescriptorWords = 8;
/// Bits of one word.
inline constexpr int kWordBits = 32;

/// width × height grey levels, row by row without padding: pixel (x, y) at
/// pixels[(y - top) * width + x]. Of an image that is in local memory in part, `top` is the first
/// row that is there, and width and height are those of the whole image.
template <class P, class Pixel = typename P::Byte>
struct ImageView {
  using Span = typename P::template Span<Pixel>;

  Span pixels;
  int width = 0;
  int height = 0;
  int top = 0;

  /// A read-only view of the same image.
  operator ImageView<P, const Pixel>() const requires(!std::is_const_v<Pixel>) {
    return {pixels, width, height, top};
  }
};

template <class P>
using ConstImageView = ImageView<P, const typename P::Byte>;

/// Up to `capacity` features, of which the first `count` are valid. Feature i lies at pixel
/// (x[i], y[i]) and has the descriptor words descriptors[8 i] … descriptors[8 i + 7], which lie in
/// local memory if they have room there.
template <class P>
struct FeatureList {
  typename P::template EitherSpan<typename P::U16> x, y;
  typename P::template Span<typename P::U32> descriptors;
  int count = 0;
  int capacity = 0;
  bool descriptors_in_l2 = false;  ///< then they are source and target of transfers only
};

/// Calls use(words) with the descriptors as a core of the cluster reaches them.
template <class P, class Use>
decltype(auto) with_descriptors(const FeatureList<P>& list, Use&& use) {
  using Word = typename P::U32;
  if (list.descriptors_in_l2)
    return use(
        typename P::template L2Span<const Word>(list.descriptors.data(), list.descriptors.size()));
  return use(typename P::template Span<const Word>(list.descriptors));
}

/// An empty list without descriptors: the block "keypoints" (4 bytes each).
template <class P>
FeatureList<P> alloc_keypoints(work::Arena& arena, int capacity) {
  using Coordinates = typename P::template Span<typename P::U16>;
  FeatureList<P> list;
  const Coordinates keypoints = arena.alloc<Coordinates>("keypoints", 2 * capacity);
  list.x = keypoints.subspan(0, capacity);
  list.y = keypoints.subspan(capacity, capacity);
  list.capacity = capacity;
  return list;
}

/// An empty list in `arena`: blocks "keypoints" and "descriptors" (32 bytes each).
template <class P>
FeatureList<P> alloc_features(work::Arena& arena, int capacity) {
  FeatureList<P> list = alloc_keypoints<P>(arena, capacity);
  list.descriptors = arena.alloc<typename P::template Span<typename P::U32>>(
      "descriptors", kDescriptorWords * capacity);
  return list;
}

}  // namespace leviosim::vio
