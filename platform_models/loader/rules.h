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

// What must hold between supply voltage, clocks and energy figures.

/// Throws an InputError if a platform has only a part of `supply` and `energy`, or of `area`.
void check_energy_is_whole(const Schema& schema, const Settings& settings);

/// Throws an InputError that names the parameters at odds and where each was given. A platform
/// without the sections `supply` and `energy` passes, at any clock.
void check_supply(const Schema& schema, const Settings& settings, const sim::ChipConfig& chip);

}  // namespace leviosim::platform
