// Optical flow of a downward camera as PX4FLOW computes it: how
// the picture moved between two frames, from blocks that are looked for in the next frame.
//
//   image transfer     DMA of the new image into local memory; the one before is there still
//   feature selection  blocks with enough texture                        (fork over blocks)
//   block matching     the best candidate in each row of the search      (fork over rows)
//                      the best row, and half pixels                     (fork over blocks)
//   flow vote          histogram, mean, gyro                             (master)
//
// Rows of the search are shared, not whole blocks: 25 blocks on eight cores could gain 6.25 at
// most, 225 rows 7.76. Results do not depend on the number of cores.
// Left out: the distance sensor (metric flow), the low-pass over frames, rotation about the view.
#pragma once

#include <cstdint>
#include <memory>

namespace leviosim::work {
class Machine;
}

namespace leviosim::flow {

// What of the optical flow can be chosen.
//
// Source: Honegger, Meier, Tanskanen, Pollefeys, "An Open Source and Open Hardware Embedded Metric
// Optical Flow CMOS Camera for Indoor and Outdoor Applications", ICRA 2013: side of the image,
// blocks of 8×8 px, search range, half-pixel refinement. The thresholds are not part of that
// description; ours are of the order of the defaults that users of the camera know.

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

struct Input {
  const std::uint8_t* pixels = nullptr;  ///< side × side grey levels, row by row, in L2
  float rate_x = 0,
        rate_y = 0;  ///< mean since the frame before, camera frame (x right, y down) [rad/s]
  float dt = 0;      ///< since the frame before [s]
};

/// Of the picture since the frame before: +x right, +y down.
struct Flow {
  int x = 0, y = 0;  ///< 1/256 px
  int quality = 0;   ///< matched blocks of all, 0 … 255; 0: there is no flow
  int textured = 0;  ///< blocks with enough texture
  int matched = 0;   ///< of these, with a match
};

inline constexpr const char* kStages[] = {"image transfer", "feature selection", "block matching",
                                          "flow vote"};

class Estimator {
 public:
  virtual ~Estimator() = default;
  /// The first frame has no flow.
  virtual Flow process(const Input& input) = 0;
};

/// @param counting  whether on counted scalars, which give the same flow
/// @param machine   keeps the two images in its local memory; outlives the estimator
/// @throws InputError for options that cannot be, or a memory that does not hold the images
std::unique_ptr<Estimator> make_estimator(bool counting, const Options& options,
                                          work::Machine& machine);

}  // namespace leviosim::flow
