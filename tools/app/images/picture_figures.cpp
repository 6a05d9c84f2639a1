#include "tools/app/images/picture_figures.h"

#include <algorithm>
#include <cmath>

namespace leviosim::tools {
namespace {

constexpr int kSquare = 8;

constexpr int kDarkBelow = 20;

constexpr int kGlareAbove = 250;

class Picture {
 public:
  explicit Picture(const traces::GrayImage& image) : image_(image) {}
  int width() const { return image_.width; }
  int height() const { return image_.height; }
  int at(int x, int y) const {
    return image_.pixels[static_cast<std::size_t>(y) * image_.width + x];
  }
  /// With a standard deviation of 6 for white noise of 1.
  int plane_difference(int x, int y) const {
    return at(x - 1, y - 1) + at(x + 1, y - 1) + at(x - 1, y + 1) + at(x + 1, y + 1) -
           2 * (at(x, y - 1) + at(x, y + 1) + at(x - 1, y) + at(x + 1, y)) + 4 * at(x, y);
  }

 private:
  const traces::GrayImage& image_;
};

/// Calls visit(x, y) for the squares that lie within the image and a border of 1 px.
template <class Visit>
void for_each_square(const Picture& picture, const Visit& visit) {
  for (int y = 1; y + kSquare < picture.height(); y += kSquare)
    for (int x = 1; x + kSquare < picture.width(); x += kSquare) visit(x, y);
}

struct Moments {
  double mean = 0, deviation = 0;
};

/// Of value(x, y) over the square at (x0, y0).
template <class Value>
Moments moments(int x0, int y0, const Value& value) {
  double sum = 0, squares = 0;
  for (int y = y0; y < y0 + kSquare; ++y)
    for (int x = x0; x < x0 + kSquare; ++x) {
      const double v = value(x, y);
      sum += v;
      squares += v * v;
    }
  constexpr double kCount = kSquare * kSquare;
  return {sum / kCount, std::sqrt(std::max(0.0, squares / kCount - sum / kCount * sum / kCount))};
}

void add_light(const traces::GrayImage& image, PictureFigures& figures) {
  double sum = 0, squares = 0, dark = 0, glare = 0;
  for (const std::uint8_t pixel : image.pixels) {
    sum += pixel;
    squares += pixel * pixel;
    dark += pixel < kDarkBelow ? 1 : 0;
    glare += pixel > kGlareAbove ? 1 : 0;
  }
  const auto count = static_cast<double>(image.pixels.size());
  figures.brightness = sum / count;
  figures.contrast =
      std::sqrt(std::max(0.0, squares / count - figures.brightness * figures.brightness));
  figures.dark = dark / count;
  figures.glare = glare / count;
}

void add_squares(const Picture& picture, PictureFigures& figures) {
  std::vector<double> noise;
  for_each_square(picture, [&](int x, int y) {
    const Moments grey = moments(x, y, [&](int u, int v) { return picture.at(u, v); });
    figures.local.push_back(grey.deviation);
    if (grey.mean < kDarkBelow || grey.mean > kGlareAbove) return;
    const auto difference = [&](int u, int v) { return picture.plane_difference(u, v); };
    const Moments rough = moments(x, y, difference);
    noise.push_back(std::hypot(rough.mean, rough.deviation) / 6);
  });
  if (!noise.empty()) figures.noise = quantile(noise, 0.1);
}

/// Of the edges across rows and columns whose slope is the steepest within 5 px and among the
/// steepest twentieth: how far grey levels rise or fall without turning, over the slope.
void add_edge_width(const Picture& picture, PictureFigures& figures) {
  struct Edge {
    double slope, width;
  };
  std::vector<Edge> edges;
  const auto along = [&](int length, const auto& grey) {
    const auto slope = [&](int i) { return grey(i + 1) - grey(i); };
    for (int i = 4; i + 6 < length; ++i) {
      const int here = slope(i);
      bool steepest = std::abs(here) >= 12;
      for (int k = i - 2; k <= i + 2 && steepest; ++k)
        steepest = std::abs(slope(k)) < std::abs(here) || (k >= i && slope(k) == here);
      if (!steepest) continue;
      const int sign = here > 0 ? 1 : -1;
      int low = i, high = i + 1;
      while (low > i - 4 && sign * slope(low - 1) > 0) --low;
      while (high < i + 5 && sign * slope(high) > 0) ++high;
      edges.push_back({static_cast<double>(std::abs(here)),
                       static_cast<double>(std::abs(grey(high) - grey(low))) / std::abs(here)});
    }
  };
  for (int y = 0; y < picture.height(); ++y)
    along(picture.width(), [&](int i) { return picture.at(i, y); });
  for (int x = 0; x < picture.width(); ++x)
    along(picture.height(), [&](int i) { return picture.at(x, i); });
  if (edges.empty()) return;
  std::vector<double> slopes, widths;
  for (const Edge& edge : edges) slopes.push_back(edge.slope);
  const double steep = quantile(slopes, 0.95);
  for (const Edge& edge : edges)
    if (edge.slope >= steep) widths.push_back(edge.width);
  figures.edge_width = quantile(widths, 0.5);
}

}  // namespace

double quantile(std::vector<double>& values, double share) {
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

PictureFigures picture_figures(const traces::GrayImage& image) {
  PictureFigures figures;
  const Picture picture(image);
  add_light(image, figures);
  add_squares(picture, figures);
  add_edge_width(picture, figures);
  return figures;
}

}  // namespace leviosim::tools
