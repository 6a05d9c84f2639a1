#include "tools/app/cli/printout.h"

#include "tools/app/cli/terminal.h"

namespace leviosim::tools {

void add_json_option(CLI::App& command, bool& json) {
  command.add_flag("--json", json, "print JSON instead of text");
}

void print(const Printout& printout) { print_result_text(printout.text); }

}  // namespace leviosim::tools
