// What the user asked `leviosim run` to do, after the command line has been checked.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "sim/soc/camera.h"
#include "sim/soc/simulation.h"
#include "traces/datasets/disturbance.h"
#include "traces/datasets/frame_range.h"
#include "traces/datasets/image_file.h"
#include "traces/datasets/picture_memory.h"
#include "workload/vio/parameters.h"

namespace leviosim::tools {

class RunObserver;  // simulate.h

using soc::CameraRequest;
using soc::Progress;
using soc::ProgressCallback;

struct WorkRecording;
class FilmWriter;

/// The times that get bands (range_bands.h).
enum class TimeBandsOf : std::uint8_t {
  nothing,
  slowest_frame,     ///< whose band stands for all frames; computed on the thread of the run
  team,              ///< frames and stages on N cores
  team_and_one_core  ///< and stages on one core
};

struct RunRequest {
  std::string data;  ///< ASL folder (the synthetic flight has been made)
  std::string profile{vio::default_profile()};
  std::optional<traces::FrameRange> frames;
  traces::Disturbance disturbance;  ///< of the data
  traces::ImageSize image_size{160, 120};
  bool native = false;  ///< no timing, any resolution
  int cores = 8;
  std::uint32_t seed = 1;                 ///< of the workload's random draws
  std::vector<vio::Assignment> workload;  ///< parameters that differ from the profile's
  std::vector<std::string> overrides;     ///< of the platform, as typed
  platform::ResolvedPlatform platform;    ///< unused if native
  /// The closed loop. Without, every recorded frame is delivered and waits until it is processed.
  std::optional<CameraRequest> camera;
  /// Whether the trajectory is compared with the truth. A trajectory that diverged is refused.
  bool evaluate = true;
  TimeBandsOf time_bands = TimeBandsOf::nothing;
  bool on_one_core = true;                          ///< whether jobs are also timed on one core
  RunObserver* observer = nullptr;                  ///< sees every job; unused if native
  std::shared_ptr<traces::PictureMemory> pictures;  ///< of a study, whose runs share frames
  WorkRecording* recording = nullptr;  ///< gets every job, for a trace; unused if native
  FilmWriter* film = nullptr;          ///< gets every frame; unused by other workloads
};

/// @throws InputError as profile_of()
void check_profile(const RunRequest& request);

/// The profile with the parameters that were set; of another workload only the name.
/// @throws InputError if parameters contradict each other, and for those of another workload
vio::Profile profile_of(const RunRequest& request);

}  // namespace leviosim::tools
