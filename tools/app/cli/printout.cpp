#include "tools/app/cli/printout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "sim/base/error.h"
#include "sim/base/printable.h"
#include "tools/app/cli/screen.h"

namespace leviosim::tools {

using Kind = ScreenPiece::Kind;

Printout Printout::ending(std::string sentence, std::vector<std::string> commands) && {
  conclusion = std::move(sentence);
  next = std::move(commands);
  return std::move(*this);
}

void add_json_option(CLI::App& command, bool& json) {
  command.add_flag("--json", json, "print JSON instead of text");
}

void print(const Printout& printout, const std::vector<ShownPath>& places) {
  if (!printout.conclusion.empty()) print_piece(Kind::kept, printout.conclusion + '\n');
  for (const std::string& part : printout.parts)
    print_piece(printout.is_all ? Kind::document : Kind::details, part);
  for (const ShownPath& place : places)
    if (!printout.is_whole)
      print_piece(Kind::kept, fmt::format("{}: {}\n", place.label, printable(place.path)));
  if (!printout.next.empty())
    print_piece(Kind::next, fmt::format("next: {}\n", fmt::join(printout.next, "\n      ")));
  print_piece(Kind::commands, printout.ci_commands);
}

void expect_json_or_budget(bool json, const std::string& budget) {
  if (json && !budget.empty())
    throw InputError(
        "--json and --budget both print to stdout; leave out one (leviosim check --json RUN)");
}

}  // namespace leviosim::tools
