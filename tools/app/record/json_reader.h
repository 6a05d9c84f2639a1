// The one reader of JSON that comes from outside: records of runs in all their files, and
// manifests. It is bounded in bytes, depth and values, whatever
// the text says, and answers signals while it reads. Of members of one name, the first counts.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "tools/app/table/json.h"

namespace leviosim::tools {

/// Far above what leviosim writes: the statistics of a run have some 300 kB and 12 000 values.
struct JsonLimits {
  std::size_t bytes = std::size_t{64} << 20;
  std::size_t depth = 64;          ///< of arrays and objects in each other
  std::size_t values = 1'000'000;  ///< of all kinds; each takes some 70 bytes of memory
};

/// @param where  of the text, for messages
/// @throws InputError for what is no JSON, is no object, or is beyond a limit; Interrupted
Json read_json(const std::string& where, std::string_view text, const JsonLimits& limits = {});

/// Nothing where read_json() would refuse. @throws Interrupted
std::optional<Json> try_read_json(std::string_view text, const JsonLimits& limits = {});

}  // namespace leviosim::tools
