// A small writer of SVG 1.1: shapes and text in the order in which they are added. The same calls
// give the same bytes. Coordinates are pixels, x right, y down, printed with two decimals.
// Left out: CSS, transforms but the rotation of text, anything interactive.
#pragma once

#include <string>
#include <string_view>
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
  void rectangle(const Box& box, std::string_view fill);
  /// Many of a colour, in a third of the bytes that rectangle() takes.
  void rectangles(const std::vector<Box>& boxes, std::string_view fill);
  void text(Point at, std::string_view text, const TextStyle& style);
  /// The whole file.
  std::string str() const;

 private:
  std::string body_;
  double width_;
  double height_;
};

/// Values of an axis, low < high.
struct Range {
  double low = 0;
  double high = 0;
  double length() const { return high - low; }
};

/// Multiples of 1, 2 or 5 times a power of ten that lie in the range: at most `most` of them, and
/// as many as that allows. At least one if `most` is 4 or more and the range is not empty.
struct Ticks {
  double step = 1;
  std::vector<double> values;
};
Ticks round_ticks(const Range& range, int most);

/// The value with the decimals that its step needs.
std::string tick_label(double value, double step);

}  // namespace leviosim::tools::plot
