// A small writer of SVG 1.1: shapes and text in the order in which they are added. The same calls
// give the same bytes. Coordinates are pixels, x right, y down, printed with two decimals.
// Left out: CSS, transforms but the rotation of text, anything interactive.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace leviosim::tools::plot {

struct Point {
  double x = 0;
  double y = 0;
};

struct Box {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

struct Stroke {
  std::string colour = "#000000";
  double width = 1;
  std::string dashes{};  ///< "4 3"; a full line if empty
};

enum class Anchor { start, middle, end };

struct TextStyle {
  double size = 12;  ///< [px]
  Anchor anchor = Anchor::start;
  std::string colour = "#333333";
  bool bold = false;
  bool upwards = false;  ///< turned by a quarter, read from below
};

/// Text as it may stand in XML, in attributes too: markup escaped; control characters and what is
/// no UTF-8 replaced by U+FFFD.
std::string escape_xml(std::string_view text);

class Svg {
 public:
  /// On white. `title` is for readers that do not see the picture.
  Svg(double width, double height, std::string_view title);

  void line(Point from, Point to, const Stroke& stroke);
  /// Points closer than a quarter of a pixel to the last drawn one are left out.
  void polyline(const std::vector<Point>& points, const Stroke& stroke);
  void rectangle(const Box& box, std::string_view fill);
  /// Many of a colour, in a third of the bytes that rectangle() takes.
  void rectangles(const std::vector<Box>& boxes, std::string_view fill);
  void frame(const Box& box, const Stroke& stroke);
  void circle(Point centre, double radius, std::string_view fill, const Stroke& stroke);
  /// Closed.
  void polygon(const std::vector<Point>& corners, std::string_view fill, const Stroke& stroke,
               double opacity = 1);
  void text(Point at, std::string_view text, const TextStyle& style);
  /// What is added until the end of the group is cut off at the box.
  void begin_clip(const Box& box);
  void end_group();

  /// The whole file.
  std::string str() const;

 private:
  std::string body_;
  double width_;
  double height_;
  int clips_ = 0;
};

// A pair of axes in a box of a picture: where values lie in it, ticks at round numbers, a grid.

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

// Colours of a value from 0 to a maximum: blue, teal, amber, red, all dark enough to be seen on
// white.

/// How many different colours the scale has.
constexpr int kColours = 24;

/// 0 ... kColours - 1, in equal parts of [0, max]; the ends for values outside, 0 if max is 0.
int colour_index(double value, double max);

/// "#rrggbb".
std::string colour(int index);

}  // namespace leviosim::tools::plot
