#include "tools/app/cli/welcome.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <utility>

#include "tools/app/cli/screen.h"

namespace leviosim::tools {
namespace {

struct Group {
  std::string title;
  std::vector<std::string> names;
};

std::vector<Group> groups_of(const std::vector<Command>& commands) {
  std::vector<Group> groups;
  for (const Command& command : commands) {
    const std::string title = command.app->get_group();
    auto at = std::find_if(groups.begin(), groups.end(),
                           [&](const Group& group) { return group.title == title; });
    if (at == groups.end()) at = groups.insert(at, Group{title, {}});
    at->names.push_back(command.app->get_name());
  }
  return groups;
}

constexpr int kNamesIndent = 2;

}  // namespace

std::string welcome(const std::vector<Command>& commands) {
  std::string text =
      "leviosim runs visual-inertial odometry on models of small multicore chips: the\n"
      "trajectory, cycles, energy and memory of every stage, and why it takes them.\n\n"
      "new here?   leviosim demo           a flight on GAP9 in a minute, and a what-if\n"
      "your data   leviosim run --platform gap9 --data DIR --record --out recorded\n"
      "then ask    leviosim whatif recorded\n";
  for (const auto& [title, names] : groups_of(commands))
    text += fmt::format("\n{}\n  {}\n", title, wrap(names, ", ", kNamesIndent, kScreenColumns));
  return text + "\noptions and examples: leviosim help COMMAND · all commands: leviosim --help\n";
}

}  // namespace leviosim::tools
