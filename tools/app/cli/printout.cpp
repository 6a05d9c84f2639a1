#include "tools/app/cli/printout.h"

#include <CLI/CLI.hpp>

#include "sim/base/error.h"
#include "tools/app/cli/terminal.h"

namespace leviosim::tools {

void add_json_option(CLI::App& command, bool& json) {
  command.add_flag("--json", json, "print JSON instead of text");
}

void print(const Printout& printout) {
  print_result_text(printout.text);
  print_ci_commands(printout.ci_commands);
}

void expect_json_or_budget(bool json, const std::string& budget) {
  if (json && !budget.empty())
    throw InputError(
        "--json and --budget both print to stdout; leave out one (leviosim check --json RUN)");
}

}  // namespace leviosim::tools
