#include "traces/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "traces/rng.h"

namespace leviosim::traces {
namespace {

constexpr int kTileEdge = 16;
constexpr int kNoiseBits = 12;  // five draws from one 64-bit number
constexpr int kDrawsPerNumber = 64 / kNoiseBits;

}  // namespace

Renderer::Renderer(const World& world, const CameraModel& camera, const RenderOptions& options)
    : world_(world),
      width_(camera.width),
      height_(camera.height),
      pixel_angle_(static_cast<float>(1 / std::sqrt(camera.fx * camera.fy))),
      seed_(options.seed) {
  make_rays(camera, options.vignetting);
  make_tiles();
  make_noise(options);
}

void Renderer::make_rays(const CameraModel& camera, double vignetting) {
  const double half_width = 0.5 * (width_ - 1);
  const double half_height = 0.5 * (height_ - 1);
  const double corner2 = std::max(1.0, half_width * half_width + half_height * half_height);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const Eigen::Vector2d point = camera.unproject({x, y});
      rays_.emplace_back(static_cast<float>(point.x()), static_cast<float>(point.y()), 1.0f);
      const double dx = x - half_width;
      const double dy = y - half_height;
      gain_.push_back(static_cast<float>(1 - vignetting * (dx * dx + dy * dy) / corner2));
    }
  }
}

void Renderer::make_tiles() {
  for (int y0 = 0; y0 < height_; y0 += kTileEdge) {
    for (int x0 = 0; x0 < width_; x0 += kTileEdge) {
      Tile tile{x0,
                y0,
                std::min(x0 + kTileEdge, width_),
                std::min(y0 + kTileEdge, height_),
                Eigen::Vector3f::Zero(),
                0};
      const auto each_ray = [&](const auto& visit) {
        for (int y = tile.y0; y < tile.y1; ++y)
          for (int x = tile.x0; x < tile.x1; ++x)
            visit(rays_[static_cast<std::size_t>(y) * width_ + x].normalized());
      };
      each_ray([&](const Eigen::Vector3f& ray) { tile.axis += ray; });
      tile.axis.normalize();
      float least_cosine = 1;
      each_ray([&](const Eigen::Vector3f& ray) {
        least_cosine = std::min(least_cosine, ray.dot(tile.axis));
      });
      constexpr float kRoundingMargin = 1e-3f;
      tile.half_angle = std::acos(least_cosine) + kRoundingMargin;
      tiles_.push_back(tile);
    }
  }
}

void Renderer::make_noise(const RenderOptions& options) {
  Rng rng(derive_seed(options.seed, 0));
  noise_.resize(std::size_t{1} << kNoiseBits);
  for (float& value : noise_) value = static_cast<float>(options.noise * rng.normal());
}

void Renderer::candidates(const Tile& tile, const Eigen::Matrix3f& rotation,
                          const Eigen::Vector3f& origin, std::vector<int>& found) const {
  found.clear();
  const Eigen::Vector3f axis = rotation * tile.axis;
  for (std::size_t i = 0; i < world_.objects().size(); ++i) {
    const Box& box = world_.objects()[i];
    const Eigen::Vector3f to_centre = 0.5f * (box.min + box.max) - origin;
    const float radius = 0.5f * (box.max - box.min).norm();
    const float distance = to_centre.norm();
    if (distance > radius) {
      const float angle = std::acos(std::clamp(axis.dot(to_centre) / distance, -1.0f, 1.0f));
      if (angle > tile.half_angle + std::asin(radius / distance)) continue;
    }
    found.push_back(static_cast<int>(i));
  }
}

void Renderer::render_tile(const Tile& tile, const Eigen::Matrix3f& rotation,
                           const Eigen::Vector3f& origin, const std::vector<int>& objects,
                           std::vector<float>& grey) const {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
      const Eigen::Vector3f direction = rotation * rays_[pixel];
      const Hit hit = world_.cast(origin, direction, objects);
      grey[pixel] = gain_[pixel] * World::grey(hit, origin, direction, pixel_angle_);
    }
  }
}

std::vector<std::uint8_t> Renderer::expose(const std::vector<float>& grey,
                                           std::uint64_t frame) const {
  Rng rng(derive_seed(seed_, frame + 1));
  std::vector<std::uint8_t> bytes(grey.size());
  std::uint64_t draws = 0;
  int left = 0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    if (left == 0) {
      draws = rng.next();
      left = kDrawsPerNumber;
    }
    const float value = grey[i] + noise_[draws & (noise_.size() - 1)];
    draws >>= kNoiseBits;
    --left;
    bytes[i] = static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
  }
  return bytes;
}

std::vector<std::uint8_t> Renderer::render(const Eigen::Isometry3d& T_world_camera,
                                           std::uint64_t frame) const {
  const Eigen::Matrix3f rotation = T_world_camera.linear().cast<float>();
  const Eigen::Vector3f origin = T_world_camera.translation().cast<float>();
  std::vector<float> grey(rays_.size());
  std::vector<int> objects;
  for (const Tile& tile : tiles_) {
    candidates(tile, rotation, origin, objects);
    render_tile(tile, rotation, origin, objects, grey);
  }
  return expose(grey, frame);
}

}  // namespace leviosim::traces
