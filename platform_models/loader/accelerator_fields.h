// Rows of the schema about accelerators (sim/chip/accelerator.h): sections such as
// cluster.accelerators.hamming and controller.accelerators.solve, all of whose keys stand in a
// file, or none.
#pragma once

#include <string_view>
#include <vector>

#include "platform_models/loader/document.h"
#include "platform_models/loader/schema.h"

namespace leviosim::platform {

/// @param section  "cluster" or "controller"
std::vector<Field> accelerator_fields(std::string_view section);

/// Throws an InputError for an accelerator of which not everything is said; its energy only where
/// the platform has energy figures.
void check_accelerators_are_whole(const Schema& schema, const Settings& settings,
                                  const sim::ChipConfig& chip);

/// Throws an InputError for an accelerator that moves more words of L1 per cycle than there are
/// banks.
void check_accelerators(const Schema& schema, const Settings& settings,
                        const sim::ChipConfig& chip);

}  // namespace leviosim::platform
