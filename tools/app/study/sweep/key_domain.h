// The values of one key of a sweep: some that are named, or all of a range.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "platform_models/loader/platform_file.h"
#include "tools/app/run/yaml_map.h"
#include "tools/app/study/sweep/sweep_key.h"

namespace leviosim::tools {

struct Span {
  double low = 0, high = 0;  ///< both included, in the unit
  bool logarithmic = false;  ///< evenly spread over the orders of magnitude
  bool whole = false;        ///< whole numbers of base units only
  double factor = 1;         ///< base units in one of the unit
  std::string unit;
};

struct Domain {
  std::vector<std::string> values;  ///< normal_value(); empty for a range
  std::optional<Span> span;
};

/// `[240, 370]`, `240`, `{ from: 100, to: 400, step: 10 }` or `{ from: 1, to: 16, scale: log }`
/// (without step, scale is `linear` unless given; `powers_of_two` names those of the range).
/// @param entry  of the map
Domain read_domain(const SweepKey& key, const YamlMap& map, const YamlMap::Entry& entry,
                   platform::PlatformFile& reference);

/// The value that lies at `u` of the domain, 0 <= u < 1; of equal u, equal values. Numbers of a
/// range have four digits, so that a point can be typed again.
std::string value_at(const Domain& domain, double u);

}  // namespace leviosim::tools
