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

}  // namespace leviosim::tools
