// The world that synthetic cameras look at: a rectangular room seen from inside and solid boxes in
// it, all with edges along the axes, each face with its own texture and, perhaps, a soft reflection
// of a lamp. Left out: slanted or curved surfaces, mirrors, shadows, anything that moves.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "traces/synthesis/texture.h"

namespace leviosim::traces {

/// One face of a box: what is painted on it and how much light it gets.
struct Surface {
  Texture texture;
  float texels_per_m = 1;
  float light = 1;  ///< factor on the grey levels
  /// Of a lamp above that it reflects softly: grey levels where the mirrored ray meets the lamp.
  float gloss = 0;
};

inline constexpr std::size_t kBoxFaces = 6;

/// Face 2 a + s is perpendicular to axis a, at min (s = 0) or max (s = 1). Its texture's u and v
/// run along the remaining two axes, in the order x, y, z, from `min`.
struct Box {
  Eigen::Vector3f min = Eigen::Vector3f::Zero();  ///< [m]
  Eigen::Vector3f max = Eigen::Vector3f::Zero();
  std::array<Surface, kBoxFaces> faces;
};

struct Hit {
  float reach = 0;  ///< the hit is at origin + reach * direction
  const Box* box = nullptr;
  int face = 0;
};

class World {
 public:
  World(Box room, std::vector<Box> objects);

  const Box& room() const { return room_; }
  const std::vector<Box>& objects() const { return objects_; }

  /// What a ray from inside the room meets first among the room and the objects with the given
  /// indices. The direction need not have unit length.
  Hit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
           std::span<const int> candidates) const;
  /// The nearest hit among all objects.
  Hit cast(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

  /// Grey level that the ray sees at its hit, through a pixel that spans `pixel_angle` radians.
  static float grey(const Hit& hit, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                    float pixel_angle);

 private:
  Box room_;
  std::vector<Box> objects_;
  std::vector<int> all_;
};

/// A box whose faces all have one grey level.
Box plain_box(const Eigen::Vector3f& min, const Eigen::Vector3f& max, std::uint8_t grey);

/// The indoor scene of the synthetic flight: 8 x 6 x 4 m (x, y from -4, -3 to 4, 3; z from 0 to 4),
/// with furniture, crates, pillars and beams along its walls; the middle (|x| < 1.4, |y| < 1,
/// 0.9 < z < 2.6) is free. The layout is fixed, the textures follow from the seed. `texel_m` is the
/// edge length of a texel; painting time and memory (30 MB at kRoomTexelM) go with its inverse
/// square. Painted on `threads` threads with the same result for any number.
World make_room(std::uint64_t seed, double texel_m, unsigned threads);

/// Fine enough for EuRoC's camera at 2 m, where a pixel covers 4.4 mm. [m]
constexpr double kRoomTexelM = 0.004;

}  // namespace leviosim::traces
