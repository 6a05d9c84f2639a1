#include "tools/platforms/platforms_command.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>

#include "platform_models/loader.h"
#include "platform_models/nearest.h"
#include "sim/error.h"
#include "tools/run/text_table.h"

namespace leviosim::tools {
namespace {

struct PlatformsOptions {
  std::string action = "list";
  std::vector<std::string> names;
  std::vector<std::string> overrides;
};

void list() {
  for (const std::string& name : platform::platform_names())
    fmt::print("{}: {}\n", name, platform::resolve_platform(name).description);
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
  if (differences > 0) fmt::print("{}", table.str());
  fmt::print("{} of {} parameters differ\n", differences,
             std::max(a.parameters.size(), b.parameters.size()));
}

struct Action {
  std::string name;
  std::size_t names;  ///< of platforms that it takes
  std::string expected;
};

const std::array<Action, 3> kActions = {{
    {"list", 0, "no platform"},
    {"show", 1, "one platform"},
    {"diff", 2, "two platforms"},
}};

void run(const PlatformsOptions& options) {
  std::vector<std::string> known;
  for (const Action& action : kActions) known.push_back(action.name);
  const auto action = std::find_if(kActions.begin(), kActions.end(),
                                   [&](const Action& a) { return a.name == options.action; });
  if (action == kActions.end())
    throw InputError(fmt::format("platforms: unknown action '{}'; expected list, show or diff{}",
                                 options.action, platform::did_you_mean(options.action, known)));
  if (options.names.size() != action->names)
    throw InputError(fmt::format("platforms {}: expected {}, found {}", action->name,
                                 action->expected, options.names.size()));
  if (action->names == 0) return list();
  std::vector<platform::ResolvedPlatform> chips;
  // Changes are of the last: what a chip would differ in from itself can be asked too.
  for (std::size_t i = 0; i < options.names.size(); ++i)
    chips.push_back(platform::resolve_platform(options.names[i], i + 1 == options.names.size()
                                                                     ? options.overrides
                                                                     : std::vector<std::string>{}));
  if (action->names == 1)
    fmt::print("{}", platform::to_yaml(chips.front()));
  else
    diff(chips.front(), chips.back());
}

}  // namespace

Command add_platforms_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("platforms", "List the chips, show one with its sources, or compare two");
  const auto options = std::make_shared<PlatformsOptions>();
  command->add_option("ACTION", options->action,
                      "list (the default), show NAME, or diff NAME NAME");
  command->add_option("NAME", options->names, "chips: names or files");
  command
      ->add_option("-p,--set", options->overrides,
                   "parameter of the one shown, or of the second compared; repeatable")
      ->type_name("PATH=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
