#include "traces/synthesis/material_painter.h"

#include <algorithm>
#include <cmath>

#include "traces/datasets/rng.h"
#include "traces/synthesis/canvas.h"

namespace leviosim::traces {
namespace {

/// In [-1, 1), smooth, with random values at whole u and v.
double smooth_noise(std::uint64_t seed, double u, double v) {
  const auto at = [seed](double i, double j) {
    const auto key = (static_cast<std::uint64_t>(static_cast<std::int64_t>(i)) << 32) ^
                     static_cast<std::uint32_t>(static_cast<std::int64_t>(j));
    return static_cast<double>(derive_seed(seed, key) >> 11) * 0x1p-52 - 1;
  };
  const double i = std::floor(u), j = std::floor(v);
  const auto eased = [](double t) { return t * t * (3 - 2 * t); };
  const double s = eased(u - i), t = eased(v - j);
  const double top = at(i, j) + s * (at(i + 1, j) - at(i, j));
  const double bottom = at(i, j + 1) + s * (at(i + 1, j + 1) - at(i, j + 1));
  return top + t * (bottom - top);
}

/// Coordinates along and across the grain, which runs along the longer side.
struct Grain {
  bool turned;
  double length_m, breadth_m;

  explicit Grain(const SurfaceSpec& spec)
      : turned(spec.height_m > spec.width_m),
        length_m(std::max(spec.width_m, spec.height_m)),
        breadth_m(std::min(spec.width_m, spec.height_m)) {}
  double along(double x, double y) const { return turned ? y : x; }
  double across(double x, double y) const { return turned ? x : y; }
  Canvas::Patch patch(double along, double across, double half_along, double half_across) const {
    return turned ? Canvas::Patch{across, along, half_across, half_along, 0}
                  : Canvas::Patch{along, across, half_along, half_across, 0};
  }
};

/// Darkens an ellipse: `share` of the tone is left in its middle.
void darken(Canvas& canvas, const Canvas::Patch& patch, double tone, double share) {
  canvas.stamp(patch, [=](double a, double b) {
    const double r2 = a * a + b * b;
    return r2 > 1 ? -1.0f : static_cast<float>(tone * (share + (1 - share) * 0.6 * r2 * r2));
  });
}

void paint_timber(Canvas& canvas, const SurfaceSpec& spec) {
  const Grain grain(spec);
  const double s = spec.scale;
  const auto noise = [&](std::uint64_t part, double u, double v) {
    return smooth_noise(derive_seed(spec.seed, part), u / s, v / s);
  };
  canvas.fill([&](double x, double y) {
    const double u = grain.along(x, y);
    const double bend = 0.02 * noise(1, u / 0.35, grain.across(x, y) / 0.2);
    const double v = grain.across(x, y) + bend;
    const double streaks =
        0.10 * noise(2, u / 0.5, v / 0.012) + 0.10 * noise(3, u / 0.7, v / 0.045);
    const double stains =
        0.12 * noise(4, u / 0.12, v / 0.05) + 0.08 * noise(5, u / 0.02, v / 0.005);
    return static_cast<float>(spec.tone * (1 + streaks + stains));
  });
  Rng rng(derive_seed(spec.seed, 6));
  const double area = grain.length_m * grain.breadth_m / (s * s);
  const int knots = static_cast<int>(14 * area + rng.uniform());
  for (int i = 0; i < knots; ++i) {
    const double along = rng.uniform(0, grain.length_m);
    const double across = rng.uniform(0, grain.breadth_m);
    const double half = s * rng.uniform(0.006, 0.02);
    darken(canvas, grain.patch(along, across, half * rng.uniform(1, 2), half), spec.tone,
           rng.uniform(0.35, 0.6));
  }
  // Nails hold a board at both ends and in its middle, three in a row.
  if (grain.breadth_m < 0.05) return;
  for (const double at : {0.06 * s, 0.5 * grain.length_m, grain.length_m - 0.06 * s})
    for (const double share : {0.2, 0.5, 0.8})
      darken(canvas, grain.patch(at, share * grain.breadth_m, 0.006 * s, 0.006 * s), spec.tone,
             0.25);
}

void paint_net(Canvas& canvas, const SurfaceSpec& spec) {
  const double s = spec.scale;
  const double mesh = 0.045;
  canvas.fill([&](double x, double y) {
    const double u =
        x / s + 0.025 * smooth_noise(derive_seed(spec.seed, 1), x / s / 0.15, y / s / 0.15);
    const double v =
        y / s + 0.025 * smooth_noise(derive_seed(spec.seed, 2), x / s / 0.15, y / s / 0.15);
    const auto strand = [&](double across) {
      const double off = std::abs(across / mesh - std::floor(across / mesh) - 0.5) * mesh;
      return off < 0.007;
    };
    const double shade = 1 + 0.3 * smooth_noise(derive_seed(spec.seed, 3), u / 0.25, v / 0.25);
    return static_cast<float>(spec.tone * shade * (strand(u + v) || strand(u - v) ? 1.0 : 0.35));
  });
}

void paint_cloth(Canvas& canvas, const SurfaceSpec& spec) {
  const double s = spec.scale;
  canvas.fill([&](double x, double y) {
    const double folds =
        smooth_noise(derive_seed(spec.seed, 1), (x + 0.4 * y) / s / 0.5, y / s / 0.15);
    const double fine = smooth_noise(derive_seed(spec.seed, 2), x / s / 0.06, y / s / 0.04);
    return static_cast<float>(spec.tone * (1 + 0.7 * folds + 0.2 * fine));
  });
}

void paint_metal(Canvas& canvas, const SurfaceSpec& spec) {
  canvas.fill([&](double x, double y) {
    const double stains = smooth_noise(derive_seed(spec.seed, 1), x / 0.3, y / 0.3);
    return static_cast<float>(spec.tone * (1 + 0.1 * stains));
  });
}

}  // namespace

Texture paint_material(const SurfaceSpec& spec) {
  Canvas canvas(spec.width_m, spec.height_m, spec.texel_m);
  switch (spec.style) {
    case SurfaceStyle::timber:
      paint_timber(canvas, spec);
      break;
    case SurfaceStyle::net:
      paint_net(canvas, spec);
      break;
    case SurfaceStyle::cloth:
      paint_cloth(canvas, spec);
      break;
    default:
      paint_metal(canvas, spec);
  }
  return canvas.texture();
}

}  // namespace leviosim::traces
