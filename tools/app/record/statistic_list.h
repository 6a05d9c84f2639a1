// Statistics, each with name, value, unit and description, as JSON: in the record of a run, and in
// all other documents of figures.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/app/result/run_figures.h"
#include "tools/app/table/json.h"

namespace leviosim::tools {

class StatisticList {
 public:
  /// @param value  a number, or null for what does not exist
  /// @param protocol  of accuracy, how it was measured
  void add(const std::string& name, std::string_view unit, std::string_view description,
           const Json& value, const std::string& protocol = {});

  const std::vector<Statistic>& rows() const { return rows_; }
  std::vector<Statistic> take() { return std::move(rows_); }

 private:
  std::vector<Statistic> rows_;
};

/// {"frame.time.mean": [value, "ns", "description", "protocol"], …}; what stands last may be
/// missing.
Json statistics_json(const std::vector<Statistic>& statistics);

/// {"format": "leviosim statistics", "version": N, the members of `about`, "statistics": {…}}.
Json statistics_document(const std::vector<Statistic>& statistics, const Json& about);

}  // namespace leviosim::tools
