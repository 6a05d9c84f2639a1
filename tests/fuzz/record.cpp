// Records of runs, as files and as parts of lines. What is read at a level is written again as it
// was read, can be held against limits, and makes a page. After a first byte 'f' the input is a
// file of the cache of finished runs, under its key.
#include "tools/app/record/record.h"

#include "tests/fuzz/checked_run.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/app/budget/gate.h"
#include "tools/app/comparison/comparability.h"
#include "tools/app/html_report/page.h"
#include "tools/app/html_report/run_data.h"
#include "tools/app/study/accuracy_study.h"
#include "tools/app/study/outcome_cache.h"

namespace {

using namespace leviosim;  // NOLINT: a program of one file

void check_against(const tools::RunRecord& baseline) {
  static const tools::RunRecord run = fuzz::checked_run();
  static const tools::Budget budget =
      tools::parse_budget("budgets.yaml",
                          "budgets:\n"
                          "  - limits:\n"
                          "      - frame latency p99 <= -1 %\n"
                          "      - L1 peak <= -1 kB\n"
                          "      - ATE >= +1 m\n"
                          "      - stage: \"*\"\n"
                          "        limit: cycles <= -1 %\n"
                          "      - stages.*.memory.parallel <= -1 kB\n");
  tools::check_comparable(baseline, run, tools::parse_allowed("data,frames,profile,seed,size"));
  fuzz::report(tools::check_budget(run, budget, &baseline));
  tools::record_text(
      tools::reduced(baseline, tools::Level::kept, tools::figures_in(budget, baseline)));
}

void read(std::string_view text, tools::Level least) {
  const tools::RunRecord record = tools::parse_record("fuzzed", text, least);
  const std::string again = tools::record_text(record);
  if (tools::record_text(tools::parse_record("again", again, least)) != again) std::abort();
  tools::run_outcome_of(record);
  if (least == tools::Level::all) {
    tools::RunFolder folder{record, {}};
    folder.manifest["data"]["folder"] = "f";
    folder.manifest["command_line"] = tools::Json::array();
    tools::Json runs = tools::Json::array({tools::run_json(folder)});
    const std::string page = tools::script_json(tools::report_json("fuzzed", std::move(runs)));
    if (page.find("</") != std::string::npos) std::abort();
  }
  if (least == tools::Level::kept) check_against(record);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string key = "ab-fuzzed";
  static fuzz::MemoryFile file("-cache/ab/" + key + ".json");
  static const tools::OutcomeCache cache(file.path().parent_path().parent_path());
  if (size > 0 && data[0] == 'f') {
    file.holding(fuzz::text_of(data + 1, size - 1));
    return fuzz::only_input_errors([&] { cache.find(key); });
  }
  const std::string_view text = fuzz::text_of(data, size);
  int result = 0;
  for (const tools::Level least : {tools::Level::figures, tools::Level::kept, tools::Level::all})
    result |= fuzz::only_input_errors([&] { read(text, least); });
  return result;
}
