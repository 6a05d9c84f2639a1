// What the user asked `leviosim run` to do, after the command line has been checked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform_models/loader/loader.h"
#include "sim/base/units.h"
#include "sim/soc/camera.h"
#include "sim/soc/simulation.h"
#include "tools/app/result/run_result.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_preparation.h"
#include "workload/vio/parameters.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

class RunObserver;  // simulate.h

using soc::CameraRequest;
using soc::Progress;
using soc::ProgressCallback;

struct WorkRecording;

/// Which times get bands (range_bands.h).
enum class TimeBandsOf : std::uint8_t {
  nothing,
  slowest_frame,  ///< which stands for all; on the thread of the run
  team,           ///< frames and stages
  team_and_one_core
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
  /// Whether the trajectory is compared with the truth. What diverged cannot be, and is refused.
  bool evaluate = true;
  TimeBandsOf time_bands = TimeBandsOf::nothing;
  bool on_one_core = true;             ///< whether jobs are also timed on one core
  RunObserver* observer = nullptr;     ///< sees every job; unused if native
  WorkRecording* recording = nullptr;  ///< gets every job, for a trace; unused if native
};

/// @throws InputError as profile_of()
void check_profile(const RunRequest& request);

/// The profile with the parameters that were set; of another workload only the name.
/// @throws InputError if parameters contradict each other, and for those of another workload
vio::Profile profile_of(const RunRequest& request);

// The options of `leviosim run` as typed, and what they ask for once checked.

struct RunOptions {
  std::string platform;
  std::string data;
  std::string profile{vio::default_profile()};
  std::string frames;
  std::string cores;
  std::string seed = "1";
  std::string size = "160x120";
  std::string camera_fps;
  std::string deadline;
  std::string initial_delay;
  bool online = false;  ///< no pose waits
  std::string out;
  std::vector<std::string> overrides;
  bool native = false;
  bool record = false;
  bool force = false;
  bool quiet = false;
  std::string tables;  ///< those to print in place of the summary
  bool json = false;   ///< print JSON
};

/// Declares the options on the subcommand.
void add_run_options(CLI::App& command, RunOptions& options);

/// What `leviosim run` takes where nothing is said: gap9, the synthetic flight, and a folder here
/// that is not there yet.
void set_run_defaults(RunOptions& options);

/// The same for commands that always run on a chip, with what they say by default: gap9 and the
/// synthetic flight. They declare --out themselves.
void add_chip_run_options(CLI::App& command, RunOptions& options);

/// Only those of the chip. @param by_default  added to the help of --platform
void add_chip_options(CLI::App& command, RunOptions& options, const std::string& by_default);

/// Those of commands that leave a folder with results.
void add_out_options(CLI::App& command, RunOptions& options);

/// Everything that can be checked without the data, whose folder is left for the caller to fill in.
/// @throws InputError naming the option
RunRequest make_request(const CLI::App& command, const RunOptions& options);
RunRequest make_chip_request(const RunOptions& options);

/// The number that --cores names, or by default that of the chip.
/// @throws InputError for more cores than the chip serves
int cores_of(const RunOptions& options, const sim::ClusterConfig& cluster);

/// Frames per second of a camera, within what sensor.yaml may say. @throws InputError
double parse_frame_rate(const std::string& text);
/// The closed loop that --fps and --deadline ask for, if one of them is given; the other
/// is then the recorded rate or `drop`. @throws InputError
std::optional<CameraRequest> parse_camera(const std::string& fps, const std::string& deadline);

/// "160x120". @throws InputError
traces::ImageSize parse_size(const std::string& text);

// --max-memory SIZE: what a work trace may take of the host's memory.

/// Declares the option. @param text  its value; empty if it is not given
void add_memory_option(CLI::App& command, std::string& text);

/// What the option allows: "512 MiB", "2GiB"; by default traces::kTraceMemory.
/// @throws InputError for what is no size or out of range
Bytes trace_memory(const std::string& text);

}  // namespace leviosim::tools
