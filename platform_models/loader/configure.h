// Parameters → the chip that they describe.
#pragma once

#include <string>

#include "platform_models/loader/document.h"

namespace leviosim::platform {

/// @param name  of the chip
sim::ChipConfig configure(const Schema& schema, const std::string& name, const Settings& settings);

}  // namespace leviosim::platform
