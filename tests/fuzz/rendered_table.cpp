// What is printed is what it claims to be: a table of any words is read back from its CSV and its
// JSON, and its Markdown has as many rows and cells as the table, of which nothing is live.
#include <nlohmann/json.hpp>

#include "sim/base/printable.h"
#include "tests/fuzz/fuzz_target.h"
#include "tools/app/table/table_files.h"
#include "tools/app/table/terminal_table.h"

namespace {

using namespace leviosim;  // NOLINT: a program of one file
using tools::Cell;

/// Words in cells, a part of the input each, two in a row.
tools::Table table_of_parts(const std::vector<std::string>& parts) {
  tools::Table table({{.title = "name", .align = tools::kLeft, .key = "name"},
                      {.title = "words" + parts[0], .align = tools::kLeft, .key = "words"}});
  for (const std::string& part : parts) table.add({Cell("row"), Cell(part)});
  return table;
}

void require(bool holds) {
  if (!holds) std::abort();
}

/// Words that are a number, such as 1e3, come back as that number.
void check_csv(const tools::Table& table) {
  const tools::Table again = tools::read_csv("own.csv", tools::csv_text(table));
  tools::Table expected(again.heads());
  for (const std::vector<Cell>& row : table.rows())
    expected.add({row[0], tools::spelled(std::get<std::string>(row[1].value()))});
  require(tools::csv_text(again) == tools::csv_text(expected));
}

void check_json(const tools::Table& table) {
  const auto document = nlohmann::json::parse(tools::table_document("fuzzed", table));
  require(document["rows"].size() == table.rows().size());
  for (std::size_t i = 0; i < table.rows().size(); ++i) {
    const bool is_empty = std::get<std::string>(table.rows()[i][1].value()).empty();
    require(is_empty ? document["rows"][i]["words"].is_null()
                     : document["rows"][i]["words"].is_string());
  }
}

/// Characters with a meaning stand behind a backslash, or as entities; a cell ends where it should.
void check_markdown(const tools::Table& table) {
  const std::string text = tools::markdown_table(table);
  std::size_t lines = 0;
  std::size_t bars = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\\') {
      ++i;
      continue;
    }
    if (c == '\n') {
      require(bars == 3);
      bars = 0;
      ++lines;
    }
    bars += c == '|' ? 1 : 0;
    require(c != '<' && c != '`' && c != '*' && c != '_' && c != '[' && c != ']' && c != '\r');
    if (c == '&') require(text.compare(i, 4, "&lt;") == 0 || text.compare(i, 5, "&amp;") == 0);
    if (c == '@') require(text.compare(i + 1, 3, "\u2060") == 0);
    require(text.compare(i, 3, "://") != 0);
  }
  require(lines == table.rows().size() + 2);
}

/// A line a row, and no byte that a terminal obeys.
void check_terminal(const tools::Table& table) {
  const std::string text = tools::terminal_text(table, 80);
  std::size_t lines = 0;
  for (const char c : text) {
    lines += c == '\n' ? 1 : 0;
    require(c == '\n' || static_cast<unsigned char>(c) >= 0x20);
  }
  require(lines == table.rows().size() + 2);
  require(printable(text.substr(0, text.find('\n'))) == text.substr(0, text.find('\n')));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const tools::Table table = table_of_parts(fuzz::parts_of(fuzz::text_of(data, size)));
  check_csv(table);
  check_json(table);
  check_markdown(table);
  check_terminal(table);
  return 0;
}
