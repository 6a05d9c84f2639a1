// Statistics, each with name, unit, description and value, and their list as JSON: the format of
// stats.json and of everything else that writes figures.
#pragma once

#include <nlohmann/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::tools {

using Json = nlohmann::ordered_json;

/// Of statistics documents: the one that is written and read. It rises with every statistic that is
/// added.
inline constexpr int kStatisticsVersion = 7;

/// The text of any document. Bytes that are no UTF-8, which names of files may have, are replaced
/// by U+FFFD instead of thrown.
/// @param indent  -1: all on one line
std::string json_text(const Json& json, int indent = -1);

/// null for what does not exist.
Json value_of(std::optional<double> value);

/// Nine decimals, as trajectory files have.
Json rounded(double value);

struct StatisticRow {
  std::string name;
  std::string unit;
  std::string description;
  Json value;            ///< a number, a text, or null for what does not exist
  std::string protocol;  ///< of accuracy, how it was measured; else empty
};

class StatisticList {
 public:
  void add(const std::string& name, std::string_view unit, std::string_view description,
           Json value);
  void add_with_protocol(const std::string& name, std::string_view unit,
                         std::string_view description, Json value, const std::string& protocol);

  const std::vector<StatisticRow>& rows() const { return rows_; }
  /// An object for each, with the names of the members.
  Json json() const;

 private:
  std::vector<StatisticRow> rows_;
};

/// {"format": "leviosim statistics", "version": N, "statistics": `list`}, with the members of
/// `about` before the statistics.
Json statistics_document(Json list, const Json& about = Json::object());

/// The text of a document with one statistic on a line, so that documents can be compared line by
/// line.
std::string statistics_document_text(const Json& document);

// CSV tables, as base::CsvTable writes them, as JSON.

/// An object for each row, with a member for each column: numbers as such, null for empty cells.
Json rows_of_csv(const std::string& csv);

/// A list of cells for each column instead: {"column": [cells…]}.
/// @param where  of the file, for messages
/// @param wanted  whether a column is taken; all if it is empty
/// @throws InputError for rows of another width than the titles
Json csv_json(const std::string& where, const std::string& text,
              const std::function<bool(const std::string&)>& wanted = {});

/// {"format": "leviosim `what`", "version": 1, the members of `more`, "rows": rows_of_csv(csv)},
/// and a line break.
std::string table_document(const std::string& what, const std::string& csv,
                           const Json& more = Json::object());

}  // namespace leviosim::tools
