#include "tools/commands/platforms_command.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include "platform_models/loader/loader.h"
#include "sim/base/error.h"
#include "sim/base/nearest.h"
#include "tools/app/cli/interrupts.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/report/text_table.h"
#include "tools/app/run/run_session.h"
#include "tools/app/study/feasibility/feasibility_report.h"

namespace leviosim::tools {
namespace {

struct PlatformsOptions {
  std::string action = "list";
  std::vector<std::string> names;
  RunOptions run;  ///< of feasibility; the overrides are those of all actions
};

constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);
constexpr std::array kOfFeasibility{"--data", "--frames", "--profile", "--seed",
                                    "--out",  "--force",  "--quiet"};

void list() {
  for (const std::string& name : platform::platform_names())
    print_result("{}: {}\n", name, printable(platform::resolve_platform(name).description));
}

std::string in_words(const platform::Parameter* parameter) {
  if (parameter == nullptr) return "–";
  return parameter->unit.empty() ? parameter->value
                                 : fmt::format("{} {}", parameter->value, parameter->unit);
}

/// Parameters with their places in `a` and `b`, nullptr where one does not have them, in the order
/// of the schema.
void diff(const platform::ResolvedPlatform& a, const platform::ResolvedPlatform& b) {
  std::map<std::string, const platform::Parameter*> of_b;
  for (const platform::Parameter& parameter : b.parameters) of_b[parameter.path] = &parameter;
  TextTable table({{"parameter", TextTable::Align::Left}, {a.name}, {b.name}});
  int differences = 0;
  const auto compare = [&](const std::string& path, const platform::Parameter* left,
                           const platform::Parameter* right) {
    if (in_words(left) == in_words(right)) return;
    table.add({path, in_words(left), in_words(right)});
    ++differences;
  };
  for (const platform::Parameter& parameter : a.parameters) {
    const auto found = of_b.find(parameter.path);
    compare(parameter.path, &parameter, found == of_b.end() ? nullptr : found->second);
    if (found != of_b.end()) of_b.erase(found);
  }
  for (const platform::Parameter& parameter : b.parameters)
    if (of_b.count(parameter.path) > 0) compare(parameter.path, nullptr, &parameter);
  if (differences > 0) print_result("{}", table.str());
  print_result("{} of {} parameters differ\n", differences,
               std::max(a.parameters.size(), b.parameters.size()));
}

/// Computes the work and times it on the chips: on all workers of each, and, if `alone`, on one.
std::vector<Feasibility> rows_for(const PlatformsOptions& options, bool alone) {
  const RunOptions& run = options.run;
  const std::vector<std::string> names =
      options.names.empty() ? platform::platform_names() : options.names;
  RunOptions recording = run;
  recording.platform = "gap9";
  recording.overrides = {};
  RunRequest request = make_chip_request(recording);
  std::vector<platform::ResolvedPlatform> chips;
  for (const std::string& name : names)
    chips.push_back(platform::resolve_platform(name, run.overrides));
  std::vector<FeasibilityPoint> points;
  for (std::size_t i = 0; i < chips.size(); ++i) {
    const int workers = chips[i].config.cluster.workers;
    points.push_back({names[i], chips[i], workers});
    if (alone && workers > 1) points.push_back({names[i], chips[i], 1});
  }
  const ProgressLine::Style style = ProgressLine::style_of_stderr(run.quiet);
  request.data = data_folder(run, style);
  ProgressLine line(style);
  FeasibilityStudy study(request, [&](const Progress& p) {
    throw_if_interrupted();
    line.show(p.done, p.total,
              [&] { return frame_progress(p.done, p.total, p.simulated_ns, line.host_seconds()); });
  });
  return study.on(points, {.noun = "chip", .progress = style});
}

void feasibility(const PlatformsOptions& options) {
  const RunOptions& run = options.run;
  base::OutputRequest wanted = out_request(run);
  wanted.inputs.insert(wanted.inputs.end(), options.names.begin(), options.names.end());
  std::optional<base::OutputFile> out = claimed_file(wanted);
  const std::vector<Feasibility> rows = rows_for(options, true);
  publish({{out, feasibility_csv(rows), "table"}},
          fmt::format("{} on {}\n\n{}", run.profile, printable(run.data), feasibility_table(rows)));
}

void stages(const PlatformsOptions& options) {
  if (!options.run.out.empty())
    throw InputError("platforms stages: prints a table only; leave out --out");
  const std::vector<Feasibility> rows = rows_for(options, false);
  print_result("{} on {}\n\n{}", options.run.profile, printable(options.run.data),
               stage_comparison(rows));
}

void show(const PlatformsOptions& options) {
  print_result(
      "{}", platform::to_yaml(platform::resolve_platform(options.names[0], options.run.overrides)));
}

/// Changes are of the second: what a chip would differ in from itself can be asked too.
void show_differences(const PlatformsOptions& options) {
  diff(platform::resolve_platform(options.names[0]),
       platform::resolve_platform(options.names[1], options.run.overrides));
}

struct Action {
  std::string name;
  std::size_t names;  ///< of platforms that it takes
  std::string expected;
  void (*run)(const PlatformsOptions&);
};

const std::array<Action, 5> kActions = {{
    {"list", 0, "no platform", [](const PlatformsOptions&) { list(); }},
    {"show", 1, "one platform", show},
    {"diff", 2, "two platforms", show_differences},
    {"feasibility", kAnyNumber, "platforms", feasibility},
    {"stages", kAnyNumber, "platforms", stages},
}};

void run(const CLI::App& command, const PlatformsOptions& options) {
  std::vector<std::string> known;
  for (const Action& action : kActions) known.push_back(action.name);
  const auto action = std::find_if(kActions.begin(), kActions.end(),
                                   [&](const Action& a) { return a.name == options.action; });
  if (action == kActions.end())
    throw InputError(fmt::format(
        "platforms: unknown action '{}'; expected list, show, diff, feasibility or stages{}",
        options.action, base::did_you_mean(options.action, known)));
  if (action->names != kAnyNumber && options.names.size() != action->names)
    throw InputError(fmt::format("platforms {}: expected {}, found {}", action->name,
                                 action->expected, options.names.size()));
  if (action->names != kAnyNumber)
    for (const char* option : kOfFeasibility)
      if (command.count(option) > 0)
        throw InputError(
            fmt::format("platforms {}: runs nothing; leave out {}", action->name, option));
  action->run(options);
}

}  // namespace

Command add_platforms_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("platforms",
                                         "List the chips, show one with its sources, compare two, "
                                         "or ask what a workload takes on them");
  const auto options = std::make_shared<PlatformsOptions>();
  RunOptions& run_options = options->run;
  run_options.data = "synthetic";
  command->add_option(
      "ACTION", options->action,
      "list (the default), show NAME, diff NAME NAME, feasibility or stages [NAME ...]");
  command->add_option("NAME", options->names, "chips: names or files");
  command
      ->add_option("-p,--set", run_options.overrides,
                   "parameter of the one shown, of the second compared, or of all; repeatable")
      ->type_name("PATH=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    command->add_option(name, value, std::string("feasibility, stages: ") + help)->type_name(type);
  };
  add("--data", run_options.data, "DIR|synthetic",
      "ASL/EuRoC folder, or the synthetic flight [synthetic]");
  add("--frames", run_options.frames, "A:B", "frames, B exclusive [all]");
  add("--profile", run_options.profile, "NAME", "of the workload [levio]");
  add("--seed", run_options.seed, "N", "of the workload's random draws [1]");
  add("--out", run_options.out, "FILE", "CSV file to write");
  command->add_flag("--force", run_options.force, "feasibility: replace the file");
  command->add_flag("--quiet", run_options.quiet, "feasibility: no progress");
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
