// From a camera's picture to the image the pipeline works on: undistort at full resolution with the
// same camera matrix (bilinear, black outside), then take every k-th pixel, without a low-pass.
//
// The rule of the decimation, for a wanted size w x h of a W x H image:
//   k = min(W / w, H / h) in whole numbers; the window of w k x h k pixels is centred,
//   x0 = (W - w k) / 2, y0 = (H - h k) / 2; pixel (i, j) is taken at (x0 + k i + s, y0 + k j + s),
//   where s = 1 if k > 1 and s = 0 if k = 1.
// 752x480 to 160x120 gives k = 4 and columns 57, 61, ..., rows 1, 5, ...: those of the published
// LEVIO. Its published intrinsics (114.66, 114.32, 77.80, 62.09) are those of the window's origin,
// fx / k and (cx - x0) / k, without the s; we follow them, so for k > 1 the principal point is off
// by s / k px (a quarter of a pixel at 160x120), as it is there.
//
// The maps are double arithmetic, rounded to 1/32 px, and the interpolation is OpenCV's fixed-point
// one, so the bytes do not depend on the host. Since every output pixel is interpolated by itself,
// only the pixels that survive the decimation are computed; the result is that of undistorting
// everything.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/image_file.h"

namespace leviosim::traces {

/// Which pixels of the full image remain.
struct Decimation {
  int factor = 1;
  int x0 = 0, y0 = 0;  ///< origin of the window
  int shift = 0;       ///< of the samples against the origin, in both directions
};

/// The rule above. Throws InputError if `size` is not positive or exceeds the camera's image, if
/// the camera's images are prepared for another size, or have more than 32 766 pixels in a row or
/// column.
Decimation make_decimation(const CameraModel& camera, ImageSize size);

/// Intrinsics of the decimated image.
PinholeIntrinsics decimated_intrinsics(const CameraModel& camera, ImageSize size,
                                       const Decimation& decimation);

/// Immutable after construction; apply() may be called from several threads.
class ImagePreparation {
 public:
  /// Throws InputError if the size does not fit.
  ImagePreparation(const CameraModel& camera, ImageSize size);

  const PinholeIntrinsics& intrinsics() const { return intrinsics_; }

  /// The prepared image, row by row without padding. `full` has the camera's size, 8-bit grey.
  std::vector<std::uint8_t> apply(std::span<const std::uint8_t> full) const;

  /// For each pixel of the camera, row by row: whether apply() reads it (1) or not (0).
  std::vector<std::uint8_t> pixels_read() const;

  /// The camera that would have taken the prepared images: no distortion, `prepared` set.
  CameraModel prepared_camera() const;

 private:
  CameraModel camera_;
  PinholeIntrinsics intrinsics_;
  // Where each prepared pixel is in the camera's image, as cv::convertMaps() has it: the pixel
  // above and left of it (column, row), and an index of the fractions, in 1/32 px.
  using Corner = std::array<std::int16_t, 2>;
  std::vector<Corner> corners_;
  std::vector<std::uint16_t> fractions_;
};

}  // namespace leviosim::traces
