#include "tools/app/report/statistic_list.h"

#include <gtest/gtest.h>

#include "sim/base/csv.h"
#include "tests/tools/example_run.h"
#include "tools/app/run/run_folder.h"

namespace leviosim::tools {
namespace {

TEST(TableDocument, RowsAreObjectsOfNumbersTextsAndNulls) {
  const Json rows = rows_of_csv("name,x,y\na,1,\n\"b, \"\"c\"\"\nd\",-2.5e3,1+1\n");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0], (Json{{"name", "a"}, {"x", 1}, {"y", nullptr}}));
  EXPECT_EQ(rows[1], (Json{{"name", "b, \"c\"\nd"}, {"x", -2500.0}, {"y", "1+1"}}));
  EXPECT_EQ(rows_of_csv("a,b\n"), Json::array());
  EXPECT_EQ(rows_of_csv("a\nnan\n007\n12\n"), (Json{{{"a", "nan"}}, {{"a", "007"}}, {{"a", 12}}}));
}

TEST(TableDocument, ReadsWhatCsvTablesWrite) {
  const RunResult run = testing::example_run();
  const Json document = Json::parse(table_document("frames", frames_csv(run)));
  EXPECT_EQ(document.at("format"), "leviosim frames");
  EXPECT_EQ(document.at("version"), 1);
  ASSERT_EQ(document.at("rows").size(), run.frames.size());
  EXPECT_EQ(document.at("rows")[3].at("source"), "epnp");
  EXPECT_EQ(document.at("rows")[3].at("latency_ns"), 30'000'000);
  const base::CsvTable<std::string> odd{{"text", [](const std::string& text) { return text; }}};
  for (const std::string text : {"a\nb", "\"", "a,b", "\"\"", "x\"y,\nz"})
    EXPECT_EQ(rows_of_csv(odd.text(std::vector{text}))[0].at("text"), text);
}

}  // namespace
}  // namespace leviosim::tools
