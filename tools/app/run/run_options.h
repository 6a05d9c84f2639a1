// The options of `leviosim run` as typed, and what they ask for once checked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/soc/camera.h"
#include "tools/app/run/run_request.h"
#include "traces/datasets/image_file.h"
#include "workload/vio/parameters.h"

namespace CLI {
class App;
}

namespace leviosim::tools {

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
  bool film = false;
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
RunRequest make_request(const RunOptions& options);
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

}  // namespace leviosim::tools
