// The indoor scene of the synthetic flight; see make_room() in world.h.
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "sim/base/parallel_for.h"
#include "traces/synthesis/painted_box.h"
#include "traces/datasets/rng.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {
namespace {

constexpr std::array<SurfaceStyle, 6> kRoomStyles{SurfaceStyle::plaster, SurfaceStyle::bricks,
                                                  SurfaceStyle::panels,  SurfaceStyle::plaster,
                                                  SurfaceStyle::planks,  SurfaceStyle::panels};

constexpr std::array<double, 6> kRoomTones{150, 105, 130, 140, 100, 95};

struct ObjectRow {
  std::array<float, 3> min, max;
  SurfaceStyle style;
  double tone;
};

constexpr SurfaceStyle kPlaster = SurfaceStyle::plaster;
constexpr SurfaceStyle kPlanks = SurfaceStyle::planks;
constexpr SurfaceStyle kBricks = SurfaceStyle::bricks;
constexpr SurfaceStyle kCrate = SurfaceStyle::crate;
constexpr SurfaceStyle kPanels = SurfaceStyle::panels;

constexpr std::array<ObjectRow, 24> kObjects{{
    // pillars
    {{2.70f, 1.70f, 0.0f}, {3.05f, 2.05f, 4.0f}, kBricks, 110},
    {{-3.00f, -2.30f, 0.0f}, {-2.65f, -1.95f, 4.0f}, kBricks, 130},
    {{1.70f, -2.75f, 0.0f}, {1.95f, -2.50f, 4.0f}, kPanels, 85},
    // +x side: cabinet with a box on it, a table with a crate
    {{3.40f, -1.20f, 0.0f}, {4.00f, 0.40f, 2.1f}, kPanels, 95},
    {{3.45f, -0.90f, 2.1f}, {3.90f, -0.40f, 2.5f}, kCrate, 140},
    {{2.70f, -2.60f, 0.70f}, {3.80f, -1.60f, 0.76f}, kPlanks, 150},
    {{2.80f, -2.45f, 0.0f}, {2.90f, -2.35f, 0.70f}, kPlaster, 60},
    {{3.60f, -1.80f, 0.0f}, {3.70f, -1.70f, 0.70f}, kPlaster, 60},
    {{3.00f, -2.30f, 0.76f}, {3.45f, -1.85f, 1.20f}, kCrate, 125},
    // +y side: stacked crates, a low cabinet, a thin board on the wall
    {{0.60f, 2.40f, 0.0f}, {1.45f, 3.00f, 0.85f}, kCrate, 130},
    {{0.72f, 2.48f, 0.85f}, {1.25f, 2.97f, 1.45f}, kCrate, 100},
    {{-1.70f, 2.50f, 0.0f}, {-0.60f, 3.00f, 1.55f}, kPanels, 120},
    {{-1.45f, 2.60f, 1.55f}, {-1.05f, 2.90f, 1.95f}, kCrate, 155},
    {{1.70f, 2.93f, 1.1f}, {2.60f, 3.00f, 2.1f}, kCrate, 165},
    // -x side: locker, bench with a back
    {{-4.00f, 1.00f, 0.0f}, {-3.40f, 2.00f, 2.2f}, kPanels, 75},
    {{-4.00f, -1.20f, 0.0f}, {-3.30f, 0.60f, 0.50f}, kPlanks, 140},
    {{-4.00f, -1.20f, 0.50f}, {-3.80f, 0.60f, 1.05f}, kPlanks, 115},
    {{-3.75f, -0.60f, 0.50f}, {-3.35f, -0.20f, 0.95f}, kCrate, 150},
    // -y side: workbench with boxes, a board on the wall
    {{-0.80f, -3.00f, 0.0f}, {0.90f, -2.40f, 0.75f}, kPlanks, 105},
    {{-0.55f, -2.85f, 0.75f}, {0.00f, -2.50f, 1.15f}, kCrate, 145},
    {{0.25f, -2.90f, 0.75f}, {0.65f, -2.55f, 1.50f}, kPanels, 70},
    {{-2.30f, -3.00f, 1.0f}, {-1.10f, -2.93f, 2.0f}, kCrate, 165},
    // under the ceiling
    {{-4.00f, 0.90f, 3.55f}, {4.00f, 1.15f, 3.85f}, kPlanks, 110},
    {{-4.00f, -1.40f, 3.55f}, {4.00f, -1.15f, 3.85f}, kPlanks, 120},
}};

Eigen::Vector3f vector(const std::array<float, 3>& corner) {
  return {corner[0], corner[1], corner[2]};
}

}  // namespace

World make_room(std::uint64_t seed, double texel_m, unsigned threads) {
  Box room = unpainted_box({-4, -3, 0}, {4, 3, 4}, kRoomLight);
  std::vector<Box> objects;
  for (const ObjectRow& row : kObjects)
    objects.push_back(unpainted_box(vector(row.min), vector(row.max), kObjectLight));

  constexpr std::size_t kFaces = 6;
  base::parallel_for((1 + kObjects.size()) * kFaces, threads, [&](std::size_t job) {
    const std::size_t index = job / kFaces;
    const std::size_t face = job % kFaces;
    SurfaceSpec spec;
    spec.style = index == 0 ? kRoomStyles[face] : kObjects[index - 1].style;
    spec.tone = index == 0 ? kRoomTones[face] : kObjects[index - 1].tone;
    spec.texel_m = texel_m;
    spec.seed = derive_seed(seed, job);
    paint_face(index == 0 ? room : objects[index - 1], face, spec);
  });
  return World(std::move(room), std::move(objects));
}

}  // namespace leviosim::traces
