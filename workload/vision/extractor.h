// Feature extraction, one stage of the cluster: FAST corners ranked by Harris response in cells,
// blur, orientation and descriptor (paper section III, "ORB"; PARAMETERS.md#feature-extraction).
//
// Three team forks, each sharing its items among the cores in equal contiguous shares: "detect"
// (cells), "blur" (rows), "describe" (features). Between the first two the master compacts the
// per-core slices of the keypoint list. Features come in the order of their cells, whatever the
// number of cores. Left out: an image pyramid; features are found at one scale.
#pragma once

#include "sim/work/machine.h"
#include "workload/vision/features.h"

namespace leviosim::vio {

/// Defaults: PARAMETERS.md#feature-extraction.
struct ExtractorOptions {
  int border = 16;              ///< px left out on every side; at least 15, the descriptor's reach
  int cell = 8;                 ///< side of a square cell, px
  int per_cell = 4;             ///< features kept per cell, 1 … kMostPerCell
  int fast_threshold = 20;      ///< grey levels, strictly exceeded
  int harris_threshold = 5000;  ///< response, strictly exceeded
  /// Where the cores read the pattern of point pairs: from a copy in the local memory (1 kB more,
  /// one transfer), or from L2, where the program image has it (a slow load per pair). The
  /// published occupation of L1, 64.0 kB, leaves about 300 bytes for tables: room for the others
  /// only.
  bool pattern_in_local_memory = false;

  /// Keypoints come in units of 1/subpixel_steps px, refined (subpixel.h) if that is more than 1.
  int subpixel_steps = 1;
  /// Of a refined keypoint, in each direction, px: one whose corner is farther stays in its pixel.
  /// Detected corners of one structure lie side by side (there is no non-maximum suppression), so
  /// the true one may be a pixel away. 0: all stay in the middle of their pixels.
  float max_corner_shift = 1.5f;

  static constexpr int kMostPerCell = 16;

  /// Cells along an image side of this many px; the last one may be cut.
  int cells_along(int side) const;
  /// How many features an image of this size can give: 704 for 160 × 120.
  int max_features(int width, int height) const;
  /// Local memory that extract_features() takes besides the features.
  Bytes memory_of_whole_image(int width, int height, int cores) const;
  /// @throws InputError naming the option, its value and what is allowed.
  void validate() const;
};

/// Extracts the features of an 8-bit image that lies in L2 and fits in local memory into `out`,
/// whose capacity must be at least options.max_features(). The caller opens the stage. Local memory
/// while it runs: the image, its blurred copy and small tables.
template <class P>
void extract_features(work::Machine& machine, ImageView<P> image_in_l2,
                      const ExtractorOptions& options, FeatureList<P>& out);

}  // namespace leviosim::vio
