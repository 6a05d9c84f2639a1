// What of the optical flow can be chosen.
//
// Source: Honegger, Meier, Tanskanen, Pollefeys, "An Open Source and Open Hardware Embedded Metric
// Optical Flow CMOS Camera for Indoor and Outdoor Applications", ICRA 2013: side of the image,
// blocks of 8×8 px, search range, half-pixel refinement. The thresholds are not part of that
// description; ours are of the order of the defaults that users of the camera know.
#pragma once

namespace leviosim::flow {

/// Side of a block, px.
inline constexpr int kBlock = 8;

struct Options {
  int side = 64;                ///< of the square image, px; a multiple of 4, at most kLargestSide
  int grid = 5;                 ///< blocks along either side, evenly spaced
  int search = 4;               ///< px to either side in which a block is looked for
  int min_texture = 30;         ///< grey levels, see texture(); strictly exceeded
  int max_difference = 3000;    ///< of a match, grey levels over the 64 px; strictly below
  int min_matches = 10;         ///< with fewer there is no flow and the quality is 0
  bool gyro = false;            ///< take off what the camera's rotation moves the image by
  float focal_length = 114.5f;  ///< px, used with gyro only

  static constexpr int kLargestSide = 256;
  static constexpr int kLargestSearch = 16;

  int blocks() const { return grid * grid; }
  /// Columns, or rows, that a block is looked for in.
  int candidates() const { return 2 * search + 1; }
  /// px that blocks keep from the edges: the search, and one more for half pixels.
  int margin() const { return search + 1; }
  /// @throws InputError naming the option, its value and what is allowed
  void validate() const;
};

}  // namespace leviosim::flow
