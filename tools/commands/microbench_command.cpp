#include "tools/commands/microbench_command.h"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <string_view>

#include "platform_models/loader/loader.h"
#include "tools/app/cli/limit_not_met.h"
#include "tools/app/cli/outputs.h"
#include "tools/app/cli/terminal.h"
#include "tools/app/report/table_document.h"
#include "tools/app/validation/microbench/board_kernels.h"
#include "tools/app/validation/microbench/report.h"
#include "tools/app/validation/microbench/unit_benches.h"

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

void run(const MicrobenchOptions& options) {
  const platform::ResolvedPlatform chip =
      platform::resolve_platform(options.platform, options.overrides);
  std::optional<outputs::OutputFile> out = claimed_file({.option = "--csv",
                                                         .path = options.csv,
                                                         .replace = options.force,
                                                         .inputs = {options.platform}});
  const bool is_board = chip.name == kBoard;
  std::vector<MicrobenchRow> rows;
  std::string tables;
  if (!is_board) {
    rows = unit_rows(chip.config);
    tables = microbench_table(printable(chip.name), rows) + '\n';
  }
  const std::vector<MicrobenchRow> board =
      board_rows(is_board ? chip.config : platform::load_platform("gap8"));
  tables += microbench_table(kBoard, board);
  rows.insert(rows.end(), board.begin(), board.end());
  publish({{out, microbench_csv(rows), ""}},
          printout(
              options.json, [&] { return tables; },
              [&] { return table_document("microbenchmarks", microbench_csv(rows)); }));
  if (std::any_of(rows.begin(), rows.end(),
                  [](const MicrobenchRow& row) { return row.verdict() == Verdict::Worse; }))
    throw LimitNotMet();
}

}  // namespace

Command add_microbench_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("microbench", "Compare small programs with measured hardware");
  const auto options = std::make_shared<MicrobenchOptions>();
  command->add_option("--platform", options->platform, "chip: a name or a file")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  command->add_option("-p,--set", options->overrides, "parameter of it; repeatable")
      ->type_name("PATH=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command->add_option("--csv", options->csv, "write the rows to a file")->type_name("FILE");
  command->add_flag("--force", options->force, "replace the file");
  add_examples(*command,
               {"leviosim microbench", "leviosim microbench --platform gap8 --csv board.csv"});
  add_json_option(*command, options->json);
  return {command, [=] { run(*options); }, {{"--out", "--csv"}}};
}

}  // namespace leviosim::tools
