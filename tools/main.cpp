// The leviosim command. Exit status: 0 if done, 2 for bad input, with one message on stderr, 130
// and 143 where it was interrupted. Faults of leviosim itself abort.
#include <fmt/core.h>

#include <filesystem>

#include "sim/error.h"
#include "tools/ablate/ablate_command.h"
#include "tools/calibrate/calibrate_command.h"
#include "tools/cli/interrupts.h"
#include "tools/cli/terminal.h"
#include "tools/cli/version.h"
#include "tools/eval/eval_command.h"
#include "tools/explore/explore_command.h"
#include "tools/flow/flow_command.h"
#include "tools/microbench/microbench_command.h"
#include "tools/platforms/platforms_command.h"
#include "tools/replay/replay_command.h"
#include "tools/replay/trace_command.h"
#include "tools/run/run_command.h"
#include "tools/run/workload_command.h"
#include "tools/sensitivity/sensitivity_command.h"
#include "tools/sweep/sweep_command.h"
#include "tools/synth/synth_command.h"
#include "tools/tune/tune_command.h"
#include "tools/validate/validate_command.h"

namespace leviosim::tools {
namespace {

constexpr int kBadInput = 2;
constexpr int kSignalled = 128;  // and its number; seen if the signal does not end the process

int fail(const std::exception& error) {
  print_error(error.what());
  return kBadInput;
}

int run_program(const Words& words) {
  CLI::App app("Runs visual-inertial odometry on models of ultra-low-power multicore chips.",
               "leviosim");
  app.set_version_flag("--version", fmt::format("leviosim {}", version()));
  try {
    const int status = run_command_line(
        app,
        {add_run_command(app, words), add_synth_command(app), add_platforms_command(app),
         add_workload_command(app), add_eval_command(app), add_ablate_command(app, words),
         add_explore_command(app, words), add_validate_command(app, words),
         add_calibrate_command(app), add_sensitivity_command(app), add_microbench_command(app),
         add_replay_command(app, words), add_trace_command(app), add_tune_command(app, words),
         add_sweep_command(app), add_flow_command(app, words)},
        words);
    flush_results();
    throw_if_interrupted();
    return status;
  } catch (const InputError& error) {
    return fail(error);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error);
  } catch (const Interrupted& stop) {
    return kSignalled + stop.signal();
  }
}

}  // namespace
}  // namespace leviosim::tools

int main(int argc, char** argv) {
  const leviosim::tools::DeferredInterrupts deferred;
  return leviosim::tools::run_program(leviosim::tools::Words(argv + 1, argv + argc));
}
