#include "tools/commands/platforms_command.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include "platform_models/loader/loader.h"
#include "sim/base/csv_table.h"
#include "sim/base/error.h"
#include "sim/base/nearest.h"
#include "sim/base/printable_text.h"
#include "tools/app/cli/interrupts.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/report/table_document.h"
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

void list(const PlatformsOptions& options) {
  const auto lines = [] {
    std::string text;
    for (const std::string& name : platform::platform_names())
      text +=
          fmt::format("{}: {}\n", name, printable(platform::resolve_platform(name).description));
    return text;
  };
  const auto document = [] {
    const base::CsvTable<std::string> table{{"name", [](const std::string& name) { return name; }},
                                            {"description", [](const std::string& name) {
                                               return platform::resolve_platform(name).description;
                                             }}};
    return table_document("platforms", table.text(platform::platform_names()));
  };
  print(printout(options.run.json, lines, document));
}

std::string in_words(const platform::Parameter* parameter) {
  if (parameter == nullptr) return "–";
  return parameter->unit.empty() ? parameter->value
                                 : fmt::format("{} {}", parameter->value, parameter->unit);
}

/// A parameter of two chips; nullptr where one does not have it.
struct Difference {
  std::string path;
  const platform::Parameter* a;
  const platform::Parameter* b;
};

/// In the order of the schema.
std::vector<Difference> differences(const platform::ResolvedPlatform& a,
                                    const platform::ResolvedPlatform& b) {
  std::map<std::string, const platform::Parameter*> of_b;
  for (const platform::Parameter& parameter : b.parameters) of_b[parameter.path] = &parameter;
  std::vector<Difference> all;
  const auto compare = [&](const std::string& path, const platform::Parameter* left,
                           const platform::Parameter* right) {
    if (in_words(left) != in_words(right)) all.push_back({path, left, right});
  };
  for (const platform::Parameter& parameter : a.parameters) {
    const auto found = of_b.find(parameter.path);
    compare(parameter.path, &parameter, found == of_b.end() ? nullptr : found->second);
    if (found != of_b.end()) of_b.erase(found);
  }
  for (const platform::Parameter& parameter : b.parameters)
    if (of_b.count(parameter.path) > 0) compare(parameter.path, nullptr, &parameter);
  return all;
}

void diff(const platform::ResolvedPlatform& a, const platform::ResolvedPlatform& b, bool json) {
  const std::vector<Difference> all = differences(a, b);
  const auto lines = [&] {
    TextTable table({{"parameter", TextTable::Align::Left}, {a.name}, {b.name}});
    for (const Difference& d : all) table.add({d.path, in_words(d.a), in_words(d.b)});
    return fmt::format("{}{} of {} parameters differ\n", all.empty() ? "" : table.str(), all.size(),
                       std::max(a.parameters.size(), b.parameters.size()));
  };
  const auto document = [&] {
    using D = Difference;
    const auto value = [](const platform::Parameter* p) { return p == nullptr ? "" : p->value; };
    const base::CsvTable<D> table{
        {"parameter", [](const D& d) { return d.path; }},
        {"a", [&](const D& d) { return value(d.a); }},
        {"b", [&](const D& d) { return value(d.b); }},
        {"unit", [](const D& d) { return d.a == nullptr ? d.b->unit : d.a->unit; }}};
    return table_document(fmt::format("differences of {} and {}", a.name, b.name), table.text(all));
  };
  print(printout(json, lines, document));
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
  const auto lines = [&] {
    return fmt::format("{} on {}\n\n{}", run.profile, printable(run.data), feasibility_table(rows));
  };
  publish({{out, feasibility_csv(rows), "table"}}, printout(run.json, lines, [&] {
            return table_document("feasibility", feasibility_csv(rows));
          }));
}

void stages(const PlatformsOptions& options) {
  if (!options.run.out.empty())
    throw InputError("platforms stages: prints a table only; leave out --out");
  const std::vector<Feasibility> rows = rows_for(options, false);
  const auto lines = [&] {
    return fmt::format("{} on {}\n\n{}", options.run.profile, printable(options.run.data),
                       stage_comparison(rows));
  };
  const auto document = [&] { return table_document("stages", stage_comparison_csv(rows)); };
  print(printout(options.run.json, lines, document));
}

void show(const PlatformsOptions& options) {
  const platform::ResolvedPlatform chip =
      platform::resolve_platform(options.names[0], options.run.overrides);
  const auto document = [&] {
    using P = platform::Parameter;
    const base::CsvTable<P> table{{"parameter", [](const P& p) { return p.path; }},
                                  {"value", [](const P& p) { return p.value; }},
                                  {"unit", [](const P& p) { return p.unit; }},
                                  {"confidence", [](const P& p) { return p.confidence; }},
                                  {"source", [](const P& p) { return p.source; }}};
    return table_document("platform " + chip.name, table.text(chip.parameters));
  };
  print(printout(
      options.run.json, [&] { return platform::to_yaml(chip); }, document));
}

/// Changes are of the second: what a chip would differ in from itself can be asked too.
void show_differences(const PlatformsOptions& options) {
  diff(platform::resolve_platform(options.names[0]),
       platform::resolve_platform(options.names[1], options.run.overrides), options.run.json);
}

struct Action {
  std::string name;
  std::size_t names;  ///< of platforms that it takes
  std::string expected;
  void (*run)(const PlatformsOptions&);
};

const std::array<Action, 5> kActions = {{
    {"list", 0, "no platform", list},
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
  add_json_option(*command, run_options.json);
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
