// The rows of the schema: every parameter of a chip, with its key, unit, limits and meaning.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "platform_models/loader/document.h"
#include "platform_models/loader/schema.h"

namespace leviosim::platform {

/// All parameters, in the order in which their values are applied.
std::vector<Field> all_fields();

// The rows of the schema about supply, energy and area: sections `supply`, `energy`, `area`.
// Neither energies nor areas are known for every chip, so a platform may leave them out, but in
// groups only.

std::vector<Field> energy_fields();
std::vector<Field> area_fields();

/// What a platform has in full or not at all. With energy figures it has Always, and either Fixed
/// leakages and cycles, or those that follow from areas: BySize and Area. It may have areas alone.
enum class EnergyGroup : std::uint8_t { None, Always, Fixed, BySize, Area };
EnergyGroup energy_group_of(const Field& field);

// Rows of the schema about accelerators (sim/chip/accelerator.h): sections such as
// cluster.accelerators.hamming and controller.accelerators.solve, all of whose keys stand in a
// file, or none.

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
