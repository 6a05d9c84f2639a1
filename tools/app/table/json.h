// JSON, as all files of the program have it.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace leviosim::tools {

using Json = nlohmann::ordered_json;

/// The text of any document. Bytes that are no UTF-8, which names of files may have, are replaced
/// by U+FFFD instead of thrown.
/// @param indent  -1: all on one line
std::string json_text(const Json& json, int indent = -1);

/// null for what does not exist.
Json value_of(std::optional<double> value);

/// Nine decimals, as trajectory files have.
Json rounded(double value);

/// Adds a member without looking for its name among those before it.
void add_member(Json& object, const std::string& name, Json value);

/// Whole numbers without a fraction; null for what does not exist.
Json number_json(std::optional<double> value);

/// A document whose members, and the members and items of these, are on lines of their own, so that
/// two can be compared line by line.
std::string json_lines(const Json& document);

}  // namespace leviosim::tools
