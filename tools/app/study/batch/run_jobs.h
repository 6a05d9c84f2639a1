// What all batches have in common: jobs on all cores of the host, each found again by its key if it
// has been done before, and kept as soon as it is finished.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/app/study/batch/run_cache.h"

namespace leviosim::tools {

/// What a job left.
struct JobText {
  std::string text;
  bool keep = true;  ///< in the cache
};

/// A batch as seen by run_jobs(). Jobs are numbered as their keys.
struct JobBatch {
  std::vector<std::string> keys;  ///< each once
  /// Whether what the cache holds can be read; asked by several threads.
  std::function<bool(const std::string& text)> readable;
  /// Called by several threads.
  std::function<JobText(std::size_t job)> compute;
  /// Called by one thread at a time, once per job, in the order in which they end.
  std::function<void(std::size_t job, const std::string& text, bool found)> take;
};

/// What is finished is in the cache and taken, whatever becomes of the rest.
/// @param threads  0: as many as the host has; nothing but the order of take() depends on it
/// @throws what compute() and take() throw, Interrupted
void run_jobs(const JobBatch& batch, const RunCache& cache, unsigned threads);

}  // namespace leviosim::tools
