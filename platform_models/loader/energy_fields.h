// The rows of the schema about supply, energy and area: sections `supply`, `energy`, `area`.
// Neither energies nor areas are known for every chip, so a platform may leave them out, but in
// groups only.
#pragma once

#include <cstdint>
#include <vector>

#include "platform_models/loader/schema.h"

namespace leviosim::platform {

std::vector<Field> energy_fields();
std::vector<Field> area_fields();

/// What a platform has in full or not at all. With energy figures it has Always, and either Fixed
/// leakages and cycles, or those that follow from areas: BySize and Area. It may have areas alone.
enum class EnergyGroup : std::uint8_t { None, Always, Fixed, BySize, Area };
EnergyGroup energy_group_of(const Field& field);

}  // namespace leviosim::platform
