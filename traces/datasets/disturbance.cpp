#include "traces/datasets/disturbance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {

using Pixels = std::vector<std::uint8_t>;

/// A picture and how much of what.
struct DisturbedPicture {
  const PictureTime& time;
  double value;
  int width;
  Pixels& pixels;
};

namespace {

std::int64_t to_ns(double seconds) { return std::llround(1e9 * seconds); }
double fraction(double percent) { return percent / 100; }

/// Whether a time lies within the `length_s` around the middle of the frames.
bool in_the_middle(const PictureTime& time, double length_s) {
  return std::abs(2 * time.t_ns - time.begin_ns - time.end_ns) <= to_ns(length_s);
}

std::uint8_t grey(double value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0) + 0.5);
}

void scale_light(Pixels& pixels, double factor) {
  for (std::uint8_t& pixel : pixels) pixel = grey(factor * pixel);
}

/// Keeps the frames for which `kept` says so, and the first one. @param kept  of (number, frame)
template <class Kept>
void keep_frames(Dataset& data, const Kept& kept) {
  std::vector<FrameRef> frames;
  for (std::size_t i = 0; i < data.frames.size(); ++i)
    if (i == 0 || kept(i, data.frames[i])) frames.push_back(data.frames[i]);
  data.frames = std::move(frames);
}

void drop_some(Dataset& data, double percent) {
  keep_frames(data, [&](std::size_t, const FrameRef& frame) {
    return !Rng(derive_seed(static_cast<std::uint64_t>(frame.t_ns), 1)).chance(fraction(percent));
  });
}

/// In a burst within each second, somewhere in it.
void drop_bursts(Dataset& data, double length) {
  const auto second = static_cast<std::size_t>(std::max(1.0, std::round(data.camera.rate_hz)));
  keep_frames(data, [&](std::size_t i, const FrameRef&) {
    const std::size_t room = second - std::min(second - 1, static_cast<std::size_t>(length));
    const auto begin =
        static_cast<std::size_t>(Rng(derive_seed(2, i / second)).below(static_cast<int>(room)));
    return i % second < begin || i % second >= begin + static_cast<std::size_t>(length);
  });
}

void keep_every(Dataset& data, double nth) {
  const auto n = static_cast<std::size_t>(nth);
  keep_frames(data, [&](std::size_t i, const FrameRef&) { return i % n == 0; });
  data.camera.rate_hz /= nth;
}

/// The camera delivers the last picture before the middle stretch again and again.
void freeze(Dataset& data, double length_s) {
  PictureTime time{0, data.frames.front().t_ns, data.frames.back().t_ns};
  for (std::size_t i = 1; i < data.frames.size(); ++i) {
    time.t_ns = data.frames[i].t_ns;
    if (!in_the_middle(time, length_s)) continue;
    data.frames[i].path = data.frames[i - 1].path;
    data.frames[i].line = data.frames[i - 1].line;
  }
}

void shift_imu(Dataset& data, double ms) {
  for (ImuSample& sample : data.imu) sample.t_ns += to_ns(1e-3 * ms);
}

/// Along the diagonal of the axes.
void add_gyro_bias(Dataset& data, double rad_per_s) {
  for (ImuSample& sample : data.imu)
    sample.gyro += Eigen::Vector3d::Constant(rad_per_s / std::sqrt(3.0));
}

void scale_accel(Dataset& data, double percent) {
  for (ImuSample& sample : data.imu) sample.accel *= 1 + fraction(percent);
}

void scale_focal_length(Dataset& data, double percent) {
  data.camera.fx *= 1 + fraction(percent);
  data.camera.fy *= 1 + fraction(percent);
}

/// Every other second is darker.
void step_brightness(const DisturbedPicture& p) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  if ((p.time.t_ns - p.time.begin_ns) / kSecond % 2 == 1)
    scale_light(p.pixels, 1 - fraction(p.value));
}

void darken(const DisturbedPicture& p) {
  constexpr double kLight = 0.02;  // a grey level or two are left
  if (in_the_middle(p.time, p.value)) scale_light(p.pixels, kLight);
}

void add_noise(const DisturbedPicture& p) {
  Rng rng(derive_seed(static_cast<std::uint64_t>(p.time.t_ns), 3));
  for (std::uint8_t& pixel : p.pixels) pixel = grey(pixel + p.value * rng.normal());
}

/// The lower part of each picture, as an arm or a gripper covers it.
template <class Shade>
void cover(const DisturbedPicture& p, const Shade& shade) {
  const auto width = static_cast<std::size_t>(p.width);
  const std::size_t height = p.pixels.size() / width;
  const auto covered =
      static_cast<std::size_t>(std::lround(fraction(p.value) * static_cast<double>(height)));
  for (std::size_t y = height - covered; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) p.pixels[y * width + x] = shade(x, y);
}

void cover_black(const DisturbedPicture& p) {
  cover(p, [](std::size_t, std::size_t) { return std::uint8_t{0}; });
}

/// Cells of random grey, which have corners.
std::uint8_t texture(std::size_t x, std::size_t y) {
  constexpr std::size_t kCell = 5;  // [px]
  return static_cast<std::uint8_t>(derive_seed(x / kCell, y / kCell));
}

void cover_textured(const DisturbedPicture& p) { cover(p, texture); }

/// A square that goes round the middle of the picture every three seconds, a quarter of its height
/// away, whatever the camera does.
void move_object(const DisturbedPicture& p) {
  constexpr double kPeriod = 3;  // [s]
  const double height = static_cast<double>(p.pixels.size()) / p.width;
  const double side = std::sqrt(fraction(p.value) * height * p.width);
  const double angle =
      2e-9 * std::numbers::pi / kPeriod * static_cast<double>(p.time.t_ns - p.time.begin_ns);
  const auto first = [&](double middle, double of) {
    return std::lround(middle + height / 4 * of - side / 2);
  };
  const long left = first(p.width / 2.0, std::cos(angle)), top = first(height / 2, std::sin(angle));
  const long size = std::lround(side);
  for (long y = std::max(0L, top); y < std::min(std::lround(height), top + size); ++y)
    for (long x = std::max(0L, left); x < std::min<long>(p.width, left + size); ++x)
      p.pixels[static_cast<std::size_t>(y * p.width + x)] =
          texture(static_cast<std::size_t>(x - left), static_cast<std::size_t>(y - top));
}

}  // namespace

struct DisturbanceKind {
  std::string_view name;
  std::string_view unit;
  double low, high;  // of the value
  bool whole;        // the value is a whole number
  void (*streams)(Dataset& data, double value);
  void (*picture)(const DisturbedPicture& picture);
};

namespace {

constexpr std::array kKinds{
    DisturbanceKind{"frames-dropped", "% of the frames", 0, 90, false, drop_some, nullptr},
    DisturbanceKind{"burst", "frames dropped in each second", 1, 1000, true, drop_bursts, nullptr},
    DisturbanceKind{"every-nth", "frame kept", 2, 100, true, keep_every, nullptr},
    DisturbanceKind{"frozen", "s", 0, 1000, false, freeze, nullptr},
    DisturbanceKind{"imu-delay", "ms", -50, 50, false, shift_imu, nullptr},
    DisturbanceKind{"gyro-bias", "rad/s", -10, 10, false, add_gyro_bias, nullptr},
    DisturbanceKind{"accel-scale", "%", -90, 100, false, scale_accel, nullptr},
    DisturbanceKind{"focal-length", "%", -50, 100, false, scale_focal_length, nullptr},
    DisturbanceKind{"brightness-steps", "%", 0, 100, false, nullptr, step_brightness},
    DisturbanceKind{"dark", "s", 0, 1000, false, nullptr, darken},
    DisturbanceKind{"noise", "grey levels", 0, 100, false, nullptr, add_noise},
    DisturbanceKind{"occlusion-black", "% of the rows", 0, 100, false, nullptr, cover_black},
    DisturbanceKind{"occlusion-textured", "% of the rows", 0, 100, false, nullptr, cover_textured},
    DisturbanceKind{"moving-object", "% of the picture", 0, 100, false, nullptr, move_object},
};

constexpr std::string_view kNone = "none";

std::optional<double> number_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::string Disturbance::text() const {
  return kind == nullptr ? std::string(kNone) : fmt::format("{}={:g}", kind->name, value);
}

std::string disturbance_kinds() {
  std::vector<std::string> names;
  for (const DisturbanceKind& kind : kKinds)
    names.push_back(fmt::format("{} [{}]", kind.name, kind.unit));
  return fmt::format("{}", fmt::join(names, ", "));
}

Disturbance parse_disturbance(std::string_view text) {
  if (text == kNone) return {};
  const std::size_t equals = text.find('=');
  const std::string name(text.substr(0, equals));
  std::vector<std::string> names{std::string(kNone)};
  for (const DisturbanceKind& kind : kKinds) {
    names.emplace_back(kind.name);
    if (kind.name != name) continue;
    const std::optional<double> value =
        equals == std::string_view::npos ? std::nullopt : number_of(text.substr(equals + 1));
    const bool right = value && *value >= kind.low && *value <= kind.high &&
                       (!kind.whole || *value == std::floor(*value));
    if (!right)
      throw InputError(
          fmt::format("disturbance '{}': expected {}=VALUE with a {}number from {:g} "
                      "to {:g} [{}]",
                      text, name, kind.whole ? "whole " : "", kind.low, kind.high, kind.unit));
    return {&kind, *value};
  }
  throw InputError(fmt::format("unknown disturbance '{}'{}; expected none, or KIND=VALUE with {}",
                               text, base::did_you_mean(name, names), disturbance_kinds()));
}

void disturb(Dataset& data, const Disturbance& disturbance) {
  data.disturbance = disturbance;
  if (disturbance.kind != nullptr && disturbance.kind->streams != nullptr)
    disturbance.kind->streams(data, disturbance.value);
}

void disturb_picture(const Disturbance& disturbance, const PictureTime& time, int width,
                     Pixels& pixels) {
  if (disturbance.kind != nullptr && disturbance.kind->picture != nullptr)
    disturbance.kind->picture({time, disturbance.value, width, pixels});
}

}  // namespace leviosim::traces
