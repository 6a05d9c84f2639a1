#include "traces/synthesis/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sim/base/check.h"
#include "sim/base/interruption.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/ray_packet.h"
#include "traces/synthesis/screen_bounds.h"

namespace leviosim::traces {
namespace {

constexpr int kTileEdge = 16;
static_assert(kTileEdge * kTileEdge <= RayPacket::kMost);
constexpr int kNoiseBits = 12;  // five draws from one 64-bit number
constexpr int kDrawsPerNumber = 64 / kNoiseBits;

}  // namespace

Renderer::Renderer(const World& world, const CameraModel& camera, const RenderOptions& options)
    : world_(world),
      width_(camera.width),
      height_(camera.height),
      pixel_angle_(static_cast<float>(options.spot_px / std::sqrt(camera.fx * camera.fy))),
      seed_(options.seed),
      exposed_to_(static_cast<float>(options.exposed_to)) {
  const std::size_t pixels = static_cast<std::size_t>(width_) * height_;
  check(options.shot_noise == 0 || options.noise > 0, "Renderer: shot noise beside read noise");
  check(options.wanted.empty() || options.wanted.size() == pixels, "Renderer: wanted pixels");
  make_tiles(camera, options);
  make_noise(options);
}

void Renderer::make_tiles(const CameraModel& camera, const RenderOptions& options) {
  const auto wanted = [&](int x, int y) {
    return options.wanted.empty() || options.wanted[static_cast<std::size_t>(y) * width_ + x] != 0;
  };
  for (int y0 = 0; y0 < height_; y0 += kTileEdge) {
    Part row{tiles_.size(), 0, {}};
    for (int x0 = 0; x0 < width_; x0 += kTileEdge) {
      Part tile{pixels_.size(), 0, {}};
      for (int y = y0; y < std::min(y0 + kTileEdge, height_); ++y)
        for (int x = x0; x < std::min(x0 + kTileEdge, width_); ++x)
          if (wanted(x, y)) add_pixel(camera, options.vignetting, x, y);
      tile.end = pixels_.size();
      if (tile.end == tile.begin) continue;
      constexpr float kRoundingMargin = 1e-4f;
      for (std::size_t i = tile.begin; i < tile.end; ++i)
        for (const float margin : {-kRoundingMargin, kRoundingMargin})
          tile.bounds.extend(Eigen::Vector2f(rays_[i].head<2>().array() + margin));
      row.bounds.extend(tile.bounds);
      tiles_.push_back(tile);
    }
    row.end = tiles_.size();
    rows_.push_back(row);
  }
}

void Renderer::add_pixel(const CameraModel& camera, double vignetting, int x, int y) {
  const Eigen::Vector2d point = camera.unproject({x, y});
  rays_.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()), 1.0f);
  pixels_.push_back(static_cast<std::size_t>(y) * width_ + x);
  const double half_width = 0.5 * (width_ - 1);
  const double half_height = 0.5 * (height_ - 1);
  const double corner2 = std::max(1.0, half_width * half_width + half_height * half_height);
  const double dx = x - half_width;
  const double dy = y - half_height;
  vignetting_.push_back(static_cast<float>(1 - vignetting * (dx * dx + dy * dy) / corner2));
}

void Renderer::make_noise(const RenderOptions& options) {
  Rng rng(derive_seed(options.seed, 0));
  noise_.resize(std::size_t{1} << kNoiseBits);
  for (float& value : noise_) value = static_cast<float>(options.noise * rng.normal());
  constexpr double kGreyOfShot = 128;
  const double ratio = options.shot_noise / options.noise;
  if (options.shot_noise > 0) shot_ = static_cast<float>(ratio * ratio / kGreyOfShot);
}

void Renderer::add_light(const Eigen::Isometry3d& T_world_camera, std::vector<float>& light) const {
  const Eigen::Matrix3f rotation = T_world_camera.linear().cast<float>();
  const Eigen::Vector3f origin = T_world_camera.translation().cast<float>();
  const Eigen::Isometry3f T_camera_world = T_world_camera.inverse().cast<float>();
  std::vector<ScreenBounds> bounds;
  std::vector<int> in_picture, in_row, in_tile;
  for (const Box& box : world_.objects()) {
    bounds.push_back(screen_bounds(box, T_camera_world));
    in_picture.push_back(static_cast<int>(in_picture.size()));
  }
  const auto keep = [&bounds](const std::vector<int>& from, const Part& part,
                              std::vector<int>& to) {
    to.clear();
    for (const int i : from)
      if (bounds[static_cast<std::size_t>(i)].intersects(part.bounds)) to.push_back(i);
  };
  RayPacket packet;
  for (const Part& row : rows_) {
    keep(in_picture, row, in_row);
    for (std::size_t t = row.begin; t < row.end; ++t) {
      const Part& tile = tiles_[t];
      keep(in_row, tile, in_tile);
      packet.aim(origin, rotation, std::span(rays_).subspan(tile.begin, tile.end - tile.begin));
      packet.cast(world_, in_tile);
      for (int i = 0; i < packet.size(); ++i)
        light[tile.begin + static_cast<std::size_t>(i)] +=
            World::grey(packet.hit(world_, i), origin, packet.direction(i), pixel_angle_);
    }
  }
}

float Renderer::automatic_exposure(const std::vector<float>& grey) const {
  if (exposed_to_ == 0) return 1;
  double sum = 0;
  for (const std::size_t pixel : pixels_)
    sum += std::min(grey[pixel], 255.0f);  // what is brighter counts as white
  const float mean = static_cast<float>(sum / static_cast<double>(pixels_.size()));
  return std::clamp(exposed_to_ / std::max(mean, 1.0f), 1 / kMostExposure, kMostExposure);
}

std::vector<std::uint8_t> Renderer::expose(const std::vector<float>& light, float gain,
                                           std::uint64_t frame) const {
  std::vector<float> grey(static_cast<std::size_t>(width_) * height_, -1.0f);
  for (std::size_t i = 0; i < light.size(); ++i)
    grey[pixels_[i]] = vignetting_[i] * (gain * light[i]);
  const float exposure = automatic_exposure(grey);
  for (const std::size_t pixel : pixels_) grey[pixel] *= exposure;
  Rng rng(derive_seed(seed_, frame + 1));
  std::vector<std::uint8_t> bytes(grey.size());
  std::uint64_t draws = 0;
  int left = 0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    if (left == 0) {
      draws = rng.next();
      left = kDrawsPerNumber;
    }
    float noise = noise_[draws & (noise_.size() - 1)];
    if (shot_ > 0 && grey[i] > 0) noise *= std::sqrt(1 + shot_ * grey[i]);
    const float value = grey[i] + noise;
    draws >>= kNoiseBits;
    --left;
    if (grey[i] >= 0) bytes[i] = static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
  }
  return bytes;
}

std::vector<std::uint8_t> Renderer::render(const Exposure& exposure) const {
  std::vector<float> light(pixels_.size(), 0.0f);
  for (const Eigen::Isometry3d& pose : exposure.T_world_camera) {
    throw_if_interrupted();
    add_light(pose, light);
  }
  const float mean = exposure.gain / static_cast<float>(exposure.T_world_camera.size());
  return expose(light, mean, exposure.frame);
}

std::vector<std::uint8_t> Renderer::render(const Eigen::Isometry3d& T_world_camera,
                                           std::uint64_t frame) const {
  return render({.T_world_camera = {&T_world_camera, 1}, .gain = 1, .frame = frame});
}

namespace {

constexpr float kNearest = 1e-3f;  // [m]
constexpr std::size_t kCorners = 8;

void extend(ScreenBounds& bounds, const Eigen::Vector3f& point) {
  bounds.extend(Eigen::Vector2f(point.head<2>() / point.z()));
}

/// The point at which the edge from a (in front) to b (behind) leaves the visible half-space.
Eigen::Vector3f clipped(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return a + (a.z() - kNearest) / (a.z() - b.z()) * (b - a);
}

}  // namespace

ScreenBounds screen_bounds(const Box& box, const Eigen::Isometry3f& T_camera_world) {
  std::array<Eigen::Vector3f, kCorners> corners;
  for (std::size_t i = 0; i < kCorners; ++i)
    corners[i] = T_camera_world * Eigen::Vector3f(i & 1 ? box.max.x() : box.min.x(),
                                                  i & 2 ? box.max.y() : box.min.y(),
                                                  i & 4 ? box.max.z() : box.min.z());
  ScreenBounds bounds;
  for (std::size_t i = 0; i < kCorners; ++i) {
    if (corners[i].z() < kNearest) continue;
    extend(bounds, corners[i]);
    for (const std::size_t axis : {1, 2, 4})
      if (const Eigen::Vector3f& other = corners[i ^ axis]; other.z() < kNearest)
        extend(bounds, clipped(corners[i], other));
  }
  return bounds;
}

}  // namespace leviosim::traces
