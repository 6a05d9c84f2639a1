// `leviosim trajectory`: a trajectory in the format of other programs, on stdout.
#include <CLI/CLI.hpp>

#include <memory>
#include <string>

#include "sim/base/error.h"
#include "tools/app/cli/printout.h"
#include "tools/commands/commands.h"
#include "traces/trajectories/trajectory_file.h"

namespace leviosim::tools {
namespace {

struct TrajectoryOptions {
  std::string file;
  std::string times;
  std::string format = "tum";
};

void run(const CLI::App& command, const TrajectoryOptions& options) {
  require(command, "FILE", "a trajectory, or the folder of a run");
  traces::trajectory_text(options.format, {});  // refuses unknown formats
  traces::ReadOptions how;
  how.times = options.times;
  const traces::TrajectoryFile trajectory = traces::read_trajectory(options.file, how);
  if (trajectory.stamps == traces::Stamps::pose_number && options.format != "kitti")
    throw InputError(options.file +
                     ": has no time stamps (KITTI); expected a file with its times, --times FILE");
  print(Printout(traces::trajectory_text(options.format, trajectory.poses), true));
}

}  // namespace

Command add_trajectory_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("trajectory", "Print a trajectory in the format of other programs");
  const auto options = std::make_shared<TrajectoryOptions>();
  command->add_option("FILE", options->file,
                      "trajectory (TUM, EuRoC, KITTI), run folder, or ASL folder: its truth");
  const TextOptions add{*command};
  add("--as", options->format, "FORMAT", "tum, euroc, kitti or jsonl [tum]");
  add("--times", options->times, "FILE", "time stamps of a KITTI file, in seconds");
  add_examples(*command, {"leviosim trajectory recorded --as euroc >estimate.csv"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
