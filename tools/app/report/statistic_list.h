// Statistics as a list of JSON objects with name, unit, description and value, the format of
// stats.json and of everything else that writes figures.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace leviosim::tools {

using Json = nlohmann::ordered_json;

/// Of statistics documents: the one that is written and read. It rises with every statistic that is
/// added.
inline constexpr int kStatisticsVersion = 5;

/// The text of any document. Bytes that are no UTF-8, which names of files may have, are replaced
/// by U+FFFD instead of thrown.
/// @param indent  -1: all on one line
std::string json_text(const Json& json, int indent = -1);

/// null for what does not exist.
Json value_of(std::optional<double> value);

/// Nine decimals, as trajectory files have.
Json rounded(double value);

class StatisticList {
 public:
  void add(const std::string& name, std::string_view unit, std::string_view description,
           Json value);
  void add_with_protocol(const std::string& name, std::string_view unit,
                         std::string_view description, Json value, const std::string& protocol);

  Json take() { return std::move(list_); }

 private:
  Json list_ = Json::array();
};

/// {"format": "leviosim statistics", "version": N, "statistics": `list`}, with the members of
/// `about` before the statistics.
Json statistics_document(Json list, const Json& about = Json::object());

/// The text of a document with one statistic on a line, so that documents can be compared line by
/// line.
std::string statistics_document_text(const Json& document);

}  // namespace leviosim::tools
