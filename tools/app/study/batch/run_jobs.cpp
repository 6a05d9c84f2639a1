#include "tools/app/study/batch/run_jobs.h"

#include <mutex>

#include "sim/base/parallel_for.h"
#include "tools/app/cli/interrupts.h"

namespace leviosim::tools {

void run_jobs(const JobBatch& batch, const RunCache& cache, unsigned threads) {
  std::mutex mutex;
  traces::parallel_for(batch.keys.size(), threads, [&](std::size_t job) {
    throw_if_interrupted();
    std::optional<std::string> text = cache.find_text(batch.keys[job]);
    const bool found = text && batch.readable(*text);
    if (!found) {
      JobText computed = batch.compute(job);
      if (computed.keep) cache.store_text(batch.keys[job], computed.text);
      text = std::move(computed.text);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    batch.take(job, *text, found);
  });
}

}  // namespace leviosim::tools
