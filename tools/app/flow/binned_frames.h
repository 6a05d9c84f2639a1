// Frames of a data set as the camera of the optical flow delivers them: k × k pixels of the sensor
// are one of the image (binning: their mean, rounded), and a square window in the middle is read
// out. Both are functions of the sensor (Aptina MT9V034, on PX4FLOW and in EuRoC's rig), so the
// chip has nothing to do with them. PX4FLOW bins 752×480 px by 4 and reads 64×64 of 188×120.
//
// Other cameras are binned so that some 120 rows remain. Lens distortion is taken out before, which
// the published camera does not do; in the window it is below a pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "traces/datasets/dataset.h"
#include "traces/datasets/image_source.h"

namespace leviosim::tools {

class BinnedFrames {
 public:
  /// @param side  of the window, px
  /// @throws InputError if the binned images are smaller
  BinnedFrames(const traces::Dataset& data, int side);

  int binning() const { return binning_; }
  /// Of the binned image, px; the mean of both axes.
  double focal_length() const;
  /// side × side grey levels. @throws InputError for images that cannot be read
  std::vector<std::uint8_t> read(std::size_t frame) const;

 private:
  traces::ImageSource source_;
  int side_;
  int binning_;
};

/// The middle of an image whose pixels are means of binning × binning ones.
std::vector<std::uint8_t> binned_window(const traces::GrayImage& image, int binning, int side);

}  // namespace leviosim::tools
