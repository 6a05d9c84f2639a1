// A grey texture with mip levels, sampled trilinearly. Each level halves the one before by 2x2
// averaging; outside, the edge texels continue. Left out: anisotropic filtering, colour.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace leviosim::traces {

class Texture {
 public:
  Texture() : Texture(1, 1, {0}) {}
  /// `texels` holds height rows of width texels.
  Texture(int width, int height, std::vector<std::uint8_t> texels);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }

  /// Grey level 0 ... 255 at (u, v), in texels of the finest level (texel i spans i ... i + 1),
  /// averaged over about `footprint` texels.
  float sample(float u, float v, float footprint) const;

 private:
  struct Level {
    int width;
    int height;
    std::size_t offset;  // in texels_
  };
  void add_half(const Level& from);
  float bilinear(const Level& level, float u, float v) const;

  std::vector<Level> levels_;
  std::vector<std::uint8_t> texels_;  // of all levels
};

}  // namespace leviosim::traces
