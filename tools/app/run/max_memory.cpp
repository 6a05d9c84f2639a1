#include "tools/app/run/max_memory.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>

#include "platform_models/loader/parameter_units.h"
#include "sim/base/error.h"
#include "tools/app/cli/command_line.h"
#include "traces/work_traces/memory_budget.h"
#include "traces/work_traces/work_memory.h"

namespace leviosim::tools {
namespace {

constexpr double kLeast = 1 << 20;

constexpr double kMost = 1024.0 * (1 << 30);

constexpr std::array kLargeUnits{platform::Unit{"GB", 1e9}, platform::Unit{"GiB", 1 << 30}};

/// In bytes; 0 for no unit of a size.
double factor_of(std::string_view unit) {
  if (const platform::Unit* known = platform::kSize.find(unit)) return known->factor;
  const auto large = std::find_if(kLargeUnits.begin(), kLargeUnits.end(),
                                  [&](const platform::Unit& u) { return u.name == unit; });
  return large == kLargeUnits.end() ? 0 : large->factor;
}

}  // namespace

void add_memory_option(CLI::App& command, std::string& text) {
  TextOptions{command}(
      "--max-memory", text, "SIZE",
      fmt::format("memory that a trace may take, such as 2GiB [{}]",
                  traces::memory_text(static_cast<std::uint64_t>(traces::kTraceMemory.count()))));
}

Bytes trace_memory(const std::string& text) {
  if (text.empty()) return traces::kTraceMemory;
  const auto measure = platform::split_measure(text);
  const double bytes = measure ? measure->number * factor_of(measure->unit) : 0;
  if (!(bytes >= kLeast && bytes <= kMost))
    throw InputError(
        fmt::format("--max-memory '{}': expected a size from 1 MiB to 1024 GiB in {}, GB or GiB, "
                    "such as 2GiB",
                    text, platform::kSize.unit_names()));
  return Bytes(static_cast<std::int64_t>(bytes));
}

}  // namespace leviosim::tools
