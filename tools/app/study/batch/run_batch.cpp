#include "tools/app/study/batch/run_batch.h"

#include <algorithm>
#include <map>

#include "tools/app/cli/interrupts.h"
#include "tools/app/run/simulate.h"
#include "tools/app/study/batch/run_jobs.h"
#include "tools/app/study/batch/run_key.h"

namespace leviosim::tools {
namespace {

RunOutcome compute(const BatchRun& run, const Measure& how) {
  RunRequest request = run.request;
  request.evaluate = false;  // outcome_of() does, and takes note of what diverged
  const RunResult result = simulate(request, [](const Progress&) { throw_if_interrupted(); });
  return outcome_of(result, run.sequence->truth, how);
}

/// Runs of the same key, which are computed once.
struct Job {
  std::string key;
  std::vector<std::size_t> runs;
};

std::vector<Job> jobs_of(const std::vector<BatchRun>& runs, const Measure& how) {
  std::vector<Job> jobs;
  std::map<std::string, std::size_t> job_of_key;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    throw_if_interrupted();
    std::string key = run_key(runs[i].request, runs[i].sequence->inputs, how);
    const auto [it, is_new] = job_of_key.try_emplace(key, jobs.size());
    if (is_new) jobs.push_back({std::move(key), {}});
    jobs[it->second].runs.push_back(i);
  }
  return jobs;
}

}  // namespace

std::vector<RunOutcome> run_batch(const std::vector<BatchRun>& runs, const BatchOptions& options,
                                  const std::function<void(const BatchProgress&)>& progress) {
  const std::vector<Job> jobs = jobs_of(runs, options.measure);
  std::vector<RunOutcome> outcomes(runs.size());
  BatchProgress done{0, 0, runs.size()};
  JobBatch batch;
  for (const Job& job : jobs) batch.keys.push_back(job.key);
  batch.readable = [](const std::string& text) { return parse_outcome(text).has_value(); };
  batch.compute = [&](std::size_t j) {
    return JobText{to_text(compute(runs[jobs[j].runs.front()], options.measure))};
  };
  batch.take = [&](std::size_t j, const std::string& text, bool found) {
    const Job& job = jobs[j];
    const RunOutcome outcome = parse_outcome(text).value();
    for (const std::size_t i : job.runs) outcomes[i] = outcome;
    done.done += job.runs.size();
    if (found) done.found += job.runs.size();
    progress(done);
  };
  run_jobs(batch, options.cache, options.threads);
  return outcomes;
}

}  // namespace leviosim::tools
