// How far apart in code a core fetches the same instructions: what decides whether an instruction
// cache still holds them, whatever its size. A *reuse distance* is the number of distinct bytes of
// code that a core walked through since it was last in a piece of code, that piece included
// (Mattson's stack distance, in bytes). Work carries a histogram of it, so that a recorded work
// segment can be timed for any cache, and two work segments can be added.
//
// The histogram has a class at each of some distances. What is fetched at a distance between two of
// them is divided between both, so that its mean distance is kept: code that grows by a few per
// cent moves a few per cent of its bytes, and no cache sees a step.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace leviosim::work {

/// Distances of the classes in bytes: quarters of an octave from 256 B to 64 KiB, above and below
/// which no instruction cache of such chips lies. One more class follows: farther, or never before.
inline constexpr std::array<std::uint32_t, 33> kReuseDistances = {
    256,   304,   362,   431,   512,   609,   724,   861,   1024,  1218,  1448,
    1722,  2048,  2435,  2896,  3444,  4096,  4871,  5793,  6889,  8192,  9742,
    11585, 13777, 16384, 19484, 23170, 27554, 32768, 38968, 46341, 55109, 65536};
inline constexpr std::size_t kReuseClasses = kReuseDistances.size() + 1;
inline constexpr std::size_t kNeverFetched = kReuseClasses - 1;
inline constexpr std::uint32_t kFarthestReuse = kReuseDistances.back();

/// Bytes of code fetched, by the class of their reuse distance.
using CodeReuse = std::array<std::uint64_t, kReuseClasses>;

/// The class at a distance in bytes, or the next farther one.
constexpr std::size_t reuse_class(std::uint32_t distance) {
  return static_cast<std::size_t>(
      std::lower_bound(kReuseDistances.begin(), kReuseDistances.end(), distance) -
      kReuseDistances.begin());
}

/// Calls add(class, bytes) for the one or two classes of bytes that are fetched at a distance.
template <class Add>
constexpr void for_reuse_classes(std::uint32_t distance, std::uint32_t bytes, Add&& add) {
  const std::size_t farther = reuse_class(distance);
  if (farther == 0 || farther == kNeverFetched) return add(farther, bytes);
  const std::uint64_t near = kReuseDistances[farther - 1];
  const std::uint64_t width = kReuseDistances[farther] - near;
  const auto far_bytes =
      static_cast<std::uint32_t>((bytes * (distance - near) + width / 2) / width);
  if (far_bytes > 0) add(farther, far_bytes);
  if (far_bytes < bytes) add(farther - 1, bytes - far_bytes);
}

}  // namespace leviosim::work
