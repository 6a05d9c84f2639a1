// `leviosim synth`: the synthetic flight as an ASL folder.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <limits>
#include <memory>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/printout.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/run_options.h"
#include "tools/commands/commands.h"
#include "traces/synthesis/place.h"
#include "traces/synthesis/rendered_flight.h"

namespace leviosim::tools {
namespace {

struct SynthOptions {
  std::string out;
  std::string motion;
  std::string seed = fmt::format("{}", kFlightSeed);
  std::string duration = fmt::format("{:g}", kFlightSeconds);
  std::string world;
  std::string size = "160x120";
  std::string imu;
  std::string frames;
  std::string motion_blur;
  bool full_size = false;
  bool illumination = false;
  bool overwrite = false;
  bool quiet = false;
};

constexpr auto kMotionOptions = {"--world",  "--size",        "--full-size",   "--imu",
                                 "--frames", "--motion-blur", "--illumination"};

std::uint64_t seed(const SynthOptions& options) {
  return static_cast<std::uint64_t>(
      parse_whole("--seed", options.seed, 0, std::numeric_limits<std::int64_t>::max()));
}

traces::ImuSource parse_imu(const std::string& text) {
  if (text.empty()) return traces::ImuSource::automatic;
  if (text == "real") return traces::ImuSource::recorded;
  if (text == "simulated") return traces::ImuSource::simulated;
  throw InputError(fmt::format("--imu '{}': expected real or simulated", text));
}

traces::RenderedFlightOptions rendered_options(const CLI::App& command,
                                               const SynthOptions& options) {
  if (command.count("--duration") > 0)
    throw InputError(
        "synth: with --motion the recording says how long; use --frames A:B for a part");
  if (!options.world.empty() && command.count("--seed") > 0)
    throw InputError("synth: --world has a seed, such as workshop:4; leave out --seed");
  if (options.full_size && command.count("--size") > 0)
    throw InputError("synth: --full-size writes the camera's images; leave out --size");
  traces::RenderedFlightOptions rendered;
  rendered.place.seed = seed(options);
  if (!options.world.empty()) rendered.place = traces::parse_place("--world", options.world);
  if (!options.full_size) rendered.prepared = parse_size(options.size);
  rendered.imu = parse_imu(options.imu);
  if (!options.frames.empty()) rendered.frames = {traces::parse_frame_range(options.frames)};
  if (!options.motion_blur.empty())
    rendered.exposure_s = 1e-3 * parse_positive("--motion-blur", options.motion_blur);
  rendered.illumination = options.illumination;
  rendered.overwrite = options.overwrite;
  return rendered;
}

/// @param has_size  the images are prepared for that size only
std::string after(const SynthOptions& options, bool has_size) {
  return fmt::format("leviosim run --data {}{} --record --out mine", shell_word(options.out),
                     has_size ? " --size " + options.size : "");
}

void render(const CLI::App& command, const SynthOptions& options) {
  const traces::RenderedFlightOptions rendered = rendered_options(command, options);
  render_flight(options.motion, options.out, rendered, "rendered flight",
                ProgressLine::style_of_stderr(options.quiet));
  const bool has_size = !options.full_size && options.size != SynthOptions().size;
  print(Printout(std::string()).ending("", {after(options, has_size)}),
        {{"rendered flight", options.out}});
}

void run(const CLI::App& command, const SynthOptions& options) {
  require(command, "--out", "a folder for the flight");
  if (!options.motion.empty()) return render(command, options);
  for (const char* option : kMotionOptions)
    if (command.count(option) > 0)
      throw InputError(fmt::format("synth: {} goes with --motion DIR", option));
  traces::SyntheticOptions flight;
  flight.seed = seed(options);
  flight.duration_s = parse_positive("--duration", options.duration);
  flight.overwrite = options.overwrite;
  write_flight(options.out, flight, ProgressLine::style_of_stderr(options.quiet));
  print(Printout(std::string()).ending("", {after(options, false)}),
        {{"synthetic flight", options.out}});
}

void add_motion_options(CLI::App& command, SynthOptions& options) {
  const TextOptions add{command, "With --motion"};
  add("--motion", options.motion, "DIR",
      "motion: flight along the ground truth of this ASL folder (images not needed)");
  add("--world", options.world, "KIND:N",
      "place and its seed: hall:1, workshop:1, or surfaces at a distance, 0.3m:1 [hall:1]");
  add("--size", options.size, "WxH",
      "size of the images, undistorted and decimated as by run [160x120]");
  command.add_flag("--full-size", options.full_size, "images of the camera's own size instead")
      ->group("With --motion");
  add("--imu", options.imu, "real|simulated",
      "IMU samples: recorded or simulated [real, if there are any]");
  add("--frames", options.frames, "A:B", "frames, B exclusive [all]");
  add("--motion-blur", options.motion_blur, "MS", "exposure time in milliseconds [none]");
  command.add_flag("--illumination", options.illumination, "light that drifts, and dark stretches")
      ->group("With --motion");
}

}  // namespace

Command add_synth_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("synth", "Make a flight: synthetic, or rendered along a recorded motion");
  const auto options = std::make_shared<SynthOptions>();
  const TextOptions add{*command};
  add("--out", options->out, "DIR", "folder, which becomes an ASL folder");
  add("--seed", options->seed, "N", "seed of world, path and noise [1]");
  add("--duration", options->duration, "S", "duration in seconds [20]");
  add_motion_options(*command, *options);
  command->add_flag("--force", options->overwrite, "replace a flight that was written before");
  command->add_flag("--quiet", options->quiet, "no progress");
  add_examples(*command, {"leviosim synth --duration 6 --out flight",
                          "leviosim synth --motion flight --frames 0:20 --out rendered"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
