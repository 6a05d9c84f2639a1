#include "traces/synthesis/surface_painter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "traces/datasets/rng.h"
#include "traces/synthesis/canvas.h"
#include "traces/synthesis/workshop_surfaces.h"

namespace leviosim::traces {
namespace {

/// A random number in [-1, 1) that belongs to cell (i, j) of a pattern.
double cell_random(std::uint64_t seed, int i, int j) {
  const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32) |
                   static_cast<std::uint32_t>(j);
  return static_cast<double>(derive_seed(seed, key) >> 11) * 0x1p-52 - 1;
}

/// Rows of equal blocks, every second row shifted, each block in its own tone, joints between.
struct BlockPattern {
  double length_m, height_m, joint_m;
  double shift;     ///< of every second row, in blocks
  double contrast;  ///< of the blocks [grey levels]
  double joint;     ///< tone of the joints against the mean
};

float block_tone(const BlockPattern& p, const SurfaceSpec& spec, double x, double y) {
  const double row = std::floor(y / p.height_m);
  const bool odd = std::fmod(row, 2) != 0;
  const double along = x / p.length_m + (odd ? p.shift : 0);
  const double column = std::floor(along);
  const bool in_joint =
      (along - column) * p.length_m < p.joint_m || y - row * p.height_m < p.joint_m;
  const double random = cell_random(spec.seed, static_cast<int>(column), static_cast<int>(row));
  return static_cast<float>(spec.tone + (in_joint ? p.joint : p.contrast * random));
}

/// What a style looks like before anything is stuck to it.
struct StyleRow {
  BlockPattern blocks;
  float noise;             ///< amplitude of the coarsest octave [grey levels]
  double sheets_per_m2;    ///< large patches
  double speckles_per_m2;  ///< small patches
};

constexpr std::array<StyleRow, 5> kStyles{{
    // length, height, joint, shift, contrast, joint tone; noise, sheets, speckles
    {{20.0, 20.0, 0.0, 0.0, 0.0, 0.0}, 26, 1.3, 5},       // plaster
    {{1.3, 0.16, 0.012, 0.37, 30.0, -55.0}, 18, 0.5, 3},  // planks
    {{0.26, 0.13, 0.016, 0.5, 26.0, 24.0}, 18, 0.7, 1},   // bricks
    {{0.9, 0.11, 0.012, 0.0, 22.0, -60.0}, 16, 2.0, 5},   // crate
    {{0.8, 0.6, 0.014, 0.0, 24.0, -50.0}, 24, 1.2, 4},    // panels
}};

const StyleRow& style_row(SurfaceStyle style) { return kStyles[static_cast<std::size_t>(style)]; }

/// The grey levels of a print: dark on light or the other way round.
struct Ink {
  float paper;
  float ink;
};

Ink random_ink(Rng& rng) {
  const auto dark = static_cast<float>(rng.uniform(8, 70));
  const auto light = static_cast<float>(rng.uniform(150, 245));
  return rng.chance(0.7) ? Ink{light, dark} : Ink{dark, light};
}

void stamp_solid(Canvas& canvas, const Canvas::Patch& patch, Rng& rng) {
  const Ink ink = random_ink(rng);
  canvas.stamp(patch, [ink](double a, double b) {
    return std::max(std::abs(a), std::abs(b)) > 0.88 ? ink.ink : ink.paper;
  });
}

void stamp_checker(Canvas& canvas, const Canvas::Patch& patch, Rng& rng) {
  const Ink ink = random_ink(rng);
  const int columns = 2 + rng.below(5);
  const int rows = 2 + rng.below(4);
  canvas.stamp(patch, [=](double a, double b) {
    const int i = static_cast<int>((a + 1) * 0.5 * columns);
    const int j = static_cast<int>((b + 1) * 0.5 * rows);
    return (i + j) % 2 == 0 ? ink.paper : ink.ink;
  });
}

/// Cells of random tones, like a photograph seen from afar.
void stamp_mosaic(Canvas& canvas, const Canvas::Patch& patch, Rng& rng) {
  const std::uint64_t seed = rng.next();
  const int columns = 3 + rng.below(6);
  const int rows = 3 + rng.below(6);
  canvas.stamp(patch, [=](double a, double b) {
    const int i = static_cast<int>((a + 1) * 0.5 * columns);
    const int j = static_cast<int>((b + 1) * 0.5 * rows);
    return static_cast<float>(128 + 115 * cell_random(seed, i, j));
  });
}

/// Lines of words: dashes of random length with gaps.
void stamp_print(Canvas& canvas, const Canvas::Patch& patch, Rng& rng) {
  const Ink ink = random_ink(rng);
  const std::uint64_t seed = rng.next();
  const int lines = 4 + rng.below(5);
  const int letters = 10 + rng.below(8);
  canvas.stamp(patch, [=](double a, double b) {
    if (std::max(std::abs(a), std::abs(b)) > 0.86) return ink.paper;
    const double line = (b + 1) * 0.5 * lines;
    const int j = static_cast<int>(line);
    const int i = static_cast<int>((a + 1) * 0.5 * letters);
    const bool in_line = line - j > 0.35;
    return in_line && cell_random(seed, i, j) > -0.4 ? ink.ink : ink.paper;
  });
}

/// A blot with a wavy rim.
void stamp_stain(Canvas& canvas, const Canvas::Patch& patch, Rng& rng) {
  const auto tone =
      static_cast<float>(rng.chance(0.6) ? rng.uniform(10, 80) : rng.uniform(150, 240));
  const double p = rng.uniform(0, 6.28);
  const double q = rng.uniform(0, 6.28);
  canvas.stamp(patch, [=](double a, double b) {
    const double u = a + 0.25 * std::sin(4.5 * b + p);
    const double v = b + 0.25 * std::sin(5.5 * a + q);
    return u * u + v * v > 0.55 ? -1.0f : tone;
  });
}

using Stamp = void (*)(Canvas&, const Canvas::Patch&, Rng&);
constexpr std::array<Stamp, 7> kSheets{stamp_print, stamp_mosaic,  stamp_print, stamp_mosaic,
                                       stamp_solid, stamp_checker, stamp_stain};
constexpr std::array<Stamp, 5> kSpeckles{stamp_stain, stamp_solid, stamp_stain, stamp_mosaic,
                                         stamp_stain};

Canvas::Patch random_patch(const Canvas& canvas, Rng& rng, double low_m, double high_m) {
  constexpr double kUpright = 0.06;  // radians by which hung things are askew
  constexpr double kAnyAngle = 1.5;
  Canvas::Patch patch{};
  patch.x_m = rng.uniform(0, canvas.width_m());
  patch.y_m = rng.uniform(0, canvas.height_m());
  patch.half_x_m = rng.log_uniform(low_m, high_m);
  patch.half_y_m = patch.half_x_m * rng.uniform(0.6, 1.5);
  const double askew = rng.chance(0.6) ? kUpright : kAnyAngle;
  patch.angle_rad = rng.uniform(-askew, askew);
  return patch;
}

template <std::size_t N>
void scatter(Canvas& canvas, const std::array<Stamp, N>& stamps, double per_m2, double low_m,
             double high_m, double scale, std::uint64_t seed) {
  Rng rng(seed);
  const double area = canvas.width_m() * canvas.height_m() / (scale * scale);
  const int count = static_cast<int>(area * per_m2 + rng.uniform());
  for (int i = 0; i < count; ++i) {
    const Canvas::Patch patch = random_patch(canvas, rng, scale * low_m, scale * high_m);
    stamps[static_cast<std::size_t>(rng.below(static_cast<int>(N)))](canvas, patch, rng);
  }
}

/// Octaves from 1.6 m (times the scale) down; each finer one has 0.8 of the amplitude.
void add_octaves(Canvas& canvas, float amplitude, double scale, std::uint64_t seed) {
  constexpr int kOctaves = 7;
  double cell_m = 1.6 * scale;
  for (int octave = 0; octave < kOctaves; ++octave) {
    canvas.add_noise(cell_m, amplitude, derive_seed(seed, static_cast<std::uint64_t>(octave)));
    cell_m *= 0.5;
    amplitude *= 0.8f;
  }
}

}  // namespace

Texture paint_surface(const SurfaceSpec& spec) {
  if (spec.style >= SurfaceStyle::timber) return paint_material(spec);
  const StyleRow& style = style_row(spec.style);
  Canvas canvas(spec.width_m, spec.height_m, spec.texel_m);
  const double s = spec.scale;
  canvas.fill([&](double x, double y) { return block_tone(style.blocks, spec, x / s, y / s); });
  scatter(canvas, kSpeckles, style.speckles_per_m2, 0.025, 0.08, s, derive_seed(spec.seed, 1));
  scatter(canvas, kSheets, style.sheets_per_m2, 0.08, 0.3, s, derive_seed(spec.seed, 2));
  add_octaves(canvas, style.noise, s, derive_seed(spec.seed, 3));
  return canvas.texture();
}

namespace {

/// In [-1, 1), smooth, with random values at whole u and v. A pure function of them; the values
/// around the last point are kept, since the next one lies in the same cell or the one after it.
class SmoothNoise {
 public:
  SmoothNoise(const SurfaceSpec& spec, std::uint64_t part) : seed_(derive_seed(spec.seed, part)) {}

  double operator()(double u, double v) {
    const auto i = whole(u), j = whole(v);
    if (i != i_ || j != j_ || !begun_) enter(i, j);
    const auto eased = [](double t) { return t * t * (3 - 2 * t); };
    const double s = eased(u - static_cast<double>(i)), t = eased(v - static_cast<double>(j));
    const double top = left_[0] + s * (right_[0] - left_[0]);
    const double bottom = left_[1] + s * (right_[1] - left_[1]);
    return top + t * (bottom - top);
  }

 private:
  static std::int64_t whole(double x) {
    const auto i = static_cast<std::int64_t>(x);
    return static_cast<double>(i) > x ? i - 1 : i;
  }
  double at(std::int64_t i, std::int64_t j) const {
    const auto key = (static_cast<std::uint64_t>(i) << 32) ^ static_cast<std::uint32_t>(j);
    return static_cast<double>(derive_seed(seed_, key) >> 11) * 0x1p-52 - 1;
  }
  void enter(std::int64_t i, std::int64_t j) {
    const bool next = begun_ && j == j_ && i == i_ + 1;
    left_ = next ? right_ : std::array{at(i, j), at(i, j + 1)};
    right_ = {at(i + 1, j), at(i + 1, j + 1)};
    i_ = i;
    j_ = j;
    begun_ = true;
  }

  std::uint64_t seed_;
  bool begun_ = false;
  std::int64_t i_ = 0, j_ = 0;
  std::array<double, 2> left_{}, right_{};  // of the cell, at j and j + 1
};

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
  SmoothNoise bends(spec, 1), fine(spec, 2), wide(spec, 3), stained(spec, 4), rough(spec, 5);
  canvas.fill([&](double x, double y) {
    const double u = grain.along(x, y);
    const double bend = 0.02 * bends(u / 0.35 / s, grain.across(x, y) / 0.2 / s);
    const double v = grain.across(x, y) + bend;
    const double streaks =
        0.25 * fine(u / 0.5 / s, v / 0.012 / s) + 0.25 * wide(u / 0.7 / s, v / 0.045 / s);
    const double stains =
        0.18 * stained(u / 0.12 / s, v / 0.05 / s) + 0.12 * rough(u / 0.02 / s, v / 0.005 / s);
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
  SmoothNoise bends_u(spec, 1), bends_v(spec, 2), shades(spec, 3);
  canvas.fill([&](double x, double y) {
    const double u = x / s + 0.025 * bends_u(x / s / 0.15, y / s / 0.15);
    const double v = y / s + 0.025 * bends_v(x / s / 0.15, y / s / 0.15);
    const auto strand = [&](double across) {
      const double off = std::abs(across / mesh - std::floor(across / mesh) - 0.5) * mesh;
      return off < 0.007;
    };
    const double shade = 1 + 0.3 * shades(u / 0.25, v / 0.25);
    return static_cast<float>(spec.tone * shade * (strand(u + v) || strand(u - v) ? 1.0 : 0.35));
  });
}

void paint_cloth(Canvas& canvas, const SurfaceSpec& spec) {
  const double s = spec.scale;
  SmoothNoise folds(spec, 1), creases(spec, 2);
  canvas.fill([&](double x, double y) {
    const double fold = folds((x + 0.4 * y) / s / 0.5, y / s / 0.15);
    const double crease = creases(x / s / 0.06, y / s / 0.04);
    return static_cast<float>(spec.tone * (1 + 0.7 * fold + 0.2 * crease));
  });
}

void paint_metal(Canvas& canvas, const SurfaceSpec& spec) {
  SmoothNoise stains(spec, 1);
  canvas.fill([&](double x, double y) {
    return static_cast<float>(spec.tone * (1 + 0.1 * stains(x / 0.3, y / 0.3)));
  });
}

/// Pallets one upon the other, from the side: edges of boards, all alike, and the ends of joists
/// in the dark between them.
void paint_stack(Canvas& canvas, const SurfaceSpec& spec) {
  constexpr double kPalletM = 0.145, kBoardM = 0.028, kJoistEveryM = 0.42, kJoistM = 0.09;
  const double s = spec.scale;
  SmoothNoise grain(spec, 1), dirt(spec, 2);
  canvas.fill([&](double x, double y) {
    const double pallet = std::floor(y / s / kPalletM);
    const double below_top = (pallet + 1) * kPalletM - y / s;
    const double random = cell_random(spec.seed, 0, static_cast<int>(pallet));
    const double along = (x / s + 0.1 * random) / kJoistEveryM;
    const bool joist = (along - std::floor(along)) * kJoistEveryM < kJoistM;
    const double wood = below_top < kBoardM ? 1 + 0.25 * random : joist ? 0.5 : 0.2;
    const double stains = 0.2 * grain(x / s / 0.15, y / s / 0.006) + 0.3 * dirt(x / 0.3, y / 0.2);
    return static_cast<float>(spec.tone * wood * (1 + stains));
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
    case SurfaceStyle::stack:
      paint_stack(canvas, spec);
      break;
    default:
      paint_metal(canvas, spec);
  }
  return canvas.texture();
}

}  // namespace leviosim::traces
