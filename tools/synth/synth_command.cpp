#include "tools/synth/synth_command.h"

#include <fmt/core.h>

#include <limits>
#include <memory>

#include "tools/synth/flight_cache.h"

namespace leviosim::tools {
namespace {

struct SynthOptions {
  std::string out;
  std::string seed = fmt::format("{}", kFlightSeed);
  std::string duration = fmt::format("{:g}", kFlightSeconds);
  bool overwrite = false;
  bool quiet = false;
};

void run(const CLI::App& command, const SynthOptions& options) {
  require(command, "--out", "a folder for the flight");
  const std::int64_t seed =
      parse_whole("--seed", options.seed, 0, std::numeric_limits<std::int64_t>::max());
  const double seconds = parse_positive("--duration", options.duration);
  write_flight(std::filesystem::absolute(options.out).lexically_normal(),
               static_cast<std::uint64_t>(seed), seconds, options.overwrite,
               ProgressLine::style_of_stderr(options.quiet));
  fmt::print("synthetic flight: {}\n", options.out);
}

}  // namespace

Command add_synth_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("synth", "Make a synthetic flight with exact ground truth");
  const auto options = std::make_shared<SynthOptions>();
  command->add_option("--out", options->out, "folder, which becomes an ASL folder");
  command->add_option("--seed", options->seed, "of room, path and noise [1]");
  command->add_option("--duration", options->duration, "seconds [20]");
  command->add_flag("--overwrite", options->overwrite, "replace an existing ASL folder");
  command->add_flag("--quiet", options->quiet, "no progress");
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
