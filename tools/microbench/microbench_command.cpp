#include "tools/microbench/microbench_command.h"

#include <fmt/core.h>

#include <cstdlib>
#include <memory>

#include "platform_models/loader.h"
#include "tools/microbench/report.h"
#include "tools/microbench/unit_benches.h"
#include "traces/atomic_file.h"

namespace leviosim::tools {
namespace {

struct MicrobenchOptions {
  std::string platform = "gap9";
  std::vector<std::string> overrides;
  std::string out;
};

void run(const MicrobenchOptions& options) {
  const platform::ResolvedPlatform chip =
      platform::resolve_platform(options.platform, options.overrides);
  const std::vector<MicrobenchRow> rows = unit_rows(chip.config);
  fmt::print("{}", microbench_table(chip.name, rows));
  if (!options.out.empty()) traces::write_file_atomically(options.out, microbench_csv(rows));
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
  command->add_option("--out", options->out, "write the rows to a CSV file")->type_name("FILE");
  return {command, [=] { run(*options); }};
}

}  // namespace leviosim::tools
