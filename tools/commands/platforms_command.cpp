// `leviosim platforms`: which chips there are, and what is known about one.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "platform_models/loader/loader.h"
#include "platform_models/loader/new_platform.h"
#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/printable.h"
#include "sim/energy/area.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/html_report/page.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/report/area_table.h"
#include "tools/app/report/tables.h"
#include "tools/app/run/run_session.h"
#include "tools/app/run/workload_options.h"
#include "tools/app/table/terminal_table.h"
#include "tools/commands/chip_studies.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct PlatformsOptions : ChipStudyOptions {
  std::string action = "list";
  std::string from = "gap9";  ///< of a new chip
  bool yaml = false;
};

constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);
/// Options that some actions take.
constexpr std::array kOfSome{"--from",   "--data",  "--frames", "--profile", "--seed", "--csv",
                             "--report", "--force", "--quiet",  "--jobs",    "--yaml"};

void list(const PlatformsOptions& options) {
  const auto lines = [] {
    std::string text;
    for (const std::string& name : platform::platform_names())
      text +=
          fmt::format("{}: {}\n", name, printable(platform::resolve_platform(name).description));
    return Printout(text).ending(
        fmt::format("in short: {} chips", platform::platform_names().size()),
        {"leviosim platforms show gap9", "leviosim platforms feasibility"});
  };
  const auto document = [] {
    const Columns<std::string> table{
        {{.key = "name"}, [](const std::string& name) { return name; }},
        {{.key = "description"},
         [](const std::string& name) { return platform::resolve_platform(name).description; }}};
    return table_document("platforms", table_of(table, platform::platform_names()));
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

/// @param typed  their names on command lines
void diff(const platform::ResolvedPlatform& a, const platform::ResolvedPlatform& b,
          const std::vector<std::string>& typed, bool json) {
  const std::vector<Difference> all = differences(a, b);
  const auto lines = [&] {
    Table table({{"parameter", kLeft}, {a.name}, {b.name}});
    for (const Difference& d : all) table.add({d.path, in_words(d.a), in_words(d.b)});
    return Printout(all.empty() ? std::string() : terminal_text(table))
        .ending(fmt::format("in short: {} of {} parameters differ", all.size(),
                            std::max(a.parameters.size(), b.parameters.size())),
                {fmt::format("leviosim platforms stages {} {}", shell_word(typed[0]),
                             shell_word(typed[1]))});
  };
  const auto document = [&] {
    using D = Difference;
    const auto value = [](const platform::Parameter* p) {
      return p == nullptr ? std::string() : p->value;
    };
    const Columns<D> table{
        {{.key = "parameter"}, [](const D& d) { return d.path; }},
        {{.key = "a"}, [&](const D& d) { return spelled(value(d.a)); }},
        {{.key = "b"}, [&](const D& d) { return spelled(value(d.b)); }},
        {{.key = "unit"}, [](const D& d) { return d.a == nullptr ? d.b->unit : d.a->unit; }}};
    return table_document(fmt::format("differences of {} and {}", a.name, b.name),
                          table_of(table, all));
  };
  print(printout(json, lines, document));
}

std::string mm2(sim::SquareMicrometres area) { return fmt::format("{:.2f}", area.count() * 1e-6); }

Table rows_of(const std::vector<platform::Parameter>& parameters) {
  using P = platform::Parameter;
  const Columns<P> table{{{.key = "parameter"}, [](const P& p) { return p.path; }},
                         {{.key = "value"}, [](const P& p) { return spelled(p.value); }},
                         {{.key = "unit"}, [](const P& p) { return p.unit; }},
                         {{.key = "confidence"}, [](const P& p) { return p.confidence; }},
                         {{.key = "source"}, [](const P& p) { return p.source; }}};
  return table_of(table, parameters);
}

/// Parts with their bands, then the numbers that they follow from, with ranges and sources.
void area(const PlatformsOptions& options) {
  const platform::ResolvedPlatform chip =
      platform::resolve_platform(options.names[0], options.run.overrides);
  if (!sim::knows_area(chip.config))
    throw InputError(
        fmt::format("platforms area: {} has no areas (no source gives them); expected "
                    "a chip with the section area, such as gap9",
                    printable(chip.name)));
  std::vector<platform::Parameter> numbers;
  for (const platform::Parameter& p : chip.parameters)
    if (p.path.starts_with("area.") || p.path.ends_with(".area")) numbers.push_back(p);
  const auto lines = [&] {
    Table sources({{"number", kLeft},
                   {"value"},
                   {"range", kRight, 1},
                   {"confidence", kLeft, 1},
                   {"source", kLeft, 2}});
    for (const platform::Parameter& p : numbers)
      sources.add({p.path, in_words(&p),
                   p.range ? fmt::format("{:g}–{:g}", p.range->low, p.range->high) : "–",
                   p.confidence, printable(p.source)});
    const sim::AreaItem total = sim::total_area(chip.config);
    return Printout(
               {fmt::format("area of {}\n\n{}\n", printable(chip.name), area_table(chip.config)),
                terminal_text(sources)})
        .ending(fmt::format("in short: {} mm2 ({}–{})", mm2(total.area), mm2(total.low),
                            mm2(total.high)),
                {"leviosim whatif"});
  };
  print(printout(options.run.json, lines, [&] {
    return table_document("area of " + chip.name, area_rows(chip.config),
                          {{"numbers", rows_json(rows_of(numbers))}});
  }));
}

void show(const PlatformsOptions& options) {
  const platform::ResolvedPlatform chip =
      platform::resolve_platform(options.names[0], options.run.overrides);
  const auto document = [&] {
    return table_document("platform " + chip.name, rows_of(chip.parameters));
  };
  const auto lines = [&] {
    Table table({{"number", kLeft}, {"value"}, {"confidence", kLeft}, {"source", kLeft, 1}});
    for (const platform::Parameter& p : chip.parameters)
      table.add({p.path, in_words(&p), p.confidence, printable(p.source)});
    return Printout(fmt::format("{}: {}\n\n{}", printable(chip.name), printable(chip.description),
                                terminal_text(table)))
        .ending(fmt::format("in short: {} numbers, each with its source", chip.parameters.size()),
                {fmt::format("leviosim platforms show {} --yaml", shell_word(options.names[0]))});
  };
  if (options.yaml && !options.run.json)
    print(Printout(platform::to_yaml(chip), true));
  else
    print(printout(options.run.json, lines, document));
}

/// Changes are of the second: what a chip would differ in from itself can be asked too.
void show_differences(const PlatformsOptions& options) {
  diff(platform::resolve_platform(options.names[0]),
       platform::resolve_platform(options.names[1], options.run.overrides), options.names,
       options.run.json);
}

/// A file to begin a chip with, in this folder or where the name says.
void begin_new(const PlatformsOptions& options) {
  const std::string& wanted = options.names[0];
  // It stands in a comment of the file, too.
  if (printable(wanted) != wanted || wanted.empty())
    throw InputError(fmt::format("platforms new: '{}' has characters that no name has", wanted));
  const std::filesystem::path file = wanted.ends_with(".yaml") ? wanted : wanted + ".yaml";
  if (const auto known = platform::platform_names();
      std::find(known.begin(), known.end(), file.stem()) != known.end())
    throw InputError(
        fmt::format("platforms new: '{}' is a chip that is built in; expected another name",
                    file.stem().string()));
  outputs::OutputRequest request = out_request(options.run, "NAME");
  request.path = file.string();
  const platform::ResolvedPlatform from =
      platform::resolve_platform(options.from, options.run.overrides);
  request.inputs.emplace_back(options.from);
  std::optional<outputs::OutputFile> out = claimed_file(request);
  const std::string text = platform::new_platform(file.stem().string(), from, options.from);
  publish({{out, text, "platform"}}, printout(
                                         options.run.json, [] { return std::string(); },
                                         [&] {
                                           return table_document("platform " + file.stem().string(),
                                                                 rows_of(from.parameters));
                                         }));
}

struct Action {
  std::string name;
  std::size_t names;  ///< of platforms that it takes
  std::string expected;
  std::vector<std::string> options;  ///< that it takes, besides --set
  void (*run)(const PlatformsOptions&);
};

const std::array<Action, 8> kActions = {{
    {"list", 0, "no platform", {}, list},
    {"show", 1, "one platform", {"--yaml"}, show},
    {"new", 1, "a name for the new chip", {"--from", "--force"}, begin_new},
    {"diff", 2, "two platforms", {}, show_differences},
    {"area", 1, "one platform", {}, area},
    {"feasibility",
     kAnyNumber,
     "platforms",
     {"--data", "--frames", "--profile", "--seed", "--csv", "--force", "--quiet", "--jobs"},
     [](const PlatformsOptions& o) { time_feasibility(o); }},
    {"stages",
     kAnyNumber,
     "platforms",
     {"--data", "--frames", "--profile", "--seed", "--quiet", "--jobs"},
     [](const PlatformsOptions& o) { time_stages(o); }},
    {"systems",
     0,
     "no platform",
     {"--data", "--frames", "--seed", "--csv", "--report", "--force", "--quiet"},
     [](const PlatformsOptions& o) { predict_published_systems(o); }},
}};

void run(const CLI::App& command, const PlatformsOptions& options) {
  std::vector<std::string> known;
  for (const Action& action : kActions) known.push_back(action.name);
  const auto action = std::find_if(kActions.begin(), kActions.end(),
                                   [&](const Action& a) { return a.name == options.action; });
  if (action == kActions.end())
    throw InputError(fmt::format("platforms: unknown action '{}'; expected {}{}", options.action,
                                 fmt::join(known, ", "),
                                 base::did_you_mean(options.action, known)));
  if (action->names != kAnyNumber && options.names.size() != action->names)
    throw InputError(fmt::format("platforms {}: expected {}, found {}", action->name,
                                 action->expected, options.names.size()));
  for (const char* option : kOfSome)
    if (command.count(option) > 0 &&
        std::count(action->options.begin(), action->options.end(), option) == 0)
      throw InputError(fmt::format("platforms {}: {}; leave out {}", action->name,
                                   action->options.empty() ? "runs nothing" : "has no use for it",
                                   option));
  action->run(options);
}

}  // namespace

Command add_platforms_command(CLI::App& app, const Arguments&) {
  CLI::App* command = app.add_subcommand("platforms",
                                         "List the chips, show one with its sources, compare two, "
                                         "or ask what a workload takes on them");
  const auto options = std::make_shared<PlatformsOptions>();
  StudyOptions& run_options = options->run;
  run_options.data = "synthetic";
  command->add_option("ACTION", options->action,
                      "list (the default), show NAME, new NAME, diff NAME NAME, area NAME, "
                      "feasibility or stages [NAME ...], "
                      "systems");
  command->add_option("NAME", options->names, "chips: names or files");
  const TextOptions add_of_any{*command};
  add_of_any("-p,--set", run_options.overrides, "PATH=VALUE",
             "parameter of the chip shown, of the second one compared, or of all; repeatable");
  add_of_any("--from", options->from, "NAME|FILE",
             "new: chip whose values the new file begins with [gap9]");
  const char* const group = "With feasibility, stages and systems";
  const TextOptions add{*command, group};
  add("--data", run_options.data, "DIR|synthetic",
      "ASL/EuRoC folder, or the synthetic flight [synthetic]");
  add("--frames", run_options.frames, "A:B", "frames, B exclusive [all]");
  add("--profile", run_options.profile, "NAME", "profile of the workload [levio]; not of systems");
  add("--seed", run_options.seed, "N", "seed of the workload's random draws [1]");
  add("--csv", run_options.out, "FILE", "write the rows to a file; not of stages");
  add("--report", run_options.report, "FILE.html",
      "systems: page to write, with power over frame rate");
  command->add_flag("--force", run_options.force, "replace these files")->group(group);
  command->add_flag("--yaml", options->yaml, "show: the platform file, all of it");
  add_jobs_option(*command, run_options.runner.jobs, "chip");
  command->get_option("--jobs")->group(group);
  command->add_flag("--quiet", run_options.quiet, "no progress")->group(group);
  add_examples(*command,
               {"leviosim platforms", "leviosim platforms show gap9 -p cluster.workers=4",
                "leviosim platforms new mychip --from gap9", "leviosim platforms diff gap9 gap8",
                "leviosim platforms area gap9 -p cluster.fpu.units=8",
                "leviosim platforms feasibility gap9 cortex-m7 --data flight "
                "--csv chips.csv",
                "leviosim platforms stages gap9 gap9-eigen --data flight",
                "leviosim platforms systems --data flight --report systems.html"});
  add_json_option(*command, run_options.json);
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
