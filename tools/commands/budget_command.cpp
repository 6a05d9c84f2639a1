#include "tools/commands/budget_command.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/nearest.h"
#include "tools/app/budget/baseline.h"
#include "tools/app/budget/first_budget.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/comparison/record_source.h"

namespace leviosim::tools {
namespace {

struct BudgetOptions : RecordOptions {
  std::string action;
  std::string run;
  std::string budget;
  std::string margin = "5 %";
};

void run(const CLI::App& command, const BudgetOptions& options) {
  const std::vector<std::string> actions{"record", "init"};
  require(command, "ACTION", "record or init");
  if (std::find(actions.begin(), actions.end(), options.action) == actions.end())
    throw InputError(fmt::format("budget: unknown action '{}'; expected record or init{}",
                                 options.action, base::did_you_mean(options.action, actions)));
  require(command, "RUN", "a run folder or a work trace");
  const double margin = parse_margin(options.margin);
  std::optional<Budget> budget;
  if (!options.budget.empty()) budget = read_budget(options.budget);
  const RunRecord record = read_record(options.run, options);
  print_result("{}", options.action == "init" ? first_budget(record, margin)
                                              : baseline_text(record, budget ? &*budget : nullptr));
}

}  // namespace

Command add_budget_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("budget", "Print a baseline of a run, or a first budget for it");
  const auto options = std::make_shared<BudgetOptions>();
  command->add_option("ACTION", options->action, "record: a baseline; init: a budget");
  command->add_option("RUN", options->run, "run folder, or a work trace to replay");
  command
      ->add_option("--budget", options->budget, "record also the statistics that its limits name")
      ->type_name("FILE");
  command->add_option("--margin", options->margin, "init: what limits leave [5 %]")
      ->type_name("PERCENT");
  add_record_options(*command, *options);
  add_examples(*command, {"leviosim budget record recorded >baseline.json",
                          "leviosim budget init recorded --margin '3 %' >first.yaml"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
