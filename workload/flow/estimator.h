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

#include "workload/flow/options.h"

namespace leviosim::work {
class Machine;
}

namespace leviosim::flow {

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
