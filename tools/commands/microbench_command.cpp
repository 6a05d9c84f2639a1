// leviosim microbench: small programs on a chip beside what is known of the real one.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <string_view>

#include "platform_models/loader/loader.h"
#include "platform_models/loader/parameter_units.h"
#include "sim/base/printable.h"
#include "tools/app/cli/exit_status.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/printout.h"
#include "tools/app/record/statistic_list.h"
#include "tools/app/table/table_files.h"
#include "tools/app/validation/microbench/board_kernels.h"
#include "tools/app/validation/microbench/kernel_job.h"
#include "tools/app/validation/microbench/library_kernels.h"
#include "tools/app/validation/microbench/microbench_report.h"
#include "tools/app/validation/microbench/microbench_row.h"
#include "tools/app/validation/microbench/unit_benches.h"
#include "tools/commands/commands.h"

namespace leviosim::tools {
namespace {

/// The board's kernels were measured on this chip; units are compared on any other.
constexpr std::string_view kBoard = "GAP8";

struct MicrobenchOptions {
  std::string platform = "gap9";
  std::vector<std::string> overrides;
  std::string csv;
  bool force = false;
  bool json = false;
};

/// The chip as the one of the library's figures is, but for what the options say themselves.
platform::ResolvedPlatform sibling_of(const MicrobenchOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  const auto key_of = [](std::string_view set) {
    return platform::trim(set.substr(0, set.find('=')));
  };
  for (const std::string_view set : kLibraryChip) {
    const bool said =
        std::any_of(options.overrides.begin(), options.overrides.end(),
                    [&](const std::string& given) { return key_of(given) == key_of(set); });
    if (!said) overrides.emplace_back(set);
  }
  return platform::resolve_platform(options.platform, overrides);
}

void run(const MicrobenchOptions& options) {
  const platform::ResolvedPlatform chip =
      platform::resolve_platform(options.platform, options.overrides);
  std::optional<outputs::OutputFile> out = claimed_file({.option = "--csv",
                                                         .path = options.csv,
                                                         .replace = options.force,
                                                         .inputs = {options.platform}});
  const bool is_board = chip.name == kBoard;
  std::vector<MicrobenchRow> rows;
  std::vector<double> needed;
  std::vector<std::string> tables;
  const auto add = [&](std::string_view name, const std::vector<MicrobenchRow>& more) {
    tables.push_back(microbench_table(name, more) + '\n');
    rows.insert(rows.end(), more.begin(), more.end());
  };
  const auto add_needed = [&](const std::vector<KernelJob>& kernels,
                              const platform::Variants& platform) {
    for (const double factor : needed_instructions(kernels, platform)) needed.push_back(factor);
  };
  if (!is_board) {
    add(printable(chip.name), unit_rows(chip.config));
    const platform::Variants sibling(sibling_of(options));
    const std::vector<KernelJob> kernels = library_kernels(sibling.config({}));
    add("PULP-DSP", banded_rows(kernels, sibling));
    add_needed(kernels, sibling);
  }
  const platform::Variants board(is_board ? chip : platform::resolve_platform("gap8"));
  const std::vector<KernelJob> kernels = board_kernels(board.config({}));
  add(kBoard, board_rows(kernels, board));
  add_needed(kernels, board);
  std::sort(needed.begin(), needed.end());
  tables.push_back(coverage_text(rows, needed));
  publish({{out, csv_text(microbench_rows(rows)), ""}},
          printout(
              options.json,
              [&] {
                return Printout(tables).ending(microbench_conclusion(rows), {"leviosim validate"});
              },
              [&] { return table_document("microbenchmarks", microbench_rows(rows)); }));
  if (std::any_of(rows.begin(), rows.end(),
                  [](const MicrobenchRow& row) { return row.verdict() == Verdict::Worse; }))
    throw LimitNotMet();
}

}  // namespace

Command add_microbench_command(CLI::App& app, const Arguments&) {
  CLI::App* command =
      app.add_subcommand("microbench", "Compare small programs with measured hardware");
  const auto options = std::make_shared<MicrobenchOptions>();
  command->add_option("--platform", options->platform, "chip: a name or a file")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  const TextOptions add{*command};
  add("-p,--set", options->overrides, "PATH=VALUE", "parameter of it; repeatable");
  add("--csv", options->csv, "FILE", "write the rows to a file");
  command->add_flag("--force", options->force, "replace the file");
  add_examples(*command,
               {"leviosim microbench", "leviosim microbench --platform gap8 --csv board.csv"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
