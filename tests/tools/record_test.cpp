// The record of a run: one form at three levels, which one function writes and one reads.
#include "tools/app/record/record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <regex>
#include <set>

#include "sim/base/input_file.h"
#include "tests/support/paths.h"
#include "tests/tools/example_run.h"
#include "tests/traces/test_folder.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using traces::testing::expect_input_error;

RunRecord example_record() {
  Manifest manifest;
  manifest.platform = "gap9";
  manifest.inputs = {{"cam0/data.csv", 1, "abc"}};
  RunRecord record = make_record("run", manifest, testing::example_run());
  record.cycles = {{"feature extraction",
                    false,
                    2e6,
                    {{"detect", "issue", "int_alu", 1.5e6 + 0.25, 1e6},
                     {"detect", "issue", "call", 1, 1},
                     {"", "fpu", "", 5e5, 0}}}};
  return record;
}

TEST(Record, ComesBackAsItWasAtEveryLevel) {
  for (const Level level : {Level::figures, Level::kept, Level::all}) {
    const RunRecord written = reduced(example_record(), level);
    const std::string text = record_text(written);
    EXPECT_EQ(record_text(parse_record("r", text, level)), text);
    EXPECT_EQ(record_json(record_of_json("r", record_json(written), level)), record_json(written));
  }
}

TEST(Record, ALevelHoldsWhatTheLowerOnesDo) {
  const RunRecord all = example_record();
  for (const Level level : {Level::figures, Level::kept}) {
    const RunRecord less = reduced(all, level);
    EXPECT_LT(less.statistics.size(), all.statistics.size());
    EXPECT_FALSE(less.statistics.empty());
    for (const Statistic& s : less.statistics) EXPECT_EQ(s.value, all.value(s.name)) << s.name;
  }
  EXPECT_TRUE(reduced(all, Level::kept, {"trajectory.length"}).value("trajectory.length"));
  EXPECT_EQ(record_json(reduced(all, Level::figures)).size(), 1u) << "statistics alone";
  const StageParts kept = reduced(all, Level::kept).cycles.front();
  double sum = 0;
  for (const CyclePart& part : kept.parts) {
    EXPECT_EQ(part.cycles, std::round(part.cycles)) << part.mechanism;
    sum += part.cycles;
  }
  EXPECT_EQ(sum, kept.cycles);
}

TEST(Record, TooLittleForALevelIsRefused) {
  const std::string figures = record_text(reduced(example_record(), Level::figures));
  expect_input_error([&] { parse_record("r", figures, Level::kept); }, {"r: ", "does not hold"});
  RunRecord untimed = example_record();
  untimed.cycles.clear();
  expect_input_error([&] { reduced(untimed, Level::kept); }, {"run: was not timed"});
}

TEST(Record, FilesOfBeforeAreRefusedWithWhatToDo) {
  expect_input_error(
      [] { parse_record("b.json", R"({"format":"leviosim baseline","version":1})", Level::kept); },
      {"b.json", "budget record"});
  expect_input_error(
      [] { parse_record("s.json", R"({"format":"leviosim statistics"})", Level::all); },
      {"s.json", "run.json"});
  const traces::testing::TempFolder folder;
  outputs::write_file_atomically(folder / "stats.json", "{}");
  expect_input_error([&] { read_run_folder(folder.path(), false); }, {"run it again"});
}

TEST(Record, HasABoundedNumberOfStages) {
  RunRecord record = reduced(example_record(), Level::all);
  record.stages.assign(1001, {"s", "s", false});
  expect_input_error([&] { parse_record("r", record_text(record), Level::all); }, {"r: "});
}

/// Files of the tools in which a pattern occurs.
std::set<std::string> files_with(const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(tests::source_folder() / "tools")) {
    const std::string kind = entry.path().extension().string();
    if ((kind == ".cpp" || kind == ".h") &&
        std::regex_search(base::read_text_file(entry.path()), regex))
      found.insert(fs::relative(entry.path(), tests::source_folder() / "tools").string());
  }
  return found;
}

/// Forms of a run on disk: one. What reads or writes parts of a record by their names is the record
/// itself; lines of files hold it as a whole.
TEST(Record, HasOneReaderAndOneWriter) {
  using Files = std::set<std::string>;
  EXPECT_EQ(files_with(R"re(\.at\("(statistics|facts|verdicts|stages|parts)"\))re"),
            Files{"app/record/record.cpp"});
  EXPECT_EQ(files_with(R"re(json\["(statistics|verdicts|facts|parts)"\] = )re"),
            (Files{"app/record/record.cpp", "app/html_report/run_data.cpp"}))
      << "the scripts of a page get facts";
  EXPECT_EQ(files_with("parse_record\\(|record_of_json\\("),
            (Files{"app/record/record.h", "app/record/record.cpp", "app/run/run_folder.cpp",
                   "app/budget/gate.h", "app/budget/gate.cpp", "app/history/history.cpp",
                   "app/study/outcome_cache.cpp", "app/study/sweep/sweep_store.cpp",
                   "python/module.cpp"}))
      << "a file that holds records";
}

}  // namespace
}  // namespace leviosim::tools
