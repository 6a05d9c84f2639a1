#include "traces/synthesis/canvas.h"

#include <algorithm>
#include <cmath>

#include "sim/base/interruption.h"

namespace leviosim::traces {
namespace {

/// Where a texel lies between lattice points, with the weight eased at both ends.
struct LatticePosition {
  int cell;
  float weight;
};

LatticePosition lattice_position(int texel, double cells_per_texel) {
  const double position = (texel + 0.5) * cells_per_texel;
  const int cell = static_cast<int>(position);
  const auto t = static_cast<float>(position - cell);
  return {cell, t * t * (3 - 2 * t)};
}

int texels(double length_m, double texel_m) {
  return std::max(1, static_cast<int>(std::lround(length_m / texel_m)));
}

}  // namespace

Canvas::Canvas(double width_m, double height_m, double texel_m)
    : width_m_(width_m),
      height_m_(height_m),
      texel_m_(texel_m),
      columns_(texels(width_m, texel_m)),
      rows_(texels(height_m, texel_m)),
      grey_(static_cast<std::size_t>(columns_) * rows_) {}

void Canvas::fill(const std::function<float(double, double)>& shader) {
  for (int y = 0; y < rows_; ++y) {
    throw_if_interrupted();
    for (int x = 0; x < columns_; ++x)
      at(x, y) = shader((x + 0.5) * texel_m_, (y + 0.5) * texel_m_);
  }
}

void Canvas::add_noise(double cell_m, float amplitude, std::uint64_t seed) {
  const double cells_per_texel = texel_m_ / cell_m;
  if (cells_per_texel > 0.5) return;
  const int lattice_columns = static_cast<int>(columns_ * cells_per_texel) + 2;
  const int lattice_rows = static_cast<int>(rows_ * cells_per_texel) + 2;
  Rng rng(seed);
  std::vector<float> lattice(static_cast<std::size_t>(lattice_columns) * lattice_rows);
  for (float& value : lattice) value = static_cast<float>(rng.uniform(-1, 1)) * amplitude;

  std::vector<LatticePosition> across;
  for (int x = 0; x < columns_; ++x) across.push_back(lattice_position(x, cells_per_texel));
  std::vector<float> line(static_cast<std::size_t>(lattice_columns));
  for (int y = 0; y < rows_; ++y) {
    throw_if_interrupted();
    const LatticePosition down = lattice_position(y, cells_per_texel);
    const float* upper = lattice.data() + static_cast<std::size_t>(down.cell) * lattice_columns;
    const float* lower = upper + lattice_columns;
    for (int i = 0; i < lattice_columns; ++i)
      line[i] = upper[i] + down.weight * (lower[i] - upper[i]);
    float* row = &at(0, y);
    for (int x = 0; x < columns_; ++x) {
      const LatticePosition& p = across[x];
      row[x] += line[p.cell] + p.weight * (line[p.cell + 1] - line[p.cell]);
    }
  }
}

void Canvas::stamp(const Patch& patch, const std::function<float(double, double)>& shader) {
  throw_if_interrupted();
  const double cosine = std::cos(patch.angle_rad);
  const double sine = std::sin(patch.angle_rad);
  const double reach_x = std::abs(cosine) * patch.half_x_m + std::abs(sine) * patch.half_y_m;
  const double reach_y = std::abs(sine) * patch.half_x_m + std::abs(cosine) * patch.half_y_m;
  const auto first = [this](double from) { return std::max(0, static_cast<int>(from / texel_m_)); };
  const int x_end = std::min(columns_, static_cast<int>((patch.x_m + reach_x) / texel_m_) + 1);
  const int y_end = std::min(rows_, static_cast<int>((patch.y_m + reach_y) / texel_m_) + 1);
  for (int y = first(patch.y_m - reach_y); y < y_end; ++y) {
    for (int x = first(patch.x_m - reach_x); x < x_end; ++x) {
      const double dx = (x + 0.5) * texel_m_ - patch.x_m;
      const double dy = (y + 0.5) * texel_m_ - patch.y_m;
      const double a = (cosine * dx + sine * dy) / patch.half_x_m;
      const double b = (cosine * dy - sine * dx) / patch.half_y_m;
      if (std::abs(a) > 1 || std::abs(b) > 1) continue;
      const float value = shader(a, b);
      if (value >= 0) at(x, y) = value;
    }
  }
}

Texture Canvas::texture() const {
  std::vector<std::uint8_t> bytes(grey_.size());
  std::transform(grey_.begin(), grey_.end(), bytes.begin(), [](float grey) {
    return static_cast<std::uint8_t>(std::clamp(grey, 0.0f, 255.0f) + 0.5f);
  });
  return Texture(columns_, rows_, std::move(bytes));
}

}  // namespace leviosim::traces
