// leviosim budget: makes baselines and first budgets.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/nearest_name.h"
#include "tools/app/budget/budget.h"
#include "tools/app/budget/budget_edits.h"
#include "tools/app/budget/day.h"
#include "tools/app/budget/first_budget.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/printout.h"
#include "tools/app/record/record.h"
#include "tools/app/run/record_source.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

struct BudgetOptions : RecordOptions {
  std::string action;
  std::string run;
  GateOptions gate;
  std::string margin = "5 %";
  std::string slack = "2 %";
  std::vector<std::string> limits;
  std::string reason;
  std::string until;
};

/// The file of budgets as it would be, for people to review.
std::string edited(const CLI::App& command, const BudgetOptions& options) {
  require(command, "--budget", "the file of budgets to change");
  const std::string text = base::read_file(options.gate.budget, base::InputKind::budget);
  const Gate gate(options.gate, options);
  if (options.action == "tighten")
    return tightened(gate.budget(), text, read_record(options.run, options),
                     parse_share("--slack", options.slack));
  require(command, "--reason", "why the limit may be missed");
  require(command, "--until", "the last day, such as 2026-12-24");
  if (parse_day("--until", options.until) < today())
    throw InputError(
        fmt::format("--until '{}': is over; expected {} or a later day", options.until, today()));
  return with_accepted(text, gate.check(read_record(options.run, options)),
                       {.limits = options.limits,
                        .margin = parse_share("--margin", options.margin),
                        .reason = options.reason,
                        .until = options.until});
}

void run(const CLI::App& command, const BudgetOptions& options) {
  const std::vector<std::string> actions{"record", "init", "tighten", "accept"};
  require(command, "ACTION", fmt::format("{}", fmt::join(actions, ", ")));
  if (std::find(actions.begin(), actions.end(), options.action) == actions.end())
    throw InputError(fmt::format("budget: unknown action '{}'; expected {}{}", options.action,
                                 fmt::join(actions, ", "),
                                 base::did_you_mean(options.action, actions)));
  require(command, "RUN", "a run folder or a work trace");
  const double margin = parse_share("--margin", options.margin);
  if (options.action == "tighten" || options.action == "accept")
    return print(Printout(edited(command, options), true));
  std::optional<Budget> budget;
  if (!options.gate.budget.empty()) budget = read_budget(options.gate.budget);
  const RunRecord record = read_record(options.run, options);
  print(Printout(options.action == "init" ? first_budget(record, margin)
                                          : record_text(reduced(record, Level::kept,
                                                                budget ? figures_in(*budget, record)
                                                                       : std::set<std::string>())),
                 true));
}

}  // namespace

Command add_budget_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("budget", "Print a baseline of a run, or a budget that fits it");
  const auto options = std::make_shared<BudgetOptions>();
  command->add_option(
      "ACTION", options->action,
      "record: a baseline; init: a first budget; tighten: a budget whose limits lie near "
      "the run; accept: a budget whose missed limits are allowed until a day");
  command->add_option("RUN", options->run, "run folder, or a work trace to replay");
  add_gate_options(*command, options->gate);
  const TextOptions add{*command};
  add("--margin", options->margin, "PERCENT",
      "init, accept: distance of the new limits from the run's values [5 %]");
  add("--slack", options->slack, "PERCENT",
      "tighten: largest distance of a limit from the run's value [2 %]");
  command
      ->add_option("--limit", options->limits,
                   "accept: the limit that may be missed, by its title; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
  add("--reason", options->reason, "TEXT", "accept: reason, which the budget keeps");
  add("--until", options->until, "DATE", "accept: last day, such as 2026-12-24");
  add_record_options(*command, *options);
  add_examples(*command, {"leviosim budget record recorded >baseline.json",
                          "leviosim budget init recorded --margin '3 %' >first.yaml",
                          "leviosim budget tighten recorded --budget first.yaml >tighter.yaml"});
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
