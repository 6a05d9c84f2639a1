// What a benchmark of flights says: its rows, pieces and runs as tables, and sentences about them.
#pragma once

#include <string>
#include <vector>

#include "tools/app/html_report/study_page.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/flights/benchmark.h"
#include "tools/app/study/flights/piece_figures.h"
#include "tools/app/study/point.h"
#include "tools/app/table/table.h"

namespace leviosim::tools {

/// A row for each variant, length, set, disturbance and motion. Percent of the path for pieces,
/// which differ in length; metres as well for whole flights. @param benchmark  outlives the tables
Table benchmark_rows(const Benchmark& benchmark, const BenchmarkResult& result);
/// A row for each variant and piece.
Table piece_rows(const Benchmark& benchmark, const BenchmarkResult& result);
/// A row for each run. @param runs  benchmark_runs()
Table benchmark_runs_table(const Benchmark& benchmark, const std::vector<Point>& runs,
                           const std::vector<RunOutcome>& outcomes, const Measure& how);

/// What the figures are; a line each.
std::string benchmark_notes(const Benchmark& benchmark, const BenchmarkResult& result,
                            const std::string& bullet);
/// Of each variant the worst median of all motions, in a sentence.
std::string benchmark_conclusion(const Benchmark& benchmark, const BenchmarkResult& result);

/// @param runs  benchmark_runs_table()
StudyPage benchmark_page(const Benchmark& benchmark, const BenchmarkResult& result, Table runs);

}  // namespace leviosim::tools
