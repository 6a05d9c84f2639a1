// The result of a benchmark of flights as text, Markdown and JSON.
#pragma once

#include <string>

#include "tools/app/cli/screen.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/piece_figures.h"

namespace leviosim::tools {

/// A row for each variant, length, set and motion; below, what the figures are.
std::string benchmark_text(const Benchmark& benchmark, const BenchmarkResult& result,
                           int width = table_width());
/// The rows and the pieces.
Json benchmark_json(const Benchmark& benchmark, const BenchmarkResult& result);

}  // namespace leviosim::tools
