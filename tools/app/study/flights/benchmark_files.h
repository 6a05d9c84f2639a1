// The files of a benchmark of flights: its runs and pieces as CSV, the manifest, and a page for a
// browser.
#pragma once

#include <vector>

#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/piece_figures.h"
#include "tools/app/study/point.h"

namespace leviosim::tools {

/// A row for each run. @param runs  benchmark_runs()
Table benchmark_runs_table(const Benchmark& benchmark, const std::vector<Point>& runs,
                           const std::vector<RunOutcome>& outcomes, const Measure& how);

/// The data of the page. @param runs  benchmark_runs_table()
Json benchmark_page(const Benchmark& benchmark, const BenchmarkResult& result, Table runs);

/// A row for each variant and piece.
Table piece_rows(const Benchmark& benchmark, const BenchmarkResult& result);
/// Of each variant the worst median of all motions, in a sentence.
std::string benchmark_conclusion(const Benchmark& benchmark, const BenchmarkResult& result);
std::string benchmark_markdown(const Benchmark& benchmark, const BenchmarkResult& result);

}  // namespace leviosim::tools
