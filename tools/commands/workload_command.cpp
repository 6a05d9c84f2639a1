// `leviosim workload`: profiles of the workload, and its parameters with unit, range and value.
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/csv.h"
#include "tools/app/cli/printout.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/run/workload.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"
#include "tools/commands/commands.h"
#include "workload/vio/profile.h"

namespace leviosim::tools {
namespace {

struct WorkloadOptions {
  std::string profile{vio::default_profile()};
  bool json = false;
};

std::string range_text(const vio::Parameter& p) {
  return fmt::format("{} … {}", vio::value_text(p, p.low), vio::value_text(p, p.high));
}

std::vector<vio::Parameter> parameters_of(const WorkloadOptions& options) {
  std::vector<vio::Parameter> all;
  for (const vio::Parameter& p : vio::parameters())
    if (vio::has_parameter(options.profile, p)) all.push_back(p);
  return all;
}

double value_in(const vio::Profile& profile, const vio::Parameter& p) {
  return p.is_of_another() ? p.initial : p.get(profile);
}

std::string document(const WorkloadOptions& options, const vio::Profile& profile) {
  using P = vio::Parameter;
  const Columns<P> table{
      {{.key = "name"}, [](const P& p) { return p.name; }},
      {{.key = "value"},
       [&](const P& p) { return spelled(vio::value_text(p, value_in(profile, p))); }},
      {{.key = "low"}, [](const P& p) { return spelled(vio::value_text(p, p.low)); }},
      {{.key = "high"}, [](const P& p) { return spelled(vio::value_text(p, p.high)); }},
      {{.key = "unit"}, [](const P& p) { return p.unit; }},
      {{.key = "meaning"}, [](const P& p) { return p.description; }}};
  return table_document("parameters of " + options.profile,
                        table_of(table, parameters_of(options)));
}

Printout lines(const WorkloadOptions& options, const vio::Profile& profile) {
  std::string text = "profiles (--profile NAME)\n";
  for (const std::string& name : vio::profile_names())
    text += fmt::format("  {}: {}\n", name, vio::profile_description(name));
  Table table({{"parameter (-p NAME=VALUE)", kLeft},
               {"in " + options.profile},
               {"range", kLeft},
               {"unit", kLeft},
               {"meaning", kLeft}});
  for (const vio::Parameter& p : parameters_of(options))
    table.add({std::string(p.name), vio::value_text(p, value_in(profile, p)), range_text(p),
               std::string(p.unit), std::string(p.description)});
  return Printout({text + '\n', terminal_text(table)})
      .ending(fmt::format("in short: {} profiles, {} parameters of {}", vio::profile_names().size(),
                          vio::parameters().size(), options.profile),
              {fmt::format("leviosim run --profile {} -p workload.window=8 --out mine",
                           options.profile)});
}

void run(const WorkloadOptions& options) {
  const vio::Profile profile = vio::profile_named(options.profile, 1);
  print(printout(
      options.json, [&] { return lines(options, profile); },
      [&] { return document(options, profile); }));
}

}  // namespace

Command add_workload_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("workload", "List the profiles of the workload and its parameters");
  const auto options = std::make_shared<WorkloadOptions>();
  TextOptions{*command}("--profile", options->profile, "NAME",
                        fmt::format("whose values are shown [{}]", options->profile));
  add_examples(*command, {"leviosim workload", "leviosim workload --profile next"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
