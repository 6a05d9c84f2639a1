// The result of a benchmark of flights as text, Markdown and JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/app/report/statistic_list.h"
#include "tools/app/report/text_table.h"
#include "tools/app/study/batch_plan.h"
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

// The files of a benchmark of flights: its runs and pieces as CSV, the manifest, and a page for a
// browser.

/// A row for each variant and piece.
std::string pieces_csv(const Benchmark& benchmark, const BenchmarkResult& result);
/// A row for each run. @param runs  benchmark_runs()
std::string benchmark_runs_csv(const Benchmark& benchmark, const std::vector<Point>& runs,
                               const std::vector<RunOutcome>& outcomes, const Measure& how);

/// The content of manifest.json. Nothing in it depends on the host or on what was found in caches.
Json benchmark_manifest(const Benchmark& benchmark, const Measure& how, const Words& command_line);

/// The data of the page. @param csv  benchmark_runs_csv()
Json benchmark_page(const Benchmark& benchmark, const BenchmarkResult& result,
                    const std::string& csv);

}  // namespace leviosim::tools
