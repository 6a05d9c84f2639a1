// The synthetic flight: a textured room (world.h), a hand-held path through it (motion.h), EuRoC's
// camera and IMU (asl_writer.h), written as an ASL folder with exact ground truth. Licence-free
// input for tests and demos, and the one whose truth is known exactly.
//
// Streams of the flight, time 0 being `kFirstFrameNs`: frames at 0, 1/20 s, ... below the duration;
// IMU and ground truth at 200 Hz from one frame period before the first frame to the last frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/euroc_sensors.h"
#include "traces/datasets/imu_model.h"
#include "traces/synthesis/world.h"

namespace leviosim::traces {

/// Told after each written frame; calls come one at a time but from any thread.
using FlightProgress = std::function<void(std::size_t done, std::size_t total)>;

struct SyntheticOptions {
  static constexpr std::int64_t kFirstFrameNs = 1'000'000'000'000;

  std::uint64_t seed = 1;        ///< of textures, path, biases and noise
  double duration_s = 20;        ///< the first second is at rest
  bool imu_errors = true;        ///< noise and biases; false: a perfect IMU
  double image_noise = 1.2;      ///< standard deviation [grey levels]
  double texel_m = kRoomTexelM;  ///< of the room's textures; coarser paints faster
  unsigned threads = 0;          ///< 0: as many as the host has; the result does not depend on it
  bool overwrite = false;        ///< replace a flight that was written before (sim/base)
  bool repair = false;           ///< also if it was changed since: a cache
  CameraModel camera = euroc_cam0();
  ImuModel imu = euroc_imu0();
};

/// Writes `out_dir`/mav0/... The folder appears under its name only when complete. Throws
/// InputError for options out of range, if `out_dir` exists (unless overwrite) or holds anything
/// else, or if it cannot be written.
void write_synthetic_flight(const std::filesystem::path& out_dir,
                            const SyntheticOptions& options = {},
                            const FlightProgress& progress = {});

}  // namespace leviosim::traces
