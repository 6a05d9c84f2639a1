// Checks of a single value against its row of the schema. Files and -p overrides share them.
#pragma once

#include <string>
#include <string_view>

#include "platform_models/loader/parameter.h"
#include "platform_models/loader/schema.h"

namespace leviosim::platform {

/// Where a value was found; begins the message of every fault.
struct Place {
  std::string where;  ///< "gap9.yaml:12: cluster.workers" or "-p cluster.workers=4"

  /// Throws InputError "WHERE: MESSAGE".
  [[noreturn]] void fail(std::string_view message) const;
};

/// Throws InputError unless the name is one of a unit of the field's dimension.
void check_unit(const Field& field, std::string_view unit, const Place& place);

/// The value of a field, without its source. Throws InputError unless it is one of the field's
/// choices, or a finite number in a unit of its dimension and within its limits.
/// @param unit  ignored for choices
Setting read_value(const Field& field, std::string_view text, std::string_view unit,
                   const Place& place);

/// The bounds of a sweep: finite, within the field's limits, and around the value.
Range read_range(const Field& field, const Setting& value, std::string_view low,
                 std::string_view high, const Place& place);

}  // namespace leviosim::platform
