#include <fmt/format.h>

#include "sim/base/error.h"
#include "tools/app/validation/builtin_references.h"
#include "tools/app/validation/microbench/reference.h"
#include "tools/app/validation/microbench/unit_benches.h"

namespace leviosim::tools {
namespace {

constexpr std::string_view kUnitReferences = "gap9_units";
constexpr std::string_view kUnitGuards = "gap9_unit_guards";

const UnitBench& bench_named(const std::string& name) {
  for (const auto benches : {stream_benches(), memory_benches()})
    for (const UnitBench& bench : benches)
      if (bench.name == name) return bench;
  throw InputError(fmt::format("{}.csv: there is no program \"{}\"", kUnitReferences, name));
}

}  // namespace

std::vector<MicrobenchRow> unit_rows(const sim::ChipConfig& chip) {
  std::vector<MicrobenchRow> rows = reference_rows(fmt::format("{}.csv", kUnitReferences),
                                                   std::string(reference_text(kUnitReferences)), 1);
  for (MicrobenchRow& row : rows) row.simulated = bench_named(row.name).measure(chip, row.cores);
  take_guards(fmt::format("{}.csv", kUnitGuards), std::string(reference_text(kUnitGuards)), rows);
  return rows;
}

}  // namespace leviosim::tools
