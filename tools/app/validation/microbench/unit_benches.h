// The programs behind the rows of tools/app/validation/published/gap9_units.csv, by name.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "sim/chip/config.h"
#include "tools/app/validation/microbench/microbench_row.h"

namespace leviosim::tools {

/// One program; what it measures is in the unit of its reference.
struct UnitBench {
  std::string_view name;
  double (*measure)(const sim::ChipConfig& chip, int cores);
};

/// Streams of instructions that share units, or run on one core.
std::span<const UnitBench> stream_benches();
/// Memories, caches, synchronisation and transfers.
std::span<const UnitBench> memory_benches();

/// Runs every program that has a reference on the chip.
/// @throws InputError if the reference file names a program that does not exist
std::vector<MicrobenchRow> unit_rows(const sim::ChipConfig& chip);

}  // namespace leviosim::tools
