#include "tools/commands/workload_command.h"

#include <fmt/core.h>

#include <memory>

#include "tools/app/cli/terminal.h"
#include "tools/app/report/text_table.h"
#include "tools/app/run/workload_overrides.h"

namespace leviosim::tools {
namespace {

struct WorkloadOptions {
  std::string profile = "levio";
};

std::string range_text(const vio::Parameter& p) {
  return fmt::format("{} … {}", vio::value_text(p, p.low), vio::value_text(p, p.high));
}

void run(const WorkloadOptions& options) {
  const vio::Profile profile = vio::profile_named(options.profile, 1);
  std::string text = "profiles (--profile NAME)\n";
  for (const std::string& name : vio::profile_names())
    text += fmt::format("  {}: {}\n", name, vio::profile_description(name));
  TextTable table({{"parameter (-p NAME=VALUE)", kLeft},
                   {"in " + options.profile},
                   {"range", kLeft},
                   {"unit", kLeft},
                   {"meaning", kLeft}});
  for (const vio::Parameter& p : vio::parameters())
    table.add({std::string(p.name), vio::value_text(p, p.get(profile)), range_text(p),
               std::string(p.unit), std::string(p.description)});
  print_result("{}\n{}", text, table.str());
}

}  // namespace

Command add_workload_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("workload", "List the profiles of the workload and its parameters");
  const auto options = std::make_shared<WorkloadOptions>();
  command->add_option("--profile", options->profile, "whose values are shown [levio]")
      ->type_name("NAME");
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
