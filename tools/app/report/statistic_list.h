// Statistics, each with name, unit, description and value, and their list as JSON: the format of
// stats.json and of everything else that writes figures.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/app/table/json.h"

namespace leviosim::tools {

/// Of statistics documents: the one that is written and read. It rises with every statistic that is
/// added.
inline constexpr int kStatisticsVersion = 7;

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

}  // namespace leviosim::tools
