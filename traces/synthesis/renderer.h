// Pictures of a World through a distorting camera. Each pixel's ray comes from the exact inverse of
// the distortion; surfaces are averaged over the pixel (mip levels); then vignetting, exposure and
// sensor noise. Motion blur is the mean of pictures from several poses. Left out: the delay of
// automatic exposure and its effect on motion blur, rolling shutter, anti-aliased silhouettes.
//
// Speed: the rays are precomputed and cast in packets, one for each tile of 16x16 pixels. Objects
// whose projection does not touch the picture, the row of tiles, the tile are dropped first, so
// most pixels test the room and a few boxes. Pixels that nobody will read need not be drawn.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/synthesis/screen_bounds.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {

struct RenderOptions {
  double noise = 1.2;       ///< standard deviation of the sensor noise [grey levels]
  double vignetting = 0.3;  ///< loss of light in the farthest corner, 0 ... 1
  std::uint64_t seed = 1;   ///< of the noise
  double spot_px = 1;       ///< width over which the lens and a pixel average a surface [px]
  /// For each pixel, row by row, whether it is drawn (not 0) or left black; all if empty. The drawn
  /// pixels are those of the whole picture.
  std::vector<std::uint8_t> wanted = {};
  /// Of the noise that rises with the root of the light, where it is 128; only beside the other
  /// one. [grey levels]
  double shot_noise = 0;
  /// Mean that automatic exposure brings a picture to, with at most kMostExposure times more light
  /// or less; 0: exposure is fixed. It is there at once. [grey levels]
  double exposed_to = 0;
};

inline constexpr float kMostExposure = 4;

/// One picture to be taken.
struct Exposure {
  std::span<const Eigen::Isometry3d> T_world_camera;  ///< poses to average over, inside the room
  float gain = 1;                                     ///< factor on the light
  std::uint64_t frame = 0;                            ///< selects the noise
};

class Renderer {
 public:
  /// Keeps a reference to the world. Throws InputError if the distortion cannot be inverted.
  Renderer(const World& world, const CameraModel& camera, const RenderOptions& options);

  int width() const { return width_; }
  int height() const { return height_; }

  /// The picture, row by row, 8-bit grey. A pure function of its arguments. Thread-safe.
  std::vector<std::uint8_t> render(const Exposure& exposure) const;
  /// The picture from one pose.
  std::vector<std::uint8_t> render(const Eigen::Isometry3d& T_world_camera,
                                   std::uint64_t frame) const;

 private:
  /// Entries begin ... end of a list below, and the bounds of their rays.
  struct Part {
    std::size_t begin, end;
    ScreenBounds bounds;
  };
  void make_tiles(const CameraModel& camera, const RenderOptions& options);
  void add_pixel(const CameraModel& camera, double vignetting, int x, int y);
  void make_noise(const RenderOptions& options);
  /// Adds the light from one pose to every drawn pixel, in the order of the tiles.
  void add_light(const Eigen::Isometry3d& T_world_camera, std::vector<float>& light) const;
  /// The factor of automatic exposure on pixels, which are as seen with a fixed one.
  float automatic_exposure(const std::vector<float>& grey) const;
  std::vector<std::uint8_t> expose(const std::vector<float>& light, float gain,
                                   std::uint64_t frame) const;

  const World& world_;
  int width_;
  int height_;
  float pixel_angle_;
  std::uint64_t seed_;
  float exposed_to_;
  float shot_ = 0;                     // squares of shot over other noise, for each grey level
  std::vector<Part> rows_;             // of tiles
  std::vector<Part> tiles_;            // of pixels that are drawn, in a square of the picture
  std::vector<std::size_t> pixels_;    // index in the picture, tile by tile
  std::vector<Eigen::Vector3f> rays_;  // camera frame, z = 1
  std::vector<float> vignetting_;      // factor
  std::vector<float> noise_;           // a power of two of draws
};

}  // namespace leviosim::traces
