// What must hold between supply voltage, clocks and energy figures.
#pragma once

#include "platform_models/loader/document.h"
#include "platform_models/loader/schema.h"
#include "sim/chip/config.h"

namespace leviosim::platform {

/// Throws an InputError if a platform has only a part of `supply` and `energy`, or of `area`.
void check_energy_is_whole(const Schema& schema, const Settings& settings);

/// Throws an InputError that names the parameters at odds and where each was given. A platform
/// without the sections `supply` and `energy` passes, at any clock.
void check_supply(const Schema& schema, const Settings& settings, const sim::ChipConfig& chip);

}  // namespace leviosim::platform
