// Tables in files: CSV by RFC 4180, JSON with numbers, and what reads them.
#include "tools/app/table/table_files.h"

#include <gtest/gtest.h>

#include "tests/tools/example_run.h"
#include "tests/traces/test_folder.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_tables.h"

namespace leviosim::tools {
namespace {

using traces::testing::expect_input_error;

struct ExampleRow {
  std::string name;
  std::optional<double> value;
  std::int64_t count = 0;
};

Table example(const std::vector<ExampleRow>& rows) {
  return table_of(
      Columns<ExampleRow>{
          {{.key = "name"}, [](const ExampleRow& r) { return r.name; }},
          {{.key = "value", .decimals = 2}, [](const ExampleRow& r) { return r.value; }},
          {{.title = "for people"}, [](const ExampleRow&) { return "seen"; }},
          {{.key = "count"}, [](const ExampleRow& r) { return r.count; }}},
      rows);
}

TEST(TableFiles, CsvHasAHeaderAndALineForEachRowOfColumnsWithAKey) {
  EXPECT_EQ(csv_text(example({{"a", 1.005, -3}, {"b", {}, 1LL << 40}})),
            "name,value,count\na,1.00,-3\nb,,1099511627776\n");
  EXPECT_EQ(csv_text(example({})), "name,value,count\n");
  EXPECT_EQ(csv_text(Table{{}}), "");
}

TEST(TableFiles, CsvQuotesWhatWouldBreakALine) {
  const auto line = [](const char* text) { return csv_text(example({{text, {}, 0}})).substr(17); };
  EXPECT_EQ(line("plain text"), "plain text,,0\n");
  EXPECT_EQ(line("a,b"), "\"a,b\",,0\n");
  EXPECT_EQ(line("say \"a\""), "\"say \"\"a\"\"\",,0\n");
  EXPECT_EQ(line("two\nlines"), "\"two\nlines\",,0\n");
}

TEST(TableFiles, FiguresWithABandAreThreeColumns) {
  Table table({{.title = "power", .shown = 1, .key = "mw", .is_banded = true}, {.key = "x"}});
  table.add({Banded{2, 1.5, 2.25}, 1});
  table.add({Cell(), 2});
  EXPECT_EQ(csv_text(table), "mw,mw_low,mw_high,x\n2,1.5,2.25,1\n,,,2\n");
  EXPECT_EQ(rows_json(table)[0], (Json{{"mw", 2.0}, {"mw_low", 1.5}, {"mw_high", 2.25}, {"x", 1}}));
  EXPECT_EQ(rows_json(table)[1].at("mw_low"), nullptr);
}

TEST(TableFiles, JsonHasTheNumbersThatCsvShows) {
  const Json rows = rows_json(example({{"1", 2.71828, 7}, {"", {}, 0}}));
  EXPECT_EQ(rows[0], (Json{{"name", "1"}, {"value", 2.72}, {"count", 7}})) << "words stay words";
  EXPECT_EQ(rows[1], (Json{{"name", nullptr}, {"value", nullptr}, {"count", 0}}));
}

TEST(TableFiles, ReadsNumbersTextsAndNothing) {
  const Table table = read_csv("x.csv", "name,x,y\na,1,\n\"b, \"\"c\"\"\nd\",-2.5e3,1+1\n");
  const Json rows = rows_json(table);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0], (Json{{"name", "a"}, {"x", 1}, {"y", nullptr}}));
  EXPECT_EQ(rows[1], (Json{{"name", "b, \"c\"\nd"}, {"x", -2500.0}, {"y", "1+1"}}));
  EXPECT_EQ(rows_json(read_csv("x.csv", "a,b\n")), Json::array());
  EXPECT_EQ(columns_json(read_csv("x.csv", "a\nnan\n007\n12\n")).at("a"), (Json{"nan", "007", 12}));
  expect_input_error([] { read_csv("x.csv", "a,b\n1\n"); }, {"x.csv", "row 2", "1 cells", "2"});
}

TEST(TableFiles, ReadsWhatItWrites) {
  const RunResult run = testing::example_run();
  const Table frames = frame_rows(run);
  EXPECT_EQ(csv_text(read_csv("frames.csv", csv_text(frames))), csv_text(frames));
  const Json document = Json::parse(table_document("frames", frames));
  EXPECT_EQ(document.at("format"), "leviosim frames");
  EXPECT_EQ(document.at("version"), 1);
  ASSERT_EQ(document.at("rows").size(), run.frames.size());
  EXPECT_EQ(document.at("rows")[3].at("source"), "epnp");
  EXPECT_EQ(document.at("rows")[3].at("latency_ns"), 30'000'000);
  for (const std::string text : {"a\nb", "\"", "a,b", "\"\"", "x\"y,\nz"})
    EXPECT_EQ(rows_json(read_csv("x.csv", csv_text(example({{text, {}, 0}}))))[0].at("name"), text);
}

}  // namespace
}  // namespace leviosim::tools
