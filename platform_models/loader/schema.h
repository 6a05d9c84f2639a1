// What a platform file may contain: one table of every parameter of sim::ChipConfig, with its key,
// unit, allowed values and meaning. Reading files (document.h), command-line overrides
// (override.h) and writing the resolved platform (writer.cpp) all follow this table; a new
// parameter is one row of it, a key in each platform file, and nothing else.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "platform_models/loader/parameter_units.h"
#include "sim/chip/config.h"

namespace leviosim::platform {

/// One parameter.
struct Field {
  std::string path;    ///< full name, what -p takes: "cluster.workers", "isa.ops.f32_add.issue"
  std::string record;  ///< the map in the file that holds it: "cluster.workers", "isa.ops.f32_add"
  std::string name;    ///< its key in the record: "value", or a column such as "issue"
  const Dimension* dimension = nullptr;
  double min = 0;  ///< allowed values, in base units
  double max = 0;
  std::vector<std::string> choices;  ///< allowed names, if the dimension is kChoice
  bool required = true;              ///< optional ones keep what a more general section said
  std::string description;

  /// Values are in base units; a choice is the index of its name.
  std::function<void(sim::ChipConfig&, double)> set;
  std::function<double(const sim::ChipConfig&)> get;
  /// Where the chip keeps what it would be with the ends of the range; empty for most.
  std::function<void(sim::ChipConfig&, double low, double high)> set_band;

  bool is_choice() const { return !choices.empty(); }
  std::string range_key() const { return name == "value" ? "range" : name + "_range"; }
};

class Schema {
 public:
  Schema();

  /// In the order in which values are applied: `isa` first, then what differs from it.
  const std::vector<Field>& fields() const { return fields_; }
  /// Index of the field with this path, or kNone.
  std::size_t find(std::string_view path) const;
  bool is_section(std::string_view path) const;
  /// Indices of the fields that this record holds; empty if there is no such record.
  std::vector<std::size_t> record(std::string_view path) const;
  /// Paths of all fields, in their order.
  std::vector<std::string> paths() const;
  /// Paths of all sections and records: the keys of a file.
  std::vector<std::string> keys() const;

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

 private:
  std::vector<Field> fields_;
  std::map<std::string, std::size_t, std::less<>> by_path_;
  std::map<std::string, std::vector<std::size_t>, std::less<>> by_record_;
  std::set<std::string, std::less<>> sections_;
};

/// What to say of a key that there is not: the nearest of those that there are, or, if it was one,
/// what has become of it.
std::string why_unknown(const std::string& path, const std::vector<std::string>& known);

}  // namespace leviosim::platform
