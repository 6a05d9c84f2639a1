#include "tools/platforms/platforms_command.h"

#include <fmt/core.h>

#include <memory>

#include "platform_models/loader.h"

namespace leviosim::tools {
namespace {

struct PlatformsOptions {
  std::string show;
  std::vector<std::string> overrides;
};

void run(const PlatformsOptions& options) {
  if (!options.show.empty()) {
    fmt::print("{}",
               platform::to_yaml(platform::resolve_platform(options.show, options.overrides)));
    return;
  }
  for (const std::string& name : platform::platform_names())
    fmt::print("{}: {}\n", name, platform::resolve_platform(name).description);
}

}  // namespace

Command add_platforms_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("platforms", "List the chips, or show one with its sources");
  const auto options = std::make_shared<PlatformsOptions>();
  command->add_option("--show", options->show, "print one, resolved")->type_name("NAME|FILE");
  command->add_option("-p,--set", options->overrides, "parameter of it; repeatable")
      ->type_name("PATH=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
