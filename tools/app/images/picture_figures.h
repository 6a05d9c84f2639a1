// What an image is like in itself, without other images: light, contrast, noise, sharpness.
#pragma once

#include <optional>
#include <vector>

#include "traces/datasets/image_source.h"

namespace leviosim::tools {

struct PictureFigures {
  double brightness = 0;             ///< mean [grey levels]
  double contrast = 0;               ///< standard deviation [grey levels]
  double dark = 0;                   ///< share of the pixels below 20
  double glare = 0;                  ///< share of the pixels above 250
  std::vector<double> local;         ///< standard deviations in squares of 8x8 px
  std::optional<double> noise;       ///< of the smoothest squares [grey levels]
  std::optional<double> edge_width;  ///< of the strongest edges: step over steepest slope [px]
};

/// Noise: 3x3 differences to which planes give nothing (Immerkaer 1996), in squares of 8x8 px; the
/// lower tenth of those that are neither dark nor glaring.
PictureFigures picture_figures(const traces::GrayImage& image);

/// The value below which a share of the values lies, between two of them by a straight line; they
/// are sorted. There is at least one.
double quantile(std::vector<double>& values, double share);

}  // namespace leviosim::tools
