// The commands of leviosim, one source each: it declares the options, calls what is in tools/app,
// and prints. What a command is for, and which files it leaves, stands at the head of its source.
#pragma once

#include "tools/app/cli/command_line.h"

namespace leviosim::tools {

/// Adds a command with its options to the program.
/// @param words  the whole command line, for manifests; must outlive the command
Command add_ablate_command(CLI::App& app, const Words& words);
Command add_benchmark_flights_command(CLI::App& app, const Words& words);
Command add_bisect_command(CLI::App& app);
Command add_budget_command(CLI::App& app);
Command add_calibrate_command(CLI::App& app);
Command add_check_command(CLI::App& app);
Command add_compare_command(CLI::App& app);
Command add_demo_command(CLI::App& app, const Words& words);
Command add_doctor_command(CLI::App& app);
Command add_eval_command(CLI::App& app);
Command add_explore_command(CLI::App& app, const Words& words);
Command add_flow_command(CLI::App& app, const Words& words);
Command add_history_command(CLI::App& app);
Command add_image_statistics_command(CLI::App& app);
Command add_microbench_command(CLI::App& app);
Command add_platforms_command(CLI::App& app);
Command add_replay_command(CLI::App& app, const Words& words);
Command add_report_command(CLI::App& app);
Command add_run_command(CLI::App& app, const Words& words);
Command add_sensitivity_command(CLI::App& app);
Command add_sweep_command(CLI::App& app);
Command add_synth_command(CLI::App& app);
Command add_trace_command(CLI::App& app);
Command add_trajectory_command(CLI::App& app);
Command add_tune_command(CLI::App& app, const Words& words);
Command add_validate_command(CLI::App& app, const Words& words);
Command add_whatif_command(CLI::App& app, const Words& words);
Command add_workload_command(CLI::App& app);

}  // namespace leviosim::tools
