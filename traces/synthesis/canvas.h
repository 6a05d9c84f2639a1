// A drawing board in metres: grey levels as floats, clipped only when the texture is made. Walls
// have 10^8 texels, so that drawing throws Interrupted in the middle of one.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "traces/datasets/rng.h"
#include "traces/synthesis/texture.h"

namespace leviosim::traces {

class Canvas {
 public:
  Canvas(double width_m, double height_m, double texel_m);

  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }

  /// Sets every texel to shader(x, y), position in metres.
  void fill(const std::function<float(double, double)>& shader);

  /// Adds value noise: random values on a lattice with cells of `cell_m`, smoothly interpolated,
  /// between -amplitude and +amplitude. Cells finer than two texels are skipped.
  void add_noise(double cell_m, float amplitude, std::uint64_t seed);

  /// A rectangle on the canvas, turned by an angle about its centre.
  struct Patch {
    double x_m, y_m;            ///< centre
    double half_x_m, half_y_m;  ///< half its edges
    double angle_rad;
  };
  /// Sets the texels inside the patch to shader(a, b), with a and b from -1 to 1 across it. A
  /// negative result leaves the texel as it is.
  void stamp(const Patch& patch, const std::function<float(double, double)>& shader);

  Texture texture() const;

 private:
  float& at(int x, int y) { return grey_[static_cast<std::size_t>(y) * columns_ + x]; }

  double width_m_;
  double height_m_;
  double texel_m_;
  int columns_;
  int rows_;
  std::vector<float> grey_;
};

}  // namespace leviosim::traces
