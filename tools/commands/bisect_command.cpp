// leviosim bisect: whether the commit that is checked out meets a budget, as `git bisect run` asks.
#include "tools/commands/commands.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "sim/base/error.h"
#include "tools/app/budget/check.h"
#include "tools/app/budget/gate.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/outputs.h"

namespace leviosim::tools {
namespace {

/// What `git bisect run` reads: this commit cannot be tested, and stop altogether.
constexpr int kSkip = 125;
constexpr int kAbort = 128;

struct BisectOptions : RecordOptions {
  std::string run;
  GateOptions gate;
  std::vector<std::string> command;
};

/// What is wrong with the budget or the baseline is wrong for every commit.
Gate gate_of(const BisectOptions& options) {
  try {
    return {options.gate, options};
  } catch (const InputError& error) {
    print(Printout(fmt::format("{}\n", error.what()))
              .ending("verdict: none: bisecting stops here", {"git bisect reset"}));
    throw EndsWith(kAbort);
  }
}

[[noreturn]] void skip(const std::string& why) {
  print(Printout(std::string()).ending("verdict: skipped: " + why, {}));
  throw EndsWith(kSkip);
}

void run(const CLI::App& command, const BisectOptions& options) {
  require(command, "RUN", "the folder with a run that the command leaves");
  require(command, "--budget", "a file with limits (leviosim budget init writes a first one)");
  const Gate gate = gate_of(options);
  if (!options.command.empty())
    if (const int status = run_child(options.command); status != 0)
      skip(fmt::format("{} ended with status {}", options.command.front(), status));
  std::optional<CheckResult> result;
  try {
    result = gate.check(read_record(options.run, options));
  } catch (const InputError& error) {
    skip(error.what());
  }
  print(check_printout(*result, {}));
  if (result->missed() > 0) throw LimitNotMet();
}

}  // namespace

Command add_bisect_command(CLI::App& app, const Words&) {
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
  return {command, [=] { run(*command, *options); }};
}

}  // namespace leviosim::tools
