// Tables of comma-separated values: one description per column, and the quoting of RFC 4180.
#include "sim/base/csv.h"

#include <gtest/gtest.h>

namespace leviosim::base {
namespace {

struct Row {
  std::string name;
  std::optional<double> value;
  std::int64_t count = 0;
};

TEST(CsvTable, HasAHeaderAndALineForEachRecord) {
  CsvTable<Row> table{{"name", [](const Row& r) { return r.name; }},
                      {"value", [](const Row& r) { return fixed(r.value, 2); }}};
  table.add("count", [](const Row& r) { return r.count; });
  const std::vector<Row> rows{{"a", 1.005, -3}, {"b", {}, 1LL << 40}};
  EXPECT_EQ(table.text(rows), "name,value,count\na,1.00,-3\nb,,1099511627776\n");
  EXPECT_EQ(table.text(std::vector<Row>{}), "name,value,count\n");
}

TEST(CsvTable, QuotesWhatWouldBreakALine) {
  EXPECT_EQ(Cell("plain text").text(), "plain text");
  EXPECT_EQ(Cell("a,b").text(), "\"a,b\"");
  EXPECT_EQ(Cell("say \"a\"").text(), "\"say \"\"a\"\"\"");
  EXPECT_EQ(Cell("two\nlines").text(), "\"two\nlines\"");
  EXPECT_EQ(Cell("").text(), "");
  EXPECT_EQ(csv_line({"", "x", Cell(), Bytes(7)}), ",x,,7\n");
}

}  // namespace
}  // namespace leviosim::base
