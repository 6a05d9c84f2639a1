// Histories of runs: of each run that is read, there is a line already, or one can be written that
// is read again.
#include "tools/app/history/history.h"
#include "tools/app/history/history_report.h"

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leviosim;
  static fuzz::MemoryFile file("-history.jsonl");
  return fuzz::only_input_errors([&] {
    const tools::History history =
        tools::History::read(file.holding(fuzz::text_of(data, size)).string());
    std::vector<tools::PastRun> runs;
    for (std::size_t i = 0; i < history.size(); ++i) runs.push_back(history.run(i));
    if (runs.empty()) return;
    tools::history_document(runs);
    tools::history_page("title", runs, nullptr);
    for (const tools::PastRun& run : runs) {
      const std::string line = history.line_for(run);
      if (!line.empty() && tools::History("again", base::Pieces(line)).size() != 1) std::abort();
    }
  });
}
