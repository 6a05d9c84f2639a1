// The rows of the schema: every parameter of a chip, with its key, unit, limits and meaning.
#pragma once

#include <vector>

#include "platform_models/loader/schema.h"

namespace leviosim::platform {

/// All parameters, in the order in which their values are applied.
std::vector<Field> all_fields();

}  // namespace leviosim::platform
