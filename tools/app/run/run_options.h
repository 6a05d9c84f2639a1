// The options of `leviosim run` as typed, and what they ask for once checked.
#pragma once

#include <string>
#include <vector>

#include "sim/base/units.h"
#include "tools/app/run/run_request.h"

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
