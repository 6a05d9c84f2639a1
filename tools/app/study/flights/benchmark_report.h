// The result of a benchmark of flights as text, Markdown and JSON.
#pragma once

#include <string>

#include "tools/app/report/statistic_list.h"
#include "tools/app/report/text_table.h"
#include "tools/app/study/flights/benchmark_rows.h"

namespace leviosim::tools {

/// A row for each variant, length, set and motion; below, what the figures are.
std::string benchmark_text(const Benchmark& benchmark, const BenchmarkResult& result,
                           int width = table_width());
/// Of each variant the worst median of all motions, in a sentence.
std::string benchmark_conclusion(const Benchmark& benchmark, const BenchmarkResult& result);
std::string benchmark_markdown(const Benchmark& benchmark, const BenchmarkResult& result);
/// The rows and the pieces.
Json benchmark_json(const Benchmark& benchmark, const BenchmarkResult& result);

}  // namespace leviosim::tools
