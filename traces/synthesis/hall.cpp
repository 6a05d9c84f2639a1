#include "traces/synthesis/hall.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "sim/base/parallel_for.h"
#include "traces/synthesis/hall_layout.h"
#include "traces/synthesis/painted_box.h"
#include "traces/datasets/rng.h"

namespace leviosim::traces {
namespace {

using Path = std::vector<Eigen::Vector3d>;

constexpr std::size_t kFaces = 6;
constexpr double kPathStepM = 0.05;
constexpr double kFinestTexelM = 0.005;
constexpr double kCoarsestTexelM = 0.016;
constexpr double kPatternDistanceM =
    1.5;  // at which the painter's patterns have their natural size
constexpr double kLargestPattern = 4;

constexpr std::array<SurfaceStyle, kFaces> kHallStyles{SurfaceStyle::plaster, SurfaceStyle::panels,
                                                       SurfaceStyle::bricks,  SurfaceStyle::plaster,
                                                       SurfaceStyle::planks,  SurfaceStyle::panels};
constexpr std::array<double, kFaces> kHallTones{95, 145, 170, 115, 90, 60};

/// Positions kPathStepM apart: the whole path is within that of one of them.
Path thinned(std::span<const Eigen::Vector3d> path) {
  Path result;
  for (const Eigen::Vector3d& position : path)
    if (result.empty() || (position - result.back()).norm() > kPathStepM)
      result.push_back(position);
  return result;
}

double distance(const Path& path, const Eigen::AlignedBox3d& surface) {
  double nearest = surface.exteriorDistance(path.front());
  for (const Eigen::Vector3d& position : path)
    nearest = std::min(nearest, surface.exteriorDistance(position));
  return nearest;
}

Eigen::AlignedBox3d face_of(const Box& box, std::size_t face) {
  Eigen::AlignedBox3d plate(box.min.cast<double>(), box.max.cast<double>());
  const auto axis = static_cast<Eigen::Index>(face / 2);
  const double at = face % 2 == 0 ? plate.min()[axis] : plate.max()[axis];
  plate.min()[axis] = plate.max()[axis] = at;
  return plate;
}

/// How a face must be painted for a path that comes this near.
SurfaceSpec spec_for(double distance_m, const CameraModel& camera, const HallOptions& options) {
  SurfaceSpec spec;
  spec.texel_m =
      options.texels * std::clamp(distance_m / camera.fx, kFinestTexelM, kCoarsestTexelM);
  spec.scale = std::clamp(distance_m / kPatternDistanceM, 1.0, kLargestPattern);
  return spec;
}

}  // namespace

World make_hall(std::span<const Eigen::Vector3d> path, const CameraModel& camera,
                const HallOptions& options) {
  const Path positions = thinned(path);
  const HallLayout layout =
      lay_out_hall(positions, options.clearance_m + kPathStepM, derive_seed(options.seed, 0));
  const auto box_of = [](const Eigen::AlignedBox3d& box, const std::array<float, 6>& light) {
    return unpainted_box(box.min().cast<float>(), box.max().cast<float>(), light);
  };
  Box room = box_of(layout.hall, kRoomLight);
  std::vector<Box> objects;
  for (const HallObject& object : layout.objects)
    objects.push_back(box_of(object.box, kObjectLight));
  base::parallel_for((1 + objects.size()) * kFaces, options.threads, [&](std::size_t job) {
    const std::size_t index = job / kFaces;
    const std::size_t face = job % kFaces;
    Box& box = index == 0 ? room : objects[index - 1];
    SurfaceSpec spec = spec_for(distance(positions, face_of(box, face)), camera, options);
    spec.style = index == 0 ? kHallStyles[face] : layout.objects[index - 1].style;
    spec.tone = index == 0 ? kHallTones[face] : layout.objects[index - 1].tone;
    spec.seed = derive_seed(options.seed, 1 + job);
    paint_face(box, face, spec);
  });
  return World(std::move(room), std::move(objects));
}

}  // namespace leviosim::traces
