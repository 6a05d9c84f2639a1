// Pictures of a World through a distorting camera. Each pixel's ray comes from the exact inverse of
// the distortion; surfaces are averaged over the pixel (mip levels); then vignetting and sensor
// noise. Left out: motion blur, exposure control, rolling shutter, anti-aliased silhouettes.
//
// Speed: the rays are precomputed. For every tile of 16x16 pixels the objects whose bounding sphere
// misses the tile's cone of rays are dropped first, so most pixels test the room and a few boxes.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "traces/camera_model.h"
#include "traces/world.h"

namespace leviosim::traces {

struct RenderOptions {
  double noise = 1.2;       ///< standard deviation of the sensor noise [grey levels]
  double vignetting = 0.3;  ///< loss of light in the farthest corner, 0 ... 1
  std::uint64_t seed = 1;   ///< of the noise
};

class Renderer {
 public:
  /// Keeps a reference to the world. Throws InputError if the distortion cannot be inverted.
  Renderer(const World& world, const CameraModel& camera, const RenderOptions& options);

  int width() const { return width_; }
  int height() const { return height_; }

  /// The picture from a pose inside the room, row by row, 8-bit grey. A pure function of its
  /// arguments: `frame` selects the noise. Thread-safe.
  std::vector<std::uint8_t> render(const Eigen::Isometry3d& T_world_camera,
                                   std::uint64_t frame) const;

 private:
  struct Tile {
    int x0, y0, x1, y1;    // pixels, x1 and y1 exclusive
    Eigen::Vector3f axis;  // unit vector, camera frame
    float half_angle;      // of the cone around all its rays [rad]
  };
  void make_rays(const CameraModel& camera, double vignetting);
  void make_tiles();
  void make_noise(const RenderOptions& options);
  /// Objects that some ray of the tile may meet.
  void candidates(const Tile& tile, const Eigen::Matrix3f& rotation, const Eigen::Vector3f& origin,
                  std::vector<int>& found) const;
  void render_tile(const Tile& tile, const Eigen::Matrix3f& rotation, const Eigen::Vector3f& origin,
                   const std::vector<int>& objects, std::vector<float>& grey) const;
  std::vector<std::uint8_t> expose(const std::vector<float>& grey, std::uint64_t frame) const;

  const World& world_;
  int width_;
  int height_;
  float pixel_angle_;
  std::uint64_t seed_;
  std::vector<Eigen::Vector3f> rays_;  // camera frame, z = 1
  std::vector<float> gain_;            // vignetting
  std::vector<Tile> tiles_;
  std::vector<float> noise_;  // a power of two of draws
};

}  // namespace leviosim::traces
