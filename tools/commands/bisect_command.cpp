// leviosim bisect: whether the commit that is checked out meets a budget, as `git bisect run` asks.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>

#include "sim/base/error.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/child_programs.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/printout.h"
#include "tools/app/record/measured.h"
#include "tools/app/run/record_source.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

/// What `git bisect run` reads: this commit cannot be tested. What is wrong for every commit is an
/// error, at which it stops (main_with.cpp).
constexpr int kSkip = 125;

struct BisectOptions : RecordOptions {
  std::string run;
  GateOptions gate;
  std::vector<std::string> command;
};

/// What is known before the first build. Of several sections, one may be for other chips.
void expect_baseline(const Gate& gate) {
  if (gate.baseline() != nullptr) return;
  const Limit* found = nullptr;
  for (const BudgetSection& section : gate.budget().sections) {
    const auto limit = std::find_if(section.limits.begin(), section.limits.end(),
                                    [](const Limit& l) { return l.bound.relative; });
    if (limit == section.limits.end()) return;
    found = &*limit;
  }
  fail_without_baseline(*found);
}

[[noreturn]] void skip(const std::string& why) {
  print(Printout(std::string()).ending("verdict: skipped: " + why, {}));
  throw EndsWith(kSkip);
}

RunRecord record_of(const BisectOptions& options) {
  try {
    return read_record(options.run, options);
  } catch (const InputError& error) {
    skip(error.what());
  }
}

void run(const CLI::App& command, const BisectOptions& options, bool ends_with_dashes) {
  require(command, "RUN", "the folder with a run that the command leaves");
  require(command, "--budget", "a file with limits (leviosim budget init writes a first one)");
  if (ends_with_dashes && options.command.empty())
    throw InputError("bisect: nothing stands after --; expected what builds and runs a commit");
  const Gate gate(options.gate, options);
  expect_baseline(gate);
  if (!options.platform.empty())
    (void)platform::resolve_platform(options.platform, options.overrides);
  if (!options.command.empty())
    if (const int status = run_child(options.command); status != 0)
      skip(fmt::format("{} ended with status {}", options.command.front(), status));
  print_check(gate.check(record_of(options)));
}

}  // namespace

Command add_bisect_command(CLI::App& app, const Arguments& words) {
  CLI::App* command = app.add_subcommand(
      "bisect", "For git bisect run: build and run a commit, check it against a budget");
  const auto options = std::make_shared<BisectOptions>();
  command->add_option("RUN", options->run,
                      "run folder that COMMAND leaves, or a work trace to replay");
  command->add_option(
      "COMMAND", options->command,
      "after --: what builds and runs the commit; if it fails, the commit is skipped");
  add_gate_options(*command, options->gate);
  add_record_options(*command, *options);
  add_examples(*command, {"leviosim bisect recorded --budget budgets.yaml -- true"});
  const bool ends_with_dashes = !words.empty() && words.back() == "--";
  return {command, [=] { run(*command, *options, ends_with_dashes); }};
}

}  // namespace leviosim::tools
