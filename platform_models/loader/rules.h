// What must hold between parameters, whatever each of them may be on its own.
#pragma once

#include <string>

#include "platform_models/loader/document.h"
#include "platform_models/loader/schema.h"
#include "sim/chip/config.h"

namespace leviosim::platform {

/// Throws an InputError that names the parameters at odds and where each was given.
void check_rules(const Schema& schema, const Settings& settings, const sim::ChipConfig& chip);

/// The rules that depend on values. Those left out depend only on which parameters are given, so
/// that for variants of a chip that has passed check_rules(), this is all.
void check_values(const Schema& schema, const Settings& settings, const sim::ChipConfig& chip);

/// "cluster.workers is 9 cores (-p cluster.workers=9)"
std::string state(const Setting& setting);

}  // namespace leviosim::platform
