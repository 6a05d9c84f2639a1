// Statistics of a run by name.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tools/app/record/record.h"
#include "tools/app/record/statistics.h"

namespace leviosim::tools::testing {

/// Nothing, and a failure, if there is no such statistic.
inline std::optional<double> value(const RunFigures& run, const std::string& name) {
  const Statistic* found = run.find(name);
  EXPECT_NE(found, nullptr) << name;
  return found == nullptr ? std::nullopt : found->value;
}

/// All figures of a run as its record has them.
inline std::string figures_text(const RunResult& run) { return record_text({figures_of(run)}); }

}  // namespace leviosim::tools::testing
