// Guided matching: landmarks are looked for where a predicted pose puts them, instead of among all
// features. Each landmark in view takes the feature within a radius whose descriptor is nearest; a
// feature that several landmarks take goes to the nearest of them, the first of equals.
//
// Features are sorted into square cells first (counting sort, on the master), so that only the
// cells under the search circle are visited. Team forks: "search". The master settles who gets a
// contested feature.
#pragma once

#include "sim/work/machine.h"
#include "workload/math/vec.h"
#include "workload/vision/matcher.h"

namespace leviosim::vio {

/// Chosen on the rendered EuRoC flights (ACCURACY.md); the side of a cell decides the work only.
struct GuidedOptions {
  bool enabled = false;
  float radius_px = 8.0f;   ///< search radius around the predicted pixel [px]
  int max_distance = 50;    ///< Hamming distance that a match must be below, at most 255 [bits]
  int cell_px = 8;          ///< side of the grid cells in which features are looked up [px]
  float min_depth = 0.05f;  ///< least depth of a landmark in view [m]
};

/// Landmarks and the view that they are looked for in.
template <class P>
struct GuidedInput {
  template <class T>
  using Span = typename P::template Span<const T>;

  Span<typename P::F32> points;       ///< 3 per landmark, world frame, m
  Span<typename P::U32> descriptors;  ///< 8 words per landmark
  Span<typename P::Byte> ages;
  int landmarks = 0;
  int max_age = 0;  ///< older ones are left out
  Pose<P> T_camera_world{};
  PinholeCamera camera{};
  int width = 0, height = 0;  ///< px
  int steps = 1;              ///< feature coordinates are in units of 1/steps px
  bool in_l2 = false;  ///< points, descriptors and ages, which pass through local memory in tiles
};

/// 3 bytes per landmark, 4 per feature and 2 per cell of the image.
Bytes guided_memory(const GuidedOptions& options, int width, int height, int features,
                    int landmarks);

/// Fills `out` with features (query) and landmarks (reference), in the order of the features. It
/// needs room for every feature, or for every landmark. The caller opens the stage. Local memory
/// while it runs: guided_memory(), and tiles of the landmarks if they lie in L2.
template <class P>
void match_guided(work::Machine& machine, const GuidedInput<P>& input,
                  const FeatureList<P>& features, const GuidedOptions& options, MatchList<P>& out);

}  // namespace leviosim::vio
