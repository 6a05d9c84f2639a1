// A pair of axes in a box of a picture: where values lie in it, ticks at round numbers, a grid.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/app/report/plot/svg.h"

namespace leviosim::tools::plot {

/// Values of an axis, low < high once widened().
struct Range {
  double low = 0;
  double high = 0;
  double length() const { return high - low; }
  void include(double value);
};

/// The range with `margin` of its length at both ends, and never empty.
Range widened(const Range& range, double margin);

/// Multiples of 1, 2 or 5 times a power of ten that lie in the range: at most `most` of them, and
/// as many as that allows. At least one if `most` is 4 or more and the range is not empty.
struct Ticks {
  double step = 1;
  std::vector<double> values;
};
Ticks round_ticks(const Range& range, int most);

/// The value with the decimals that its step needs.
std::string tick_label(double value, double step);

/// Values 1, 2 and 5 times a power of ten that lie in the range of positive numbers, or only the
/// powers if those are more than `most`; round_ticks() where the range is too short for two of
/// them.
std::vector<double> logarithmic_ticks(const Range& range, int most);

/// The range with `margin` of its length on a logarithmic scale at both ends. Both ends above 0.
Range widened_logarithmically(const Range& range, double margin);

enum class Scale { linear, logarithmic };

/// Ranges around the same middles that show both axes at the same scale in a box of that size.
std::pair<Range, Range> equal_aspect(const Box& box, const Range& x, const Range& y);

class Axes {
 public:
  /// Ranges of logarithmic axes are above 0.
  Axes(const Box& box, const Range& x, const Range& y, Scale scale = Scale::linear)
      : Axes(box, x, y, scale, scale) {}
  Axes(const Box& box, const Range& x, const Range& y, Scale x_scale, Scale y_scale)
      : box_(box), x_(x), y_(y), x_scale_(x_scale), y_scale_(y_scale) {}

  Point at(double x, double y) const;
  const Box& box() const { return box_; }
  const Range& x() const { return x_; }
  const Range& y() const { return y_; }

  /// Grid, ticks, frame and labels, which stand outside the box: below by 36 px, left by 50 px.
  void draw(Svg& svg, const std::string& x_label, const std::string& y_label) const;

 private:
  struct Tick {
    double value;
    std::string label;
  };
  static std::vector<Tick> ticks(const Range& range, Scale scale, int most);
  void draw_x(Svg& svg) const;
  void draw_y(Svg& svg) const;

  Box box_;
  Range x_;
  Range y_;
  Scale x_scale_;
  Scale y_scale_;
};

}  // namespace leviosim::tools::plot
