// Statistics of a document by name.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tools/app/report/statistic_list.h"

namespace leviosim::tools::testing {

/// Null, and a failure, if there is none.
inline Json statistic(const Json& document, const std::string& name) {
  for (const Json& entry : document.at("statistics"))
    if (entry.at("name") == name) return entry;
  ADD_FAILURE() << "no statistic " << name;
  return {};
}

inline Json value(const Json& document, const std::string& name) {
  return statistic(document, name).at("value");
}

}  // namespace leviosim::tools::testing
